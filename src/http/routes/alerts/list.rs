//! Every alert.

use axum::extract::State;

use crate::http::App;
use crate::http::body::alert::AlertsQuery;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::query::Query;
use crate::http::openapi::ListProblems;
use crate::store::alerts::Alert;

/// Every alert, newest first, those that are cleared too.
#[utoipa::path(
    get,
    path = "/v1/alerts",
    tag = "alerts",
    params(AlertsQuery, PageQuery),
    responses((status = 200, description = "One page of alerts", body = List<Alert>), ListProblems)
)]
pub(super) async fn list_alerts(
    State(app): State<App>,
    Query((which, page)): Query<(AlertsQuery, PageQuery)>,
) -> ApiResult<List<Alert>> {
    Ok(app.records.alerts(which.state, which.actuator_id, &page.into()).await?.into())
}
