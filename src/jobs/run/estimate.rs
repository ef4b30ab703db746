//! Estimation jobs: from a kept trace to an estimate.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use utoipa::ToSchema;

use super::{RunError, read_trace};
use crate::estimation::{self, Estimate, Settings};
use crate::jobs::sets;
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::Watch;
use crate::store::records::{Actuator, Id, Outcome, TraceRecord};
use crate::store::{Records, Traces};

/// A trace as it is kept, and how to search.
#[derive(Debug, Clone)]
pub struct Input {
    /// What is known of the trace.
    pub trace: TraceRecord,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// How to search.
    pub settings: Settings,
    /// The parameters of the monitoring model: those of the version that the trace's actuator is pinned to.
    pub set: Arc<ParameterSet>,
}

/// The result of an estimation job.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct EstimationResult {
    /// The trace.
    pub trace_id: Id,
    /// What was found.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// Time that reading and searching took, s.
    pub elapsed_s: f64,
}

impl EstimationResult {
    pub(super) fn into_outcome(self) -> Outcome {
        let result = serde_json::to_value(&self).expect("an estimate's fields have names");
        Outcome::Estimated { trace_id: self.trace_id, estimate: Box::new(self.estimate), result }
    }
}

pub(super) async fn prepare(
    id: Id,
    settings: Settings,
    records: &dyn Records,
    traces: &dyn Traces,
) -> Result<Input, RunError> {
    let trace = records.trace(id).await?.ok_or(RunError::TraceMissing { id })?;
    let bytes = traces.get(id).await?.ok_or(RunError::TraceMissing { id })?;
    let set = set_of(&trace, records).await?;
    Ok(Input { trace, bytes, settings, set })
}

/// The built-in set goes with the program, whatever version the actuator's record names: a new program's first start pins
/// it anew. A trace of no actuator is estimated with it too.
async fn set_of(trace: &TraceRecord, records: &dyn Records) -> Result<Arc<ParameterSet>, RunError> {
    let Some(id) = trace.actuator_id else { return Ok(Arc::new(ParameterSet::reference())) };
    let Actuator { parameter_set, parameter_set_hash, .. } =
        records.actuator(id).await?.ok_or(RunError::ActuatorMissing { id })?;
    if parameter_set == ParameterSet::reference_name() {
        return Ok(Arc::new(ParameterSet::reference()));
    }
    Ok(sets::resolve(records, &format!("{parameter_set}@{parameter_set_hash}")).await?)
}

pub(super) fn compute(input: &Input, watch: &dyn Watch) -> Result<EstimationResult, RunError> {
    let started = Instant::now();
    let trace = read_trace(&input.trace, &input.bytes)?;
    let estimate = estimation::estimate(&trace, &input.set, &input.settings, watch)?;
    Ok(EstimationResult { trace_id: input.trace.id, estimate, elapsed_s: started.elapsed().as_secs_f64() })
}
