//! What jobs are asked to do, as it is kept in their `spec`.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::estimation;
use crate::models::drive::{Drive, DriveError};
use crate::models::fault::Faults;
use crate::models::monitoring::fluid::FluidModel;
use crate::models::simulate::{ModelKind, Quantity, Simulation};
use crate::store::records::{Id, JobKind};

/// What a job does, with all that it needs to know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum JobSpec {
    /// Estimates the faults behind a trace.
    Estimation {
        /// The trace.
        trace_id: Id,
        /// How to search.
        settings: estimation::Settings,
    },
    /// Makes a trace with a model.
    Simulation(SimulationSpec),
}

impl JobSpec {
    /// The kind of job.
    #[must_use]
    pub const fn kind(&self) -> JobKind {
        match self {
            Self::Estimation { .. } => JobKind::Estimation,
            Self::Simulation(_) => JobKind::Simulation,
        }
    }
}

/// A simulation to run; its result is a trace.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewSimulation, example = json!({
    "model": "reference", "parameter_set": "reference", "command": "diagnostic",
    "faults": {"kgm": 0.2, "fdj_n": 500.0}, "noise_power": 5e-6, "seed": 7, "duration_s": 1.0, "sample_rate_hz": 10000.0
}))]
pub struct SimulationSpec {
    /// The model.
    pub model: ModelKind,
    /// The parameter set: NAME, the version of that name that was kept last, or NAME@HASH, the one whose hash begins with
    /// these 8 or more digits; `reference` unless told. The version is chosen when the job is accepted.
    #[serde(default)]
    pub parameter_set: Option<String>,
    /// The monitoring model's fluid; `developed` unless told. The reference model has its own.
    #[serde(default)]
    pub fluid: Option<FluidModel>,
    /// The command: `diagnostic`, `step:0.1`, `ramp:0.1`, `sine:0.2@5`, `chirp:0.05@0.5-10` (linear over the duration) or
    /// `sequence:0.1@0,-0.05@0.5` (level@time); m, m/s, Hz, s.
    #[schema(min_length = 1, max_length = 10000)]
    pub command: String,
    /// The faults; without it, a healthy actuator.
    #[serde(default)]
    pub faults: Faults,
    /// External load on the jack beside the parameter set's, N, positive against a positive velocity.
    #[serde(default)]
    #[schema(minimum = -1000000, maximum = 1000000)]
    pub external_load_n: Option<f64>,
    /// Absolute supply pressure, Pa, at most twice the parameter set's; the parameter set's unless told.
    #[serde(default)]
    #[schema(minimum = 0)]
    pub supply_pressure_pa: Option<f64>,
    /// Power of the white noise on the current, mA² s; 5e-6 in the thesis.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 1, default = 0.0)]
    pub noise_power: f64,
    /// Seed of the noise.
    #[serde(default = "first_seed")]
    #[schema(maximum = 18446744073709551615_u64, default = 1)]
    pub seed: u64,
    /// Length, s.
    #[schema(exclusive_minimum = 0, maximum = 600)]
    pub duration_s: f64,
    /// Samples per second, Hz.
    #[schema(minimum = 1, maximum = 100000)]
    pub sample_rate_hz: f64,
}

const fn first_seed() -> u64 {
    1
}

impl SimulationSpec {
    /// The recipe that the simulation takes. Whether its figures are in their ranges, [`Simulation::check`] says.
    ///
    /// # Errors
    /// A command that cannot be read.
    pub fn recipe(&self) -> Result<Simulation, DriveError> {
        self.command.parse().map(|command| self.recipe_with(command))
    }

    /// The same with a command that was read already.
    #[must_use]
    pub fn recipe_with(&self, command: Drive) -> Simulation {
        let quiet = Simulation::new(self.model, command, self.faults, self.duration_s, self.sample_rate_hz);
        Simulation {
            fluid: self.fluid,
            external_load_n: self.external_load_n.map(Quantity::Constant),
            supply_pressure_pa: self.supply_pressure_pa.map(Quantity::Constant),
            noise_power_ma2_s: self.noise_power,
            seed: self.seed,
            ..quiet
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spec_is_read_back_as_it_was_written() {
        let simulation = SimulationSpec {
            model: ModelKind::Reference,
            parameter_set: Some("mine@0123456789".into()),
            fluid: None,
            command: "diagnostic".into(),
            external_load_n: Some(-0.1),
            supply_pressure_pa: None,
            faults: Faults { kgm: 0.1 + 0.2, ..Faults::default() },
            noise_power: 5e-6,
            seed: u64::MAX,
            duration_s: 2.0,
            sample_rate_hz: 1e4,
        };
        let estimation = JobSpec::Estimation { trace_id: Id::now(), settings: estimation::Settings::default() };
        for spec in [estimation, JobSpec::Simulation(simulation)] {
            let text = serde_json::to_string(&spec).unwrap();
            assert_eq!(serde_json::from_str::<JobSpec>(&text).unwrap(), spec, "{text}");
            assert!(text.contains(&format!(r#""kind":"{}""#, spec.kind().name())), "{text}");
        }
    }
}
