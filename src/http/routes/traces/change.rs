//! Excluding a trace.

use axum::Json;
use axum::extract::State;

use super::get::find;
use crate::http::App;
use crate::http::body::trace::TraceChange;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordBodyProblems;
use crate::store::records::TraceRecord;

/// Excludes a bad trace from its actuator's history, or takes it back.
///
/// The trace and its estimates stay; an excluded trace can still be estimated. What follows from the history (the baseline,
/// the forecasts, the fleet's list) follows it.
#[utoipa::path(
    patch,
    path = "/v1/traces/{id}",
    tag = "traces",
    params(("id" = String, Path, description = "The trace's id")),
    request_body = TraceChange,
    responses((status = 200, description = "The trace as it is now", body = TraceRecord), RecordBodyProblems)
)]
pub(super) async fn change_trace(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<TraceChange>,
) -> ApiResult<Json<TraceRecord>> {
    let id = find(&app, &id).await?.id;
    let (excluded, reason) = body.check()?;
    let changed = app.records.exclude_trace(id, excluded, &reason).await?;
    if let Some(actuator) = changed.as_ref().and_then(|trace| trace.actuator_id) {
        app.jobs.forecast_soon(actuator);
    }
    changed.map(Json).ok_or_else(|| ApiError::not_found("trace", id))
}
