//! `elevon parameters fit`: the monitoring model's parameters from the reference model's.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};

use super::{FitArgs, load};
use crate::characterisation::fit::{FitError, fit};
use crate::characterisation::report::{Change, Fitted, Origin, Residual};
use crate::cli::progress::Bar;
use crate::cli::{Failure, print};
use crate::models::checks::Short;
use crate::models::monitoring::fluid::FluidModel;

/// Runs the command.
pub fn run(args: &FitArgs) -> Result<(), Failure> {
    let to_stdout = args.out.as_deref().is_some_and(|out| out.as_os_str() == "-");
    if to_stdout && args.json {
        return Err(Failure::usage(anyhow!("--out: found - with --json, expected a file")));
    }
    let started = Instant::now();
    let (before, missing) = load::for_fit(&args.set)?;
    let bar = Bar::new("fitting");
    let fitted = fit(&before, &bar).map_err(|error| failed(&args.set, error))?;
    bar.finish();
    let changes = fitted.changes(&before, &missing);
    let written = || load::rewritten(&args.set, &changes);
    if to_stdout {
        return print(&written()?);
    }
    if let Some(out) = &args.out {
        fs::write(out, written()?).with_context(|| out.display().to_string()).map_err(Failure::work)?;
    }
    if args.json {
        let document = serde_json::json!({
            "name": fitted.set.name(),
            "hash": fitted.set.hash(),
            "parameters": changes,
            "zero_flow": fitted.zero_flow,
            "features": fitted.fluids,
            "elapsed_s": started.elapsed().as_secs_f64(),
        });
        return print(&(serde_json::to_string_pretty(&document).map_err(Failure::work)? + "\n"));
    }
    print(&told(&fitted, &changes, args.out.as_deref()))
}

/// A set that cannot be fitted is bad input; the rest is the work's failure.
fn failed(set: &Path, error: FitError) -> Failure {
    match error {
        FitError::Cancelled => Failure::work(error),
        error => Failure::usage(anyhow!("{}: {error}", set.display())),
    }
}

/// A report for a person.
fn told(fitted: &Fitted, changes: &[Change], out: Option<&Path>) -> String {
    let mut text = format!("{} {}\n\n", fitted.set.name(), fitted.set.hash());
    let _ = writeln!(text, "{:<56} {:>12} {:>12}  {:<12}", "parameter", "before", "now", "unit");
    for change in changes {
        let origin = match change.origin {
            Origin::Derived => "derived",
            Origin::Fitted => "fitted",
            Origin::Measured => "measured",
            Origin::Kept => "kept",
            Origin::BuiltIn => "built-in set's",
            Origin::BuiltInScaled => "built-in set's, by the jack's area",
        };
        let before = change.old.map_or_else(|| "-".into(), short);
        let (name, now, unit) = (&change.name, short(change.new), change.unit);
        let _ = writeln!(text, "{name:<56} {before:>12} {now:>12}  {unit:<12} {origin}");
    }
    let zero = &fitted.zero_flow;
    let _ = writeln!(
        text,
        "\nPSR tanh(XS/XSS) against the reference valve's pressure at zero flow, within {:.2} mm: RMS {:.3} MPa ({:.2} % of \
         PSR), worst {:.3} MPa at {:.0} um",
        zero.reach_m * 1e3,
        zero.rms_pa * 1e-6,
        zero.rms_of_supply * 1e2,
        zero.worst_pa * 1e-6,
        zero.worst_at_m * 1e6,
    );
    text + &features(fitted) + &out.map_or_else(String::new, |out| format!("\nwritten to {}\n", out.display()))
}

/// The differences of the features, a row for each level.
fn features(fitted: &Fitted) -> String {
    let mut text = String::from("\nfeatures of the diagnostic command, monitoring minus reference model:\n");
    let (mut names, mut units) = (" ".repeat(11), format!("{:>5} {:>5}", "KGM", "FDJ N"));
    for fluid in &fitted.fluids {
        let section = match fluid.fluid {
            FluidModel::Linear => "5.1 linear",
            FluidModel::Evolved => "5.2 evolved",
            FluidModel::Developed | FluidModel::DevelopedWithoutLag => "5.3 developed",
        };
        let _ = write!(names, " | {section:<28}");
        let _ = write!(units, " | {:>9} {:>9} {:>8}", "current %", "press. %", "kPa");
    }
    let _ = writeln!(text, "{}\n{units}", names.trim_end());
    let cells = |residual: &Residual| {
        format!(
            " | {:>9.3} {:>9.4} {:>8.3}",
            residual.current_percent, residual.pressure_percent, residual.pressure_kpa
        )
    };
    let levels = fitted.fluids.first().map_or(0, |fluid| fluid.levels.len());
    for row in 0..levels {
        let level = &fitted.fluids[0].levels[row].level;
        let _ = write!(text, "{:>5} {:>5}", level.kgm, level.fdj_n);
        let _ = writeln!(text, "{}", fitted.fluids.iter().map(|fluid| cells(&fluid.levels[row])).collect::<String>());
    }
    let _ = write!(text, "{:<11}", "worst");
    for fluid in &fitted.fluids {
        let worst = |of: fn(&Residual) -> f64| fluid.worst(of);
        let (current, percent, kpa) =
            (worst(|r| r.current_percent), worst(|r| r.pressure_percent), worst(|r| r.pressure_kpa));
        let _ = write!(text, " | {current:>9.3} {percent:>9.4} {kpa:>8.3}");
    }
    text.push('\n');
    for fluid in fitted.fluids.iter().filter(|fluid| fluid.limited_by_time_step) {
        let name = if fluid.fluid == FluidModel::Linear { "5.1" } else { "5.2" };
        let _ = writeln!(text, "the flow gain of {name} is the least that a time step of 1e-5 s can follow");
    }
    text
}

/// Six digits are more than a fit knows.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    Short(rounded).to_string()
}
