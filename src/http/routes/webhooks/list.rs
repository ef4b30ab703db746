//! Every webhook.

use axum::extract::State;

use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::query::Query;
use crate::http::openapi::ListProblems;
use crate::store::webhooks::Webhook;

/// Every webhook, in the order in which they were made, without their secrets.
#[utoipa::path(
    get,
    path = "/v1/webhooks",
    tag = "webhooks",
    params(PageQuery),
    responses((status = 200, description = "One page of webhooks", body = List<Webhook>), ListProblems)
)]
pub(super) async fn list_webhooks(State(app): State<App>, Query(page): Query<PageQuery>) -> ApiResult<List<Webhook>> {
    Ok(app.records.webhooks(&page.into()).await?.into())
}
