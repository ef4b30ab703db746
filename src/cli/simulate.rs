//! `elevon simulate`: a model makes a trace.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::{Args, ValueEnum};

use super::progress::Bar;
use super::{Failure, parameter_sets, print};
use crate::formats::{self, Format};
use crate::models::drive::Drive;
use crate::models::fault::Faults;
use crate::models::simulate::{ModelKind, Simulation, simulate};

/// Arguments of `elevon simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// The model to run
    #[arg(long)]
    model: Model,
    /// diagnostic, step:LEVEL, ramp:SLOPE, sine:AMPLITUDE@HZ or sequence:LEVEL@TIME,... (m, m/s, Hz, s)
    #[arg(long, value_name = "SPEC", allow_hyphen_values = true)]
    command: Drive,
    /// Torque-motor demagnetisation, 0 to 1 [default: 0]
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    kgm: Option<f64>,
    /// Dynamic jack friction, N, 200 to 2000 [default: 200]
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    fdj_n: Option<f64>,
    /// A fault by its name, each once: kgm (0 to 1), fdj (N), clearance (extra radial clearance of the sleeve, 0 to 1e-4 m)
    /// clogging (0 to 1), feedback_backlash or jack_backlash (m), current_offset or hysteresis (A); the monitoring model has the first two
    #[arg(long = "fault", value_name = "NAME=VALUE", value_parser = parse_fault)]
    faults: Vec<(Fault, f64)>,
    /// Power of the white noise on the reference model's current, mA² s, 0 to 1; 5e-6 in the thesis
    #[arg(long, value_name = "F", default_value_t = 0.0, allow_negative_numbers = true)]
    noise_power: f64,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Length of the trace, s, at most 600
    #[arg(long, value_name = "S", default_value_t = 6.0, allow_negative_numbers = true)]
    duration: f64,
    /// Samples per second, 1 to 100000
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, allow_negative_numbers = true)]
    sample_rate: f64,
    /// The parameter set: `reference`, the built-in one, or a file such as config/actuators/reference.toml [default: reference]
    #[arg(long, value_name = "NAME|FILE")]
    parameters: Option<PathBuf>,
    /// Where to: .csv or .json by its extension; - is CSV on standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Model {
    Reference,
    Monitoring,
}

/// The faults that `--fault` knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    Kgm,
    Fdj,
    Clearance,
    Clogging,
    FeedbackBacklash,
    JackBacklash,
    CurrentOffset,
    Hysteresis,
}

fn parse_fault(text: &str) -> Result<(Fault, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let fault = match name {
        "kgm" => Fault::Kgm,
        "fdj" => Fault::Fdj,
        "clearance" => Fault::Clearance,
        "clogging" => Fault::Clogging,
        "feedback_backlash" => Fault::FeedbackBacklash,
        "jack_backlash" => Fault::JackBacklash,
        "current_offset" => Fault::CurrentOffset,
        "hysteresis" => Fault::Hysteresis,
        _ => {
            let expected =
                "kgm, fdj, clearance, clogging, feedback_backlash, jack_backlash, current_offset or hysteresis";
            return Err(format!("found the fault {name:?}, expected {expected}"));
        }
    };
    let value = value.parse().map_err(|_| format!("{name}: found {value:?}, expected a number"))?;
    Ok((fault, value))
}

/// Runs the command.
pub fn run(args: &SimulateArgs) -> Result<(), Failure> {
    let format = output_format(&args.out)?;
    let recipe = recipe(args)?;
    if let Some(error) = recipe.check().into_iter().next() {
        return Err(Failure::usage(error));
    }
    let set = parameter_sets::load(args.parameters.as_deref())?;
    let bar = Bar::new("simulating");
    let trace = simulate(&recipe, &set, &bar).map_err(Failure::work)?;
    bar.finish();
    write(&args.out, &formats::write(format, &trace))
}

fn recipe(args: &SimulateArgs) -> Result<Simulation, Failure> {
    let named = [args.kgm.map(|kgm| (Fault::Kgm, kgm)), args.fdj_n.map(|fdj_n| (Fault::Fdj, fdj_n))];
    let all: Vec<(Fault, f64)> = named.into_iter().flatten().chain(args.faults.iter().copied()).collect();
    let mut faults = Faults::default();
    for (i, &(fault, value)) in all.iter().enumerate() {
        if all[..i].iter().any(|&(other, _)| other == fault) {
            return Err(Failure::usage(anyhow!("--fault: found {fault:?} twice, expected each fault once")));
        }
        match fault {
            Fault::Kgm => faults.kgm = value,
            Fault::Fdj => faults.fdj_n = value,
            Fault::Clearance => faults.clearance_m = value,
            Fault::Clogging => faults.clogging = value,
            Fault::FeedbackBacklash => faults.feedback_backlash_m = value,
            Fault::JackBacklash => faults.jack_backlash_m = value,
            Fault::CurrentOffset => faults.current_offset_a = value,
            Fault::Hysteresis => faults.hysteresis_a = value,
        }
    }
    Ok(Simulation {
        model: match args.model {
            Model::Reference => ModelKind::Reference,
            Model::Monitoring => ModelKind::Monitoring,
        },
        command: args.command.clone(),
        faults,
        noise_power_ma2_s: args.noise_power,
        seed: args.seed,
        duration_s: args.duration,
        sample_rate_hz: args.sample_rate,
    })
}

fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn output_format(path: &Path) -> Result<Format, Failure> {
    if is_stdout(path) {
        return Ok(Format::Csv);
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    Format::from_extension(extension).ok_or_else(|| {
        Failure::usage(anyhow!("--out: found {}, expected a name that ends in .csv or .json, or -", path.display()))
    })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if is_stdout(path) {
        return print(&String::from_utf8_lossy(bytes));
    }
    fs::write(path, bytes).with_context(|| path.display().to_string()).map_err(Failure::work)
}
