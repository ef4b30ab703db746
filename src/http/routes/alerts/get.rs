//! One alert.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::store::alerts::Alert;

/// One alert.
#[utoipa::path(
    get,
    path = "/v1/alerts/{id}",
    tag = "alerts",
    params(("id" = String, Path, description = "The alert's id")),
    responses((status = 200, description = "The alert", body = Alert), RecordProblems)
)]
pub(super) async fn get_alert(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Alert>> {
    let id = id.of("alert")?;
    app.records.alert(id).await?.map(Json).ok_or_else(|| ApiError::not_found("alert", id))
}
