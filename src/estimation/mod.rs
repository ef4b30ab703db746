//! From a trace to its faults: the monitoring model is fitted to what was recorded.

use serde::{Deserialize, Serialize};
use thiserror::Error;
use utoipa::ToSchema;

use crate::models::parameters::ParameterSet;
use crate::models::trace::Trace;
use crate::numeric::watch::Watch;

/// Whether a trace determined at least one of the faults that were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// At least one fault has a figure.
    Conclusive,
    /// No fault has one; the reasons say why.
    Inconclusive,
}

impl Verdict {
    /// The verdict's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Conclusive => "conclusive",
            Self::Inconclusive => "inconclusive",
        }
    }
}

/// How to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Candidates in a generation, 4 to 1000; 40 in the thesis.
    pub population: usize,
    /// Generations, 0 to 1000; 10 in the thesis.
    pub generations: usize,
    /// Seed of every random draw.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { population: 40, generations: 10, seed: 1 }
    }
}

/// What an estimation found. A figure that the trace does not determine is `None`, and `reasons` says why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Estimate {
    /// Torque-motor demagnetisation KGM, 0 to 1.
    pub kgm: Option<f64>,
    /// Its standard deviation.
    pub kgm_std: Option<f64>,
    /// Dynamic jack friction FDJ, N.
    pub fdj_n: Option<f64>,
    /// Its standard deviation, N.
    pub fdj_n_std: Option<f64>,
    /// The objective at the best candidate (dimensionless, section 7.2); `None` when no search was made.
    pub cost: Option<f64>,
    /// Monitoring-model runs that were made.
    pub evaluations: u64,
    /// The search method.
    pub method: String,
    /// The seed of the search.
    pub seed: u64,
    /// The objective that was minimised.
    pub objective: String,
    /// Whether at least one fault was determined.
    pub verdict: Verdict,
    /// Why a figure is missing, or what to know of one that is there.
    pub reasons: Vec<String>,
    /// SHA-256 of the parameter set.
    pub parameter_set_hash: String,
    /// The elevon version.
    pub version: String,
}

/// Why an estimation could not be made at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EstimationError {
    /// A setting is out of its range.
    #[error("{name}: found {found}, expected {min} to {max}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        found: usize,
        /// The least allowed.
        min: usize,
        /// The most allowed.
        max: usize,
    },
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

/// Estimates the faults of the actuator that made `trace`.
///
/// # Errors
/// Settings out of range, or cancellation by `watch`. A trace that tells nothing is not an error but an
/// inconclusive estimate.
pub fn estimate(
    _trace: &Trace,
    set: &ParameterSet,
    settings: &Settings,
    _watch: &dyn Watch,
) -> Result<Estimate, EstimationError> {
    Ok(Estimate {
        kgm: None,
        kgm_std: None,
        fdj_n: None,
        fdj_n_std: None,
        cost: None,
        evaluations: 0,
        method: "ga".into(),
        seed: settings.seed,
        objective: "features".into(),
        verdict: Verdict::Inconclusive,
        reasons: vec!["skeleton".into()],
        parameter_set_hash: set.hash().to_owned(),
        version: crate::VERSION.into(),
    })
}
