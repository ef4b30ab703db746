//! What a simulated trace was made from, so that it can be made again.

use serde::Serialize;

use super::{ModelKind, Quantity, Simulation};
use crate::models::fault::Faults;
use crate::models::monitoring::fluid::FluidModel;
use crate::models::parameters::ParameterSet;

/// The recipe of a simulated trace, its parameter set and the program's version.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    version: &'static str,
    parameter_set: String,
    parameter_set_hash: String,
    model: ModelKind,
    #[serde(skip_serializing_if = "Option::is_none")]
    fluid: Option<FluidModel>,
    command: String,
    faults: Faults,
    #[serde(skip_serializing_if = "Option::is_none")]
    external_load_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    supply_pressure_pa: Option<f64>,
    noise_power_ma2_s: f64,
    seed: u64,
    duration_s: f64,
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
            version: crate::VERSION,
            parameter_set: set.name().to_owned(),
            parameter_set_hash: set.hash().to_owned(),
            model: self.model,
            fluid: (self.model == ModelKind::Monitoring).then(|| self.fluid.unwrap_or_default()),
            command: self.command.to_string(),
            faults: self.faults,
            external_load_n: constant(&self.external_load_n),
            supply_pressure_pa: constant(&self.supply_pressure_pa),
            noise_power_ma2_s: self.noise_power_ma2_s,
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
