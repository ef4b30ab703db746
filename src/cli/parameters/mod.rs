//! `elevon parameters`: which parameters the models need, whether a set is one, and the fit of its monitoring model.

mod fit;
mod load;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use serde::Serialize;

use super::{Failure, parameter_sets, print};
use crate::models::parameters::{Parameter, ParameterSet, Value};

/// Arguments of `elevon parameters`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct ParametersArgs {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    show: ShowArgs,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Show every parameter with its value, range and unit (the default)
    Show(ShowArgs),
    /// Say whether a file is a parameter set, or all that is wrong with it
    Check(CheckArgs),
    /// Fit the monitoring model's own parameters to the reference model; a file may lack the [monitoring] sections
    Fit(FitArgs),
}

#[derive(Debug, Args)]
struct ShowArgs {
    /// The built-in set's name, or a file (TOML)
    #[arg(value_name = "NAME|FILE", default_value = ParameterSet::reference_name())]
    set: PathBuf,
    /// Only what this model needs
    #[arg(long)]
    model: Option<Model>,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// The file (TOML)
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

#[derive(Debug, Args)]
struct FitArgs {
    /// The built-in set's name, or a file (TOML)
    #[arg(value_name = "NAME|FILE", default_value = ParameterSet::reference_name())]
    set: PathBuf,
    /// Measure only the bias between the models, and leave the monitoring model as it is
    #[arg(long)]
    bias_only: bool,
    /// Where to write the whole set with its fitted values (TOML); - is standard output, without the report
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Model {
    Reference,
    Monitoring,
}

/// Runs the command.
pub fn run(args: &ParametersArgs) -> Result<(), Failure> {
    match &args.action {
        None => show(&args.show),
        Some(Action::Show(args)) => show(args),
        Some(Action::Check(args)) => check(args),
        Some(Action::Fit(args)) => fit::run(args),
    }
}

/// One parameter as JSON.
#[derive(Debug, Serialize)]
struct Shown {
    name: String,
    value: Value,
    unit: &'static str,
    min: Option<f64>,
    max: Option<f64>,
    model: &'static str,
}

fn show(args: &ShowArgs) -> Result<(), Failure> {
    let set = parameter_sets::load(&args.set)?;
    let model = match args.model {
        None => None,
        Some(Model::Reference) => Some("reference"),
        Some(Model::Monitoring) => Some("monitoring"),
    };
    let wanted = |parameter: &Parameter| model.is_none_or(|model| [model, "both"].contains(&parameter.models()));
    let parameters = set.parameters().into_iter().filter(wanted);
    if args.json {
        let parameters: Vec<Shown> = parameters.map(shown).collect();
        let document = serde_json::json!({ "name": set.name(), "hash": set.hash(), "parameters": parameters });
        return print(&(serde_json::to_string_pretty(&document).map_err(Failure::work)? + "\n"));
    }
    let mut text = format!("{} {}\n", set.name(), set.hash());
    for parameter in parameters {
        let range = parameter.limits.map_or_else(String::new, |limits| limits.to_string());
        let line = format!("{:<63} {:<12} {range}", parameter.name, parameter.value.to_string());
        text += &format!("{}\n", line.trim_end());
    }
    print(&text)
}

fn shown(parameter: Parameter) -> Shown {
    let limits = parameter.limits;
    Shown {
        model: parameter.models(),
        name: parameter.name,
        value: parameter.value,
        unit: limits.map_or("", |limits| limits.unit),
        min: limits.map(|limits| limits.min),
        max: limits.map(|limits| limits.max),
    }
}

fn check(args: &CheckArgs) -> Result<(), Failure> {
    let set = parameter_sets::load(&args.file)?;
    print(&format!("{}: a valid set, {} {}\n", args.file.display(), set.name(), set.hash()))
}
