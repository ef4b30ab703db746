//! Changing a webhook.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::body::webhook::WebhookPatch;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::json::ObjectBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordBodyProblems;
use crate::store::webhooks::Webhook;

/// Changes a webhook. What waits for it is sent as it is from now on: to the new address, signed with the new secret.
#[utoipa::path(
    patch,
    path = "/v1/webhooks/{id}",
    tag = "webhooks",
    params(("id" = String, Path, description = "The webhook's id")),
    request_body = WebhookPatch,
    responses((status = 200, description = "The webhook as it is now", body = Webhook), RecordBodyProblems)
)]
pub(super) async fn change_webhook(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    ObjectBody(body): ObjectBody<WebhookPatch>,
) -> ApiResult<Json<Webhook>> {
    let id = id.of("webhook")?;
    let changed = app.records.change_webhook(id, &body.check()?).await?;
    changed.map(Json).ok_or_else(|| ApiError::not_found("webhook", id))
}
