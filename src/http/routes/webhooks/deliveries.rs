//! What was and is to be sent to a webhook.

use axum::extract::State;

use super::get::find;
use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::Query;
use crate::http::openapi::RecordListProblems;
use crate::store::webhooks::Delivery;

/// What was and is to be sent to a webhook, newest first. What is over is listed for a time that the settings name.
#[utoipa::path(
    get,
    path = "/v1/webhooks/{id}/deliveries",
    tag = "webhooks",
    params(("id" = String, Path, description = "The webhook's id"), PageQuery),
    responses((status = 200, description = "One page of deliveries", body = List<Delivery>), RecordListProblems)
)]
pub(super) async fn list_deliveries(
    State(app): State<App>,
    id: PathId,
    Query(page): Query<PageQuery>,
) -> ApiResult<List<Delivery>> {
    let webhook = find(&app, &id).await?;
    Ok(app.records.deliveries(webhook.id, &page.into()).await?.into())
}
