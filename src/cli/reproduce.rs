//! `elevon reproduce`: the thesis's tables and figures, ours beside the thesis's.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;

use super::progress::Bar;
use super::{Failure, print};
use crate::models::parameters::ParameterSet;
use crate::reproduction::table::Table;
use crate::reproduction::{Name, plot, report, reproduce, text};

/// What stands for every table of the thesis.
const ALL: &str = "all";
/// Where the report goes unless told otherwise.
const FOLDER: &str = "reproduction";

/// Arguments of `elevon reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Which table or figures
    #[arg(value_name = "TABLE", default_value = ALL, value_parser = names())]
    table: String,
    /// One JSON document on standard output; the report is written only if --out is given too
    #[arg(long)]
    json: bool,
    /// Folder of the report, report.html, and of every figure as SVG and CSV [default: ./reproduction]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(Name::EVERY.iter().map(|name| name.name()).chain([ALL]))
}

/// Runs the command.
pub fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let folder = args.out.as_deref().or((!args.json).then_some(Path::new(FOLDER)));
    if let Some(folder) = folder {
        // Before the work, so that a folder that cannot be made costs no time.
        fs::create_dir_all(folder).with_context(|| folder.display().to_string()).map_err(Failure::usage)?;
    }
    let set = ParameterSet::reference();
    let tables = make(args, &set)?;
    if let Some(folder) = folder {
        write(folder, &tables, &set).map_err(Failure::work)?;
    }
    if args.json {
        let json = if args.table == ALL {
            serde_json::to_string_pretty(&tables)
        } else {
            serde_json::to_string_pretty(&tables[0])
        };
        return print(&(json.map_err(Failure::work)? + "\n"));
    }
    let told: String = tables.iter().map(text::told).collect();
    let report =
        folder.map_or_else(String::new, |folder| format!("Report: {}\n", folder.join("report.html").display()));
    print(&(told + &report))
}

fn make(args: &ReproduceArgs, set: &ParameterSet) -> Result<Vec<Table>, Failure> {
    let named: Vec<Name> = match args.table.parse() {
        Ok(name) => vec![name],
        Err(_) => Name::ALL.into(),
    };
    let bar = Bar::new("reproducing");
    let mut started = Instant::now();
    let tables = reproduce(&named, set, &bar, |table| {
        table.elapsed_s = Some(started.elapsed().as_secs_f64());
        started = Instant::now();
    });
    bar.finish();
    tables.map_err(Failure::work)
}

/// Writes the page, and every figure as a drawing and as data.
fn write(folder: &Path, tables: &[Table], set: &ParameterSet) -> anyhow::Result<()> {
    let put = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| path.display().to_string())
    };
    put("report.html", &report::page(tables, set.hash()))?;
    for figure in tables.iter().flat_map(|table| &table.figures) {
        put(&format!("{}.svg", figure.id), &plot::standalone(figure))?;
        put(&format!("{}.csv", figure.id), &figure.csv())?;
    }
    Ok(())
}
