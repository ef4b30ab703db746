//! Trying a webhook.

use axum::extract::State;

use super::get::find;
use crate::http::App;
use crate::http::body::webhook::DeliveryAccepted;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{ConflictProblem, RecordProblems};
use crate::store::records;

/// Sends a `ping` to a webhook, as an alert would be sent. While one waits, no second is queued.
#[utoipa::path(
    post,
    path = "/v1/webhooks/{id}/test",
    tag = "webhooks",
    params(("id" = String, Path, description = "The webhook's id")),
    responses(
        (status = 202, description = "The delivery", body = DeliveryAccepted),
        RecordProblems,
        ConflictProblem
    )
)]
pub(super) async fn test_webhook(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<DeliveryAccepted> {
    let webhook = find(&app, &id).await?;
    if !webhook.enabled {
        return Err(ApiError::WebhookDisabled);
    }
    let delivery = app.records.ping_webhook(webhook.id, records::now()).await?;
    let delivery = delivery.ok_or_else(|| ApiError::not_found("webhook", webhook.id))?;
    Ok(DeliveryAccepted { delivery })
}
