//! Simulation jobs: from a recipe to a kept trace.

use serde::Serialize;
use utoipa::ToSchema;

use super::RunError;
use crate::formats::{self, Format};
use crate::jobs::text::causes;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{Simulation, simulate};
use crate::numeric::digest;
use crate::numeric::watch::Watch;
use crate::store::records::{self, Id, Outcome, TraceRecord};
use crate::store::{StoreError, Traces};

/// A simulated trace, written as CSV.
#[derive(Debug, Clone)]
pub struct Written {
    bytes: Vec<u8>,
    sha256: String,
    samples: u64,
    duration_s: f64,
}

/// The result of a simulation job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
pub struct SimulationResult {
    /// The trace that was made.
    pub trace_id: Id,
}

pub(super) fn compute(recipe: &Simulation, watch: &dyn Watch) -> Result<Written, RunError> {
    let trace = simulate(recipe, &ParameterSet::reference(), watch)?;
    let bytes = formats::write(Format::Csv, &trace);
    let sha256 = digest::sha256_hex(&bytes);
    Ok(Written { bytes, sha256, samples: trace.samples() as u64, duration_s: trace.duration_s() })
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
        created_at: records::now(),
    };
    if let Err(error) = traces.put(trace_id, written.bytes).await {
        if let Err(error) = traces.delete(trace_id).await {
            tracing::warn!(%trace_id, error = causes(&error), "bytes without a record not deleted");
        }
        return Err(error);
    }
    let result = serde_json::to_value(SimulationResult { trace_id }).expect("an id is a string");
    Ok(Outcome::Simulated { trace: Box::new(trace), result })
}
