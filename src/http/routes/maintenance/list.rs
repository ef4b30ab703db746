//! The maintenance events of an actuator.

use axum::extract::State;

use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::Query;
use crate::http::openapi::RecordListProblems;
use crate::http::routes::actuator;
use crate::store::records::Maintenance;

/// The maintenance events of an actuator, ascending by their time.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/maintenance",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id"), PageQuery),
    responses((status = 200, description = "One page of events", body = List<Maintenance>), RecordListProblems)
)]
pub(super) async fn list_maintenance(
    State(app): State<App>,
    id: PathId,
    Query(page): Query<PageQuery>,
) -> ApiResult<List<Maintenance>> {
    let actuator = actuator(&app, &id).await?;
    Ok(app.records.maintenance(actuator.id, &page.into()).await?.into())
}
