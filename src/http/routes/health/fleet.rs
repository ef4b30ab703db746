//! The fleet, riskiest first.

use axum::extract::State;

use crate::http::App;
use crate::http::body::fleet::{FleetItem, FleetPage, FleetQuery};
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::query::Query;
use crate::http::openapi::ListProblems;

/// The fleet, riskiest first: one row for each actuator, with its newest health and its forecast.
///
/// Equal risks are ordered by median remaining life; actuators without a forecast come last.
#[utoipa::path(
    get,
    path = "/v1/fleet/health",
    tag = "actuators",
    params(FleetQuery, PageQuery),
    responses((status = 200, description = "One page of the fleet", body = List<FleetItem>), ListProblems)
)]
pub(super) async fn fleet_health(
    State(app): State<App>,
    Query((which, page)): Query<(FleetQuery, PageQuery)>,
) -> ApiResult<List<FleetItem>> {
    let page = FleetPage::of(page)?;
    app.jobs.refresh_stale().await?;
    page.list(app.records.fleet(which.tail_number.as_deref(), &page.page).await?)
}
