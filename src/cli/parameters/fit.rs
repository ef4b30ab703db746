//! `elevon parameters fit`: the monitoring model's parameters from the reference model's.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};

use super::{FitArgs, load};
use crate::characterisation::fit::{FitError, fit, measure_bias};
use crate::characterisation::report::{Change, Fitted, Origin, Residual, ZeroFlow, changes};
use crate::cli::progress::Bar;
use crate::cli::{Failure, print};
use crate::models::checks::Short;
use crate::models::monitoring::bias::Surface;
use crate::models::monitoring::fluid::FluidModel;
use crate::models::parameters::ParameterSet;

/// Runs the command.
pub fn run(args: &FitArgs) -> Result<(), Failure> {
    let to_stdout = args.out.as_deref().is_some_and(|out| out.as_os_str() == "-");
    if to_stdout && args.json {
        return Err(Failure::usage(anyhow!("--out: found - with --json, expected a file")));
    }
    let started = Instant::now();
    let (before, missing) = load::for_fit(&args.set)?;
    if args.bias_only && !missing.is_empty() {
        return Err(Failure::usage(anyhow!(
            "{}: found no {}, expected it with --bias-only",
            args.set.display(),
            missing[0]
        )));
    }
    let bar = Bar::new("fitting");
    let made =
        if args.bias_only { measure_bias(&before, &bar).map(Made::Bias) } else { fit(&before, &bar).map(Made::Fit) };
    let made = made.map_err(|error| failed(&args.set, error))?;
    bar.finish();
    let set = made.set();
    let all = changes(&before, set, &missing);
    let changes: Vec<Change> =
        all.into_iter().filter(|change| !args.bias_only || change.origin == Origin::Measured).collect();
    let written = || load::rewritten(&args.set, &changes, set.bias_surface_toml().as_deref());
    if to_stdout {
        return print(&written()?);
    }
    if let Some(out) = &args.out {
        fs::write(out, written()?).with_context(|| out.display().to_string()).map_err(Failure::work)?;
    }
    if args.json {
        let mut document = serde_json::json!({
            "name": set.name(),
            "hash": set.hash(),
            "parameters": changes,
            "bias_surface": set.monitoring_model().bias.surface,
            "elapsed_s": started.elapsed().as_secs_f64(),
        });
        if let Made::Fit(fitted) = &made {
            document["zero_flow"] = serde_json::to_value(fitted.zero_flow).map_err(Failure::work)?;
            document["features"] = serde_json::to_value(&fitted.fluids).map_err(Failure::work)?;
        }
        return print(&(serde_json::to_string_pretty(&document).map_err(Failure::work)? + "\n"));
    }
    print(&told(&made, &changes, args.out.as_deref()))
}

/// What was made.
enum Made {
    Fit(Fitted),
    Bias(ParameterSet),
}

impl Made {
    fn set(&self) -> &ParameterSet {
        match self {
            Self::Fit(fitted) => &fitted.set,
            Self::Bias(set) => set,
        }
    }
}

/// A set that cannot be fitted is bad input; the rest is the work's failure.
fn failed(set: &Path, error: FitError) -> Failure {
    match error {
        FitError::Cancelled => Failure::work(error),
        error => Failure::usage(anyhow!("{}: {error}", set.display())),
    }
}

/// A report for a person.
fn told(made: &Made, changes: &[Change], out: Option<&Path>) -> String {
    let mut text = format!("{} {}\n\n", made.set().name(), made.set().hash());
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
    if let Some(surface) = &made.set().monitoring_model().bias.surface {
        text += &surface_told(surface);
    }
    if let Made::Fit(fitted) = made {
        text += &(zero_flow(&fitted.zero_flow) + &features(fitted));
    }
    text + &out.map_or_else(String::new, |out| format!("\nwritten to {}\n", out.display()))
}

/// What the surface of the bias says.
fn surface_told(surface: &Surface) -> String {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let ratio = range(&mut surface.current_ratio.iter().flatten().copied());
    let pressure_pa = range(&mut surface.load_pressure_difference_pa.iter().flatten().copied());
    let (ratio_std, pressure_std_pa) = (
        range(&mut surface.current_ratio_std.iter().copied()),
        range(&mut surface.load_pressure_std_pa.iter().copied()),
    );
    format!(
        "\nsurface of the bias, {} by {} levels: current ratio {:.5} to {:.5}, {:.5} to {:.5} about it; pressure difference {:.1} to \
         {:.1} Pa, {:.1} to {:.1} Pa about it\n",
        surface.kgm.len(),
        surface.fdj_n.len(),
        ratio.0,
        ratio.1,
        ratio_std.0,
        ratio_std.1,
        pressure_pa.0,
        pressure_pa.1,
        pressure_std_pa.0,
        pressure_std_pa.1,
    )
}

/// What is left of the zero-flow curve.
fn zero_flow(zero: &ZeroFlow) -> String {
    format!(
        "\nPSR tanh(XS/XSS) against the reference valve's pressure at zero flow, within {:.2} mm: RMS {:.3} MPa ({:.2} % of \
         PSR), worst {:.3} MPa at {:.0} um\n",
        zero.reach_m * 1e3,
        zero.rms_pa * 1e-6,
        zero.rms_of_supply * 1e2,
        zero.worst_pa * 1e-6,
        zero.worst_at_m * 1e6,
    )
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
