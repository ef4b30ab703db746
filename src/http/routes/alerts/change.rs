//! Acknowledging an alert.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::body::alert::AlertPatch;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{ConflictProblem, RecordBodyProblems};
use crate::store::alerts::{Alert, AlertState};
use crate::store::records;

/// Acknowledges an open alert.
///
/// The same acknowledgement again is answered as the first was. One with another note, and one of an alert that is cleared, is
/// refused: what was noted stays.
#[utoipa::path(
    patch,
    path = "/v1/alerts/{id}",
    tag = "alerts",
    params(("id" = String, Path, description = "The alert's id")),
    request_body = AlertPatch,
    responses(
        (status = 200, description = "The alert as it is now", body = Alert),
        RecordBodyProblems,
        ConflictProblem
    )
)]
pub(super) async fn change_alert(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<AlertPatch>,
) -> ApiResult<Json<Alert>> {
    let id = id.of("alert")?;
    let note = body.check()?;
    let found = app.records.acknowledge_alert(id, &note, records::now()).await?;
    let (alert, changed) = found.ok_or_else(|| ApiError::not_found("alert", id))?;
    if changed || (alert.state == AlertState::Acknowledged && alert.note == note) {
        return Ok(Json(alert));
    }
    Err(ApiError::AlertOver { state: alert.state })
}
