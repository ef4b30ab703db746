//! A simulation: a model, a command and faults make a trace.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;
use utoipa::ToSchema;

use super::drive::Drive;
use super::fault::Faults;
use super::parameters::ParameterSet;
use super::trace::{Channel, Trace};
use crate::numeric::watch::Watch;

/// Which model to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// The detailed model of the thesis's chapter 4.
    Reference,
    /// The fast model of the thesis's section 4.2 and chapter 5.
    Monitoring,
}

/// The recipe of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// The model.
    pub model: ModelKind,
    /// The command.
    pub command: Drive,
    /// The faults.
    pub faults: Faults,
    /// Power of the white noise on the current, mA² s; 5e-6 in the thesis, 0 for none. Reference model only.
    pub noise_power_ma2_s: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Length, s, above 0, at most 600.
    pub duration_s: f64,
    /// Samples per second, Hz, 1 to 100 000.
    pub sample_rate_hz: f64,
}

/// Why a simulation could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// A value is out of its range.
    #[error("{name}: found {found}, expected {expected}")]
    OutOfRange {
        /// The field.
        name: &'static str,
        /// Its value.
        found: f64,
        /// Its range, with its unit.
        expected: &'static str,
    },
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

impl Simulation {
    /// Every field that is out of its range; empty when the recipe can be run.
    #[must_use]
    pub fn check(&self) -> Vec<SimulationError> {
        Vec::new()
    }
}

/// Runs a model. Row k of the trace is the state after the step at k / rate.
///
/// # Errors
/// The first field out of its range, or cancellation by `watch`.
pub fn simulate(_recipe: &Simulation, _set: &ParameterSet, _watch: &dyn Watch) -> Result<Trace, SimulationError> {
    let channels = BTreeMap::from([Channel::PositionCommand, Channel::ServovalveCurrent].map(|c| (c, vec![0.0; 10])));
    Ok(Trace::try_new((0..10).map(f64::from).collect(), channels, Vec::new()).expect("a valid skeleton"))
}
