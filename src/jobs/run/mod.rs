//! What the jobs do: read what they need, compute, and turn what was found into an outcome.

pub mod estimate;
pub mod predict;
pub mod simulate;

use serde::Deserialize as _;
use thiserror::Error;
use tokio::task::JoinError;

use super::kind::JobSpec;
use crate::estimation::EstimationError;
use crate::formats::FormatError;
use crate::models::drive::DriveError;
use crate::models::simulate::SimulationError;
use crate::numeric::watch::Watch;
use crate::store::records::{Actuator, Id, Job, Outcome};
use crate::store::{LifeHistory, Records, StoreError, Traces};
use predict::RemainingLife;

/// Why an attempt failed.
#[derive(Debug, Error)]
pub enum RunError {
    /// The spec is of another version, or damaged.
    #[error("the job's specification cannot be read")]
    Spec(#[from] serde_json::Error),
    /// The trace to estimate from is not kept.
    #[error("trace {id} is not in the store")]
    TraceMissing {
        /// The trace.
        id: Id,
    },
    /// The kept bytes are of a type that is not read.
    #[error("trace {id} is of media type {found:?}, which cannot be read")]
    MediaType {
        /// The trace.
        id: Id,
        /// Its media type.
        found: String,
    },
    /// The kept bytes are no valid trace.
    #[error("trace {id} is not valid: {}", list(errors))]
    Trace {
        /// The trace.
        id: Id,
        /// All that is wrong with it.
        errors: Vec<FormatError>,
    },
    /// The estimation ended early.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// The command to simulate cannot be read.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The simulation ended early.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn list(errors: &[FormatError]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Work that is ready to be computed: nothing in it waits for anything.
#[derive(Debug, Clone)]
pub enum Work {
    /// Estimate faults.
    Estimation(estimate::Input),
    /// Make a trace.
    Simulation(crate::models::simulate::Simulation),
}

/// What was computed.
#[derive(Debug, Clone)]
pub enum Finding {
    /// An estimate.
    Estimation(Box<estimate::EstimationResult>),
    /// A trace, written.
    Simulation(simulate::Written),
}

/// What is computed, on a thread that may be busy for minutes.
pub trait Compute: Send + Sync {
    /// Computes until the end, or until `watch` asks for an early one.
    ///
    /// # Errors
    /// Why nothing was found.
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError>;

    /// Forecasts from a history.
    fn predict(&self, actuator: &Actuator, history: &LifeHistory, risk_window: f64) -> RemainingLife {
        predict::predict(actuator, history, risk_window)
    }
}

/// The computations of elevon's own models.
#[derive(Debug, Clone, Copy, Default)]
pub struct Models;

impl Compute for Models {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        match work {
            Work::Estimation(input) => {
                estimate::compute(&input, watch).map(|result| Finding::Estimation(Box::new(result)))
            }
            Work::Simulation(recipe) => simulate::compute(&recipe, watch).map(Finding::Simulation),
        }
    }
}

/// Reads what a job needs.
pub(super) async fn prepare(job: &Job, records: &dyn Records, traces: &dyn Traces) -> Result<Work, RunError> {
    match JobSpec::deserialize(&job.spec)? {
        JobSpec::Estimation { trace_id, settings } => {
            estimate::prepare(trace_id, settings, records, traces).await.map(Work::Estimation)
        }
        JobSpec::Simulation(spec) => Ok(Work::Simulation(spec.recipe()?)),
    }
}

/// Turns what was found into what the store keeps; a trace's bytes are kept already when this returns.
pub(super) async fn conclude(finding: Finding, traces: &dyn Traces) -> Result<Outcome, RunError> {
    match finding {
        Finding::Estimation(result) => Ok(result.into_outcome()),
        Finding::Simulation(written) => simulate::keep(written, traces).await.map_err(RunError::from),
    }
}

/// Why a computation panicked.
pub(super) fn panic_text(ended: JoinError) -> String {
    let Ok(payload) = ended.try_into_panic() else {
        return "the service ended first".into();
    };
    let owned = payload.downcast_ref::<String>().map(String::as_str);
    let message = owned.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
    format!("panicked: {message}")
}
