//! `elevon methods`: the methods of the search beside each other.

use clap::Args;

use super::parameter_sets::Choice;
use super::progress::Bar;
use super::{Failure, print};
use crate::reproduction::methods::{Score, compare, told};

/// Arguments of `elevon methods`.
#[derive(Debug, Args)]
pub struct MethodsArgs {
    #[command(flatten)]
    parameters: Choice,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &MethodsArgs) -> Result<(), Failure> {
    let set = args.parameters.load()?;
    let bar = Bar::new("comparing");
    let scores = compare(&set, &bar).map_err(Failure::work)?;
    bar.finish();
    if args.json {
        return print(&(serde_json::to_string_pretty(&scores).map_err(Failure::work)? + "\n"));
    }
    print(&table(&scores))
}

fn table(scores: &[Score]) -> String {
    let mut text = told() + "\n\n";
    text += &format!("{:<11}{:>44}{:>36}\n", "", "the search alone", "with the polish");
    text += &format!(
        "{:<11}{:>8}{:>12}{:>12}{:>8}{:>10}{:>10}{:>8}{:>10}{:>10}\n",
        "method", "runs", "cost median", "cost worst", "near %", "KGM off", "FDJ off %", "runs", "KGM off", "FDJ off %"
    );
    for s in scores {
        text += &format!(
            "{:<11}{:>8.0}{:>12.4}{:>12.3}{:>8.0}{:>10.4}{:>10.3}{:>8.0}{:>10.4}{:>10.4}\n",
            s.method,
            s.evaluations,
            s.cost_median,
            s.cost_worst,
            s.near_share * 100.0,
            s.kgm_error_worst,
            s.fdj_error_worst_percent,
            s.polished_evaluations,
            s.polished_kgm_error_worst,
            s.polished_fdj_error_worst_percent,
        );
    }
    text
}
