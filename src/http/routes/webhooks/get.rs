//! One webhook.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::store::webhooks::Webhook;

/// One webhook, without its secret.
#[utoipa::path(
    get,
    path = "/v1/webhooks/{id}",
    tag = "webhooks",
    params(("id" = String, Path, description = "The webhook's id")),
    responses((status = 200, description = "The webhook", body = Webhook), RecordProblems)
)]
pub(super) async fn get_webhook(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Webhook>> {
    find(&app, &id).await.map(Json)
}

/// The webhook that a path names.
pub(super) async fn find(app: &App, id: &PathId) -> ApiResult<Webhook> {
    let id = id.of("webhook")?;
    app.records.webhook(id).await?.ok_or_else(|| ApiError::not_found("webhook", id))
}
