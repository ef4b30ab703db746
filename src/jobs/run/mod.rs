//! What the jobs do: read what they need, compute, and turn what was found into an outcome.

mod asked;
pub mod calendar;
pub mod estimate;
pub mod fleet;
pub mod predict;
pub mod simulate;
mod trend;

use serde::Deserialize as _;
use thiserror::Error;
use tokio::task::JoinError;

use super::kind::JobSpec;
use super::sets::SetError;
use super::text::panic_message;
use crate::estimation::EstimationError;
use crate::formats::{self, Format, FormatError, ReadOptions};
use crate::models::drive::DriveError;
use crate::models::simulate::SimulationError;
use crate::models::trace::Trace;
use crate::numeric::digest::sha256_hex;
use crate::numeric::watch::Watch;
use crate::store::records::{Actuator, Id, Job, Outcome, TraceRecord};
use crate::store::{LifeHistory, Records, StoreError, Traces};
use fleet::KnownLives;
use predict::{Predicted, RiskQuestion};

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
    /// The trace's actuator is not kept.
    #[error("actuator {id} is not in the store")]
    ActuatorMissing {
        /// The actuator.
        id: Id,
    },
    /// The parameter set cannot be had.
    #[error("parameter_set: {0}")]
    ParameterSet(SetError),
    /// The kept bytes are not those that were kept.
    #[error("the bytes of trace {id} changed in the store: found SHA-256 {found}, expected {expected}")]
    TraceChanged {
        /// The trace.
        id: Id,
        /// The SHA-256 of its bytes now.
        found: String,
        /// The one that its record has.
        expected: String,
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

impl From<SetError> for RunError {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Store(error) => Self::Store(error),
            other => Self::ParameterSet(other),
        }
    }
}

impl RunError {
    /// Whether another try may succeed; see [`StoreError::may_pass`].
    #[must_use]
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Store(error) if error.may_pass())
    }
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
    Simulation(simulate::Input),
}

/// What was computed.
#[derive(Debug, Clone)]
pub enum Finding {
    /// An estimate.
    Estimation(Box<estimate::EstimationResult>),
    /// A trace, written.
    Simulation(Box<simulate::Written>),
}

/// What is computed, on a thread that may be busy for minutes.
pub trait Compute: Send + Sync {
    /// Computes until the end, or until `watch` asks for an early one.
    ///
    /// # Errors
    /// Why nothing was found.
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError>;

    /// Forecasts from a history and from what is known of other lives.
    fn predict(
        &self,
        actuator: &Actuator,
        history: &LifeHistory,
        known: &KnownLives,
        asked: &RiskQuestion,
    ) -> Predicted {
        predict::predict(actuator, history, known, asked)
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
            Work::Simulation(input) => {
                simulate::compute(input, watch).map(|written| Finding::Simulation(Box::new(written)))
            }
        }
    }
}

/// Reads the kept bytes of a trace, as its record says.
///
/// # Errors
/// Bytes that changed since they were kept, a media type that is not read, or bytes that are no valid trace.
pub fn read_trace(record: &TraceRecord, bytes: &[u8]) -> Result<Trace, RunError> {
    let TraceRecord { id, media_type, columns, sample_rate_hz, sha256, .. } = record;
    let found = sha256_hex(bytes);
    if found != *sha256 {
        return Err(RunError::TraceChanged { id: *id, found, expected: sha256.clone() });
    }
    let format = Format::from_media_type(media_type)
        .ok_or_else(|| RunError::MediaType { id: *id, found: media_type.clone() })?;
    let invalid = |errors| RunError::Trace { id: *id, errors };
    let columns = ReadOptions::parse_columns(columns).map_err(invalid)?;
    let options = ReadOptions { columns, sample_rate_hz: *sample_rate_hz };
    formats::read(format, bytes, &options).map_err(invalid)
}

/// Reads what a job needs.
pub(super) async fn prepare(job: &Job, records: &dyn Records, traces: &dyn Traces) -> Result<Work, RunError> {
    match JobSpec::deserialize(&job.spec)? {
        JobSpec::Estimation { trace_id, settings } => {
            estimate::prepare(trace_id, settings, records, traces).await.map(Work::Estimation)
        }
        JobSpec::Simulation(spec) => simulate::prepare(&spec, records).await.map(Work::Simulation),
    }
}

/// Turns what was found into what the store keeps; a trace's bytes are kept already when this returns.
pub(super) async fn conclude(finding: Finding, traces: &dyn Traces) -> Result<Outcome, RunError> {
    match finding {
        Finding::Estimation(result) => Ok(result.into_outcome()),
        Finding::Simulation(written) => simulate::keep(*written, traces).await.map_err(RunError::from),
    }
}

/// Why a computation panicked.
pub(super) fn panic_text(ended: JoinError) -> String {
    match ended.try_into_panic() {
        Ok(payload) => format!("panicked: {}", panic_message(payload.as_ref())),
        Err(_) => "the service ended first".into(),
    }
}
