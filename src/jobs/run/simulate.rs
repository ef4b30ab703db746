//! Simulation jobs: from a recipe to a kept trace.

use std::sync::Arc;

use serde::Serialize;
use utoipa::ToSchema;

use super::RunError;
use crate::formats::{self, Format};
use crate::jobs::kind::SimulationSpec;
use crate::jobs::sets;
use crate::jobs::text::causes;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{Provenance, Simulation, simulate};
use crate::numeric::digest;
use crate::numeric::watch::Watch;
use crate::store::records::{self, Id, Outcome, TraceRecord};
use crate::store::{Records, StoreError, Traces};

/// A recipe, and what to make it with.
#[derive(Debug, Clone)]
pub struct Input {
    /// What to simulate.
    pub recipe: Simulation,
    /// The parameters of the models.
    pub set: Arc<ParameterSet>,
}

/// A simulated trace, written as CSV.
#[derive(Debug, Clone)]
pub struct Written {
    bytes: Vec<u8>,
    provenance: Provenance,
    sha256: String,
    samples: u64,
    duration_s: f64,
}

/// The result of a simulation job.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct SimulationResult {
    /// The trace that was made.
    pub trace_id: Id,
    /// What it was made from.
    #[serde(flatten)]
    pub provenance: Provenance,
}

pub(super) async fn prepare(spec: &SimulationSpec, records: &dyn Records) -> Result<Input, RunError> {
    let name = spec.parameter_set.as_deref().unwrap_or(ParameterSet::reference_name());
    Ok(Input { recipe: spec.recipe()?, set: sets::resolve(records, name).await? })
}

pub(super) fn compute(input: Input, watch: &dyn Watch) -> Result<Written, RunError> {
    let trace = simulate(&input.recipe, &input.set, watch)?;
    let bytes = formats::write(Format::Csv, &trace);
    let sha256 = digest::sha256_hex(&bytes);
    let (samples, duration_s) = (trace.samples() as u64, trace.duration_s());
    Ok(Written { bytes, provenance: input.recipe.provenance(&input.set), sha256, samples, duration_s })
}

/// Keeps the bytes under an id of their own: attempts never share one, so the one that loses can delete its own.
pub(super) async fn keep(written: Written, traces: &dyn Traces) -> Result<Outcome, StoreError> {
    let trace_id = Id::now();
    let trace = TraceRecord {
        id: trace_id,
        actuator_id: None,
        recorded_at: None,
        usage: None,
        media_type: Format::Csv.media_type().into(),
        columns: String::new(),
        sample_rate_hz: None,
        size_bytes: written.bytes.len() as u64,
        sha256: written.sha256,
        samples: written.samples,
        duration_s: written.duration_s,
        excluded: false,
        reason: String::new(),
        created_at: records::now(),
    };
    if let Err(error) = traces.put(trace_id, written.bytes).await {
        if let Err(error) = traces.delete(trace_id).await {
            tracing::warn!(%trace_id, error = causes(&error), "bytes without a record not deleted");
        }
        return Err(error);
    }
    let result = SimulationResult { trace_id, provenance: written.provenance };
    let result = serde_json::to_value(result).expect("a result's fields have names");
    Ok(Outcome::Simulated { trace: Box::new(trace), result })
}
