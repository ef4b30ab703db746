//! What is known of a trace.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::store::records::TraceRecord;

/// What is known of a trace beside its samples.
#[utoipa::path(
    get,
    path = "/v1/traces/{id}",
    tag = "traces",
    params(("id" = String, Path, description = "The trace's id")),
    responses((status = 200, description = "The trace's record", body = TraceRecord), RecordProblems)
)]
pub(super) async fn get_trace(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<TraceRecord>> {
    find(&app, &id).await.map(Json)
}

/// The trace that a path names.
pub(super) async fn find(app: &App, id: &PathId) -> ApiResult<TraceRecord> {
    let id = id.of("trace")?;
    app.records.trace(id).await?.ok_or_else(|| ApiError::not_found("trace", id))
}
