//! Asking for a simulation.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::Faults as FaultsFound;
use crate::http::error::ApiResult;
use crate::http::limits::COMMAND_CHARS_MAX;
use crate::jobs::kind::SimulationSpec;
use crate::models::drive::{Drive, DriveError};
use crate::models::fault::Faults;
use crate::models::simulate::{ModelKind, Simulation, SimulationError};

/// A simulation to run with the built-in reference parameters; its result is a trace.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "model": "reference", "command": "diagnostic", "faults": {"kgm": 0.2, "fdj_n": 500.0}, "noise_power": 5e-6,
    "seed": 7, "duration_s": 1.0, "sample_rate_hz": 10000.0
}))]
pub struct NewSimulation {
    /// The model.
    model: ModelKind,
    /// The command: `diagnostic`, `step:0.1`, `ramp:0.1`, `sine:0.2@5` or `sequence:0.1@0,-0.05@0.5` (level@time); m, m/s,
    /// Hz, s.
    #[schema(min_length = 1, max_length = 10000)]
    command: String,
    /// The faults; without it, a healthy actuator.
    #[serde(default)]
    faults: Faults,
    /// Power of the white noise on the current, mA² s; 5e-6 in the thesis.
    #[serde(default)]
    #[schema(minimum = 0, default = 0.0)]
    noise_power: f64,
    /// Seed of the noise.
    #[serde(default = "first_seed")]
    #[schema(default = 1)]
    seed: u64,
    /// Length, s.
    #[schema(exclusive_minimum = 0, maximum = 600)]
    duration_s: f64,
    /// Samples per second, Hz.
    #[schema(minimum = 1, maximum = 100000)]
    sample_rate_hz: f64,
}

const fn first_seed() -> u64 {
    1
}

impl NewSimulation {
    /// What the job needs to know.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(self) -> ApiResult<SimulationSpec> {
        let Self { model, command, faults, noise_power, seed, duration_s, sample_rate_hz } = self;
        let mut found = FaultsFound::default();
        let command = found.text("/command", &command, (1, COMMAND_CHARS_MAX), false);
        // A command that cannot be read must not hide the other fields' faults.
        let drive = read_command(&command, &mut found).unwrap_or(Drive::Diagnostic);
        let noise_power_ma2_s = noise_power;
        let recipe = Simulation { model, command: drive, faults, noise_power_ma2_s, seed, duration_s, sample_rate_hz };
        for error in recipe.check() {
            if let SimulationError::OutOfRange { name, found: value, expected } = error {
                found.add(pointer(name), format!("{name}: found {value}, expected {expected}"));
            }
        }
        found.pass(SimulationSpec { model, command, faults, noise_power, seed, duration_s, sample_rate_hz })
    }
}

/// Reads a command. A file of the service's machine is none of a client's business.
fn read_command(text: &str, found: &mut FaultsFound) -> Option<Drive> {
    if text.starts_with("file:") {
        found.add("/command", "found a file, expected a command that needs none; files work on the command line only");
        return None;
    }
    let read: Result<Drive, DriveError> = text.parse();
    read.map_err(|error| found.add("/command", error.to_string())).ok()
}

/// Where a field of the recipe stands in the body; what is said of two fields points to the first.
fn pointer(name: &str) -> String {
    let field = name.split(' ').next().unwrap_or_default();
    format!("/{}", field.replace('.', "/"))
}
