//! `elevon estimate`: faults from traces, without a server.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use super::parameter_sets::Choice;
use super::progress::{Bar, Part};
use super::{Failure, first_of, print, read_file, refused};
use crate::estimation::method::{Choices, Method};
use crate::estimation::request::{Objective, Requested};
use crate::estimation::{Estimate, Settings, Verdict, estimate};
use crate::formats::{self, FormatError, ReadOptions};
use crate::models::parameters::ParameterSet;
use crate::models::trace::Trace;

/// The characters of a parameter set's hash that a person is shown: as many as the service needs to find it again.
const HASH_SHOWN_CHARS: usize = 8;

/// Arguments of `elevon estimate`.
#[derive(Debug, Args)]
pub struct EstimateArgs {
    /// Traces: .csv or .json by their extension
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The method of the search, before the local polish: ga (genetic algorithm), de (differential evolution), pso (particle
    /// swarm), gwo (grey wolf), dragonfly or multistart (local searches from many starts)
    #[arg(long, value_name = "NAME", default_value = Method::Ga.name())]
    method: Method,
    /// What the genetic algorithm does at each stage: thesis, or any of scaling=rank|proportional,
    /// selection=roulette|stochastic_uniform|tournament:SIZE, crossover=scattered|single_point|two_points|arithmetic|
    /// intermediate:RATIO|heuristic:RATIO, crossover_share=F, mutation=gaussian:SCALE:SHRINK|uniform:RATE|adaptive_feasible,
    /// elite_share=F, with commas between them
    #[arg(long, value_name = "CHOICES", default_value = "thesis")]
    ga: Choices,
    /// Candidates in a generation, 4 to 1000
    #[arg(long, value_name = "N", default_value_t = Settings::default().population)]
    population: usize,
    /// Generations, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = Settings::default().generations)]
    generations: usize,
    /// Seed of the search
    #[arg(long, value_name = "N", default_value_t = Settings::default().seed, allow_negative_numbers = true)]
    seed: u64,
    /// What is minimised: auto (the features where they suffice, else the trace), features (the ramp's current and the
    /// pressure after the step) or trace (every recorded channel over the whole trace)
    #[arg(long, value_name = "NAME", default_value = Objective::Auto.name())]
    objective: Objective,
    /// The faults to estimate, with commas between them: kgm, fdj, clearance, clogging, feedback_backlash, current_offset
    #[arg(long, value_name = "LIST", default_value = "kgm,fdj")]
    faults: Requested,
    /// Other column names, as Cor:servovalve_current_ma,P12:load_pressure_pa
    #[arg(long, value_name = "MAP", default_value = "")]
    columns: String,
    /// Samples per second of a file without times
    #[arg(long, value_name = "F")]
    sample_rate_hz: Option<f64>,
    #[command(flatten)]
    parameters: Choice,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
}

/// What was found in one file.
#[derive(Debug, Serialize)]
struct Report<'a> {
    file: &'a Path,
    #[serde(flatten)]
    estimate: Estimate,
    elapsed_s: f64,
}

/// Runs the command.
pub fn run(args: &EstimateArgs) -> Result<(), Failure> {
    let columns = ReadOptions::parse_columns(&args.columns).map_err(|errors| bad_input(&errors))?;
    let options = ReadOptions { columns, sample_rate_hz: args.sample_rate_hz };
    let EstimateArgs { method, ga, population, generations, seed, objective, faults, .. } = *args;
    let settings = Settings { method, ga, population, generations, seed, objective, faults };
    let set = args.parameters.load()?;
    let bar = Bar::new("estimating");
    let parts = bar.parts(args.files.len());
    let reports: Vec<Report<'_>> = args
        .files
        .par_iter()
        .enumerate()
        .map(|(index, file)| report(file, &options, &settings, &set, &parts.part(index)))
        .collect::<Vec<_>>()
        .into_iter()
        // In the order of the files, so that the same error is told every time.
        .collect::<Result<_, _>>()?;
    bar.finish();
    if args.json {
        print(&(serde_json::to_string_pretty(&reports).map_err(Failure::work)? + "\n"))
    } else {
        print(&reports.iter().map(|report| told(report, &set)).collect::<String>())
    }
}

fn report<'a>(
    file: &'a Path,
    options: &ReadOptions,
    settings: &Settings,
    set: &ParameterSet,
    watch: &Part<'_>,
) -> Result<Report<'a>, Failure> {
    let started = Instant::now();
    let trace = read(file, options)?;
    let estimate = estimate(&trace, set, settings, watch).map_err(Failure::usage)?;
    Ok(Report { file, estimate, elapsed_s: started.elapsed().as_secs_f64() })
}

fn read(file: &Path, options: &ReadOptions) -> Result<Trace, Failure> {
    let (format, bytes) = read_file(file)?;
    formats::read(format, &bytes, options).map_err(|errors| refused(file, &errors))
}

fn bad_input(errors: &[FormatError]) -> Failure {
    Failure::usage(anyhow!("--{}", first_of(errors)))
}

/// A standard deviation for a person, never as nothing.
fn spread(std: f64, decimals: usize) -> String {
    let least = 10f64.powi(-i32::try_from(decimals).unwrap_or(i32::MAX));
    if std < 0.5 * least { format!("<{least:.decimals$}") } else { format!("{std:.decimals$}") }
}

/// A report for a person.
fn told(report: &Report<'_>, set: &ParameterSet) -> String {
    let estimate = &report.estimate;
    let mut lines = vec![report.file.display().to_string()];
    if estimate.verdict == Verdict::Inconclusive {
        lines.push("  inconclusive".into());
    }
    let other = |key: &str| {
        (estimate.faults.get(key).copied().flatten(), estimate.faults.get(&format!("{key}_std")).copied().flatten())
    };
    // What, its figure and standard deviation, how many of its unit are one in SI, the decimals, the unit.
    let rows = [
        ("torque-motor demagnetisation KGM", (estimate.kgm, estimate.kgm_std), 1.0, 4, ""),
        ("dynamic jack friction FDJ", (estimate.fdj_n, estimate.fdj_n_std), 1.0, 2, " N"),
        ("extra radial clearance", other("clearance_m"), 1e6, 2, " µm"),
        ("filter clogging", other("clogging"), 1.0, 3, ""),
        ("feedback-spring backlash", other("feedback_backlash_m"), 1e6, 2, " µm"),
        ("current offset", other("current_offset_a"), 1e3, 4, " mA"),
    ];
    for (what, figures, per_si, decimals, unit) in rows {
        if let (Some(value), Some(std)) = figures {
            let spread = spread(std * per_si, decimals);
            lines.push(format!("  {what:32}  {:8.decimals$} ± {spread}{unit}", value * per_si));
        }
    }
    lines.extend(estimate.reasons.iter().map(|reason| format!("  {reason}")));
    let (evaluations, ms) = (estimate.evaluations, report.elapsed_s * 1e3);
    let (name, hash) = (set.name(), &set.hash()[..HASH_SHOWN_CHARS]);
    lines
        .push(format!("  {evaluations} model runs, seed {}, parameter set {name}@{hash}, {ms:.0} ms\n", estimate.seed));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn a_spread_is_never_shown_as_nothing() {
        assert_eq!(
            [spread(0.004, 2), spread(0.0, 4), spread(0.006, 2), spread(1.5, 2)],
            ["<0.01", "<0.0001", "0.01", "1.50"]
        );
    }
}
