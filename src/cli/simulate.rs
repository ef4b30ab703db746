//! `elevon simulate`: a model makes a trace.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Context, anyhow};
use clap::{Args, ValueEnum};

use super::parameter_sets::Choice;
use super::progress::Bar;
use super::{Failure, print};
use crate::formats::{self, Format, ReadOptions};
use crate::models::drive::{Drive, DriveError};
use crate::models::fault::{Fault, Faults};
use crate::models::monitoring::fluid::FluidModel;
use crate::models::signal::Signal;
use crate::models::simulate::{ModelKind, Quantity, Simulation, simulate};
use crate::models::trace::Channel;

/// Arguments of `elevon simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// The model to run
    #[arg(long)]
    model: Model,
    /// The monitoring model's fluid: of section 5.1, 5.2 or 5.3 (its first version without the lag is for curves: in the closed
    /// loop it oscillates) [default: developed]
    #[arg(long)]
    fluid: Option<Fluid>,
    /// diagnostic, step:LEVEL, ramp:SLOPE, sine:AMPLITUDE@HZ, chirp:AMPLITUDE@HZ-HZ (over the whole run),
    /// sequence:LEVEL@TIME,... or file:FILE, the position_command of a .csv or .json (m, m/s, Hz, s)
    #[arg(long, value_name = "SPEC", allow_hyphen_values = true)]
    command: Command,
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
    /// External load on the jack, N, positive against a positive velocity, or file:FILE, the external_load of a .csv or .json
    #[arg(long, value_name = "N|file:FILE", allow_negative_numbers = true)]
    external_load: Option<Outside>,
    /// Absolute supply pressure, Pa, or file:FILE, the supply_pressure of a .csv or .json [default: the parameter set's]
    #[arg(long, value_name = "PA|file:FILE", allow_negative_numbers = true)]
    supply_pressure: Option<Outside>,
    /// Power of the white noise on the reference model's current, mA² s, 0 to 1; 5e-6 in the thesis
    #[arg(long, value_name = "F", default_value_t = 0.0, allow_negative_numbers = true)]
    noise_power: f64,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Length of the trace, s, at most 600 [default: 6, or the recorded command's length]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Samples per second, 1 to 100000
    #[arg(long, value_name = "HZ", default_value_t = 1000.0, allow_negative_numbers = true)]
    sample_rate: f64,
    #[command(flatten)]
    parameters: Choice,
    /// Where to: .csv or .json by its extension; - is CSV on standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Model {
    Reference,
    Monitoring,
}

/// A command, or the file that has it.
#[derive(Debug, Clone)]
enum Command {
    Drive(Drive),
    File(PathBuf),
}

impl FromStr for Command {
    type Err = DriveError;

    fn from_str(text: &str) -> Result<Self, DriveError> {
        match text.strip_prefix(FILE) {
            Some(file) => Ok(Self::File(file.into())),
            None => text.parse().map(Self::Drive),
        }
    }
}

/// A quantity that acts from outside, or the file that has it.
#[derive(Debug, Clone)]
enum Outside {
    Constant(f64),
    File(PathBuf),
}

impl FromStr for Outside {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix(FILE) {
            Some(file) => Ok(Self::File(file.into())),
            None => {
                text.parse().map(Self::Constant).map_err(|_| format!("found {text:?}, expected a number or file:FILE"))
            }
        }
    }
}

/// What precedes a file's name where a number or a command could stand.
const FILE: &str = "file:";
/// The length of a trace, s, when neither it nor a recorded command says so.
const DURATION_S: f64 = 6.0;

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Fluid {
    Linear,
    Evolved,
    #[value(name = "developed_without_lag")]
    DevelopedWithoutLag,
    Developed,
}

impl From<Fluid> for FluidModel {
    fn from(fluid: Fluid) -> Self {
        match fluid {
            Fluid::Linear => Self::Linear,
            Fluid::Evolved => Self::Evolved,
            Fluid::DevelopedWithoutLag => Self::DevelopedWithoutLag,
            Fluid::Developed => Self::Developed,
        }
    }
}

fn parse_fault(text: &str) -> Result<(Fault, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let fault = Fault::ALL.into_iter().find(|fault| fault.name() == name).ok_or_else(|| {
        format!("found the fault {name:?}, expected one of {}", Fault::ALL.map(Fault::name).join(", "))
    })?;
    let value = value.parse().map_err(|_| format!("{name}: found {value:?}, expected a number"))?;
    Ok((fault, value))
}

/// Runs the command.
pub fn run(args: &SimulateArgs) -> Result<(), Failure> {
    let format = output_format(&args.out)?;
    let recipe = recipe(args)?;
    let set = args.parameters.load()?;
    let errors: Vec<String> = recipe.check(&set).iter().map(ToString::to_string).collect();
    if !errors.is_empty() {
        return Err(Failure::usage(anyhow!("{}", errors.join("; "))));
    }
    let bar = Bar::new("simulating");
    let trace = simulate(&recipe, &set, &bar).map_err(Failure::work)?;
    bar.finish();
    write(&args.out, &formats::write_with(format, &trace, &recipe.provenance(&set).to_json()))
}

fn recipe(args: &SimulateArgs) -> Result<Simulation, Failure> {
    let named = [args.kgm.map(|kgm| (Fault::Kgm, kgm)), args.fdj_n.map(|fdj_n| (Fault::Fdj, fdj_n))];
    let all: Vec<(Fault, f64)> = named.into_iter().flatten().chain(args.faults.iter().copied()).collect();
    let mut faults = Faults::default();
    for (i, &(fault, value)) in all.iter().enumerate() {
        if all[..i].iter().any(|&(other, _)| other == fault) {
            return Err(Failure::usage(anyhow!("--fault: found {} twice, expected each fault once", fault.name())));
        }
        *fault.of_mut(&mut faults) = value;
    }
    let model = match args.model {
        Model::Reference => ModelKind::Reference,
        Model::Monitoring => ModelKind::Monitoring,
    };
    let (command, recorded_s) = match &args.command {
        Command::Drive(drive) => (drive.clone(), None),
        Command::File(file) => {
            let (time_s, position_m) = read_input(file, Channel::PositionCommand)?;
            let signal = Signal::command(&time_s, &position_m);
            let duration_s = signal.duration_s();
            (Drive::Recorded(signal), Some(duration_s))
        }
    };
    let duration_s = args.duration.or(recorded_s).unwrap_or(DURATION_S);
    Ok(Simulation {
        fluid: args.fluid.map(FluidModel::from),
        external_load_n: outside(args.external_load.as_ref(), Channel::ExternalLoad)?,
        supply_pressure_pa: outside(args.supply_pressure.as_ref(), Channel::SupplyPressure)?,
        noise_power_ma2_s: args.noise_power,
        seed: args.seed,
        ..Simulation::new(model, command, faults, duration_s, args.sample_rate)
    })
}

fn outside(found: Option<&Outside>, channel: Channel) -> Result<Option<Quantity>, Failure> {
    Ok(match found {
        None => None,
        Some(Outside::Constant(value)) => Some(Quantity::Constant(*value)),
        Some(Outside::File(file)) => {
            let (time_s, values) = read_input(file, channel)?;
            Some(Quantity::Recorded(Signal::new(&time_s, &values, f64::INFINITY)))
        }
    })
}

/// The times and the values of one column of a file.
fn read_input(file: &Path, channel: Channel) -> Result<(Vec<f64>, Vec<f64>), Failure> {
    let (format, bytes) = super::read_file(file)?;
    formats::read_input(format, &bytes, &ReadOptions::default(), channel)
        .map_err(|errors| super::refused(file, &errors))
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
