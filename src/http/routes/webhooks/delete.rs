//! Deleting a webhook.

use axum::extract::State;
use axum::http::StatusCode;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;

/// Deletes a webhook, its secret and its deliveries, those that wait too.
#[utoipa::path(
    delete,
    path = "/v1/webhooks/{id}",
    tag = "webhooks",
    params(("id" = String, Path, description = "The webhook's id")),
    responses((status = 204, description = "It is deleted"), RecordProblems)
)]
pub(super) async fn delete_webhook(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<StatusCode> {
    let id = id.of("webhook")?;
    match app.records.delete_webhook(id).await? {
        true => Ok(StatusCode::NO_CONTENT),
        false => Err(ApiError::not_found("webhook", id)),
    }
}
