//! Every actuator.

use axum::extract::State;

use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::query::Query;
use crate::http::openapi::ListProblems;
use crate::store::records::Actuator;

/// Every actuator, in the order of registration.
#[utoipa::path(
    get,
    path = "/v1/actuators",
    tag = "actuators",
    params(PageQuery),
    responses((status = 200, description = "One page of actuators", body = List<Actuator>), ListProblems)
)]
pub(super) async fn list_actuators(
    State(app): State<App>,
    Query(query): Query<PageQuery>,
) -> ApiResult<List<Actuator>> {
    Ok(app.records.actuators(&query.into()).await?.into())
}
