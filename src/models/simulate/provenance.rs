//! What a simulated trace was made from, so that it can be made again.

use serde::Serialize;
use utoipa::ToSchema;

use super::{ModelKind, Quantity, Simulation};
use crate::models::fault::Faults;
use crate::models::monitoring::fluid::FluidModel;
use crate::models::parameters::ParameterSet;

/// The recipe of a simulated trace, its parameter set and the program's version.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Provenance {
    /// The elevon version.
    version: String,
    /// The parameter set's name.
    parameter_set: String,
    /// SHA-256 of the parameter set.
    parameter_set_hash: String,
    /// The model.
    model: ModelKind,
    /// The monitoring model's fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    fluid: Option<FluidModel>,
    /// The command; `file` for a recorded one.
    command: String,
    /// The faults.
    faults: Faults,
    /// External load beside the parameter set's, N, where a constant one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    external_load_n: Option<f64>,
    /// Supply pressure, Pa, where a constant one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    supply_pressure_pa: Option<f64>,
    /// Power of the white noise on the current, mA² s.
    noise_power: f64,
    /// Seed of the noise.
    seed: u64,
    /// Length, s.
    duration_s: f64,
    /// Samples per second, Hz.
    sample_rate_hz: f64,
}

impl Simulation {
    /// What a trace of this run is made from. Recorded inputs are in the trace itself.
    #[must_use]
    pub fn provenance(&self, set: &ParameterSet) -> Provenance {
        let constant = |quantity: &Option<Quantity>| match quantity {
            Some(Quantity::Constant(value)) => Some(*value),
            _ => None,
        };
        Provenance {
            version: crate::VERSION.to_owned(),
            parameter_set: set.name().to_owned(),
            parameter_set_hash: set.hash().to_owned(),
            model: self.model,
            fluid: (self.model == ModelKind::Monitoring).then(|| self.fluid.unwrap_or_default()),
            command: self.command.to_string(),
            faults: self.faults,
            external_load_n: constant(&self.external_load_n),
            supply_pressure_pa: constant(&self.supply_pressure_pa),
            noise_power: self.noise_power_ma2_s,
            seed: self.seed,
            duration_s: self.duration_s,
            sample_rate_hz: self.sample_rate_hz,
        }
    }
}

impl Provenance {
    /// The same as a JSON object.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Map<String, serde_json::Value> {
        match serde_json::to_value(self).expect("names and plain numbers serialise") {
            serde_json::Value::Object(object) => object,
            _ => unreachable!("a struct with named fields is an object"),
        }
    }
}
