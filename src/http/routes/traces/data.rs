//! The samples of a trace.

use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use tokio::task::spawn_blocking;

use super::FORMATS;
use super::get::find;
use crate::formats::{self, Format};
use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::accept::negotiate;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{NotAcceptableProblem, RecordProblems};
use crate::jobs::run::{RunError, read_trace};
use crate::store::records::TraceRecord;

/// The samples of a trace, in SI units under their own names, as CSV or JSON as `Accept` prefers.
#[utoipa::path(
    get,
    path = "/v1/traces/{id}/data",
    tag = "traces",
    params(
        ("id" = String, Path, description = "The trace's id"),
        ("accept" = Option<String>, Header, description = "`text/csv` (unless told) or `application/json`")
    ),
    responses(
        (status = 200, description = "The samples", content(
            (String = "text/csv", example = "time_s,position_command_m,servovalve_current_a\n0,0,0\n0.0001,0,0.0001\n"),
            (serde_json::Value = "application/json", example = json!({"columns": {"time_s": [0.0, 0.0001],
                "position_command_m": [0.0, 0.0], "servovalve_current_a": [0.0, 0.0001]}}))
        )),
        RecordProblems,
        NotAcceptableProblem
    )
)]
pub(super) async fn trace_data(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    headers: HeaderMap,
) -> ApiResult<Response> {
    let record = find(&app, &id).await?;
    let format = negotiate(&headers, &FORMATS)?;
    let bytes = app.traces.get(record.id).await?.ok_or_else(|| {
        let id = record.id;
        ApiError::internal(RunError::TraceMissing { id })
    })?;
    let written = spawn_blocking(move || rewrite(&record, &bytes, format)).await.map_err(ApiError::internal)??;
    Ok(([(CONTENT_TYPE, format.media_type()), (VARY, "accept")], written).into_response())
}

/// Reads the kept bytes and writes them in another format; both take long for a long trace.
fn rewrite(record: &TraceRecord, bytes: &[u8], to: Format) -> ApiResult<Vec<u8>> {
    let trace = read_trace(record, bytes).map_err(ApiError::internal)?;
    Ok(formats::write(to, &trace))
}
