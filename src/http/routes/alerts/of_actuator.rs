//! The alerts of an actuator.

use axum::extract::State;

use crate::http::App;
use crate::http::body::alert::AlertStateQuery;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::Query;
use crate::http::openapi::RecordListProblems;
use crate::http::routes::actuator;
use crate::store::alerts::Alert;

/// The alerts of an actuator, newest first, those of its former lives too.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/alerts",
    tag = "alerts",
    params(("id" = String, Path, description = "The actuator's id"), AlertStateQuery, PageQuery),
    responses((status = 200, description = "One page of alerts", body = List<Alert>), RecordListProblems)
)]
pub(super) async fn list_actuator_alerts(
    State(app): State<App>,
    id: PathId,
    Query((which, page)): Query<(AlertStateQuery, PageQuery)>,
) -> ApiResult<List<Alert>> {
    let actuator = actuator(&app, &id).await?;
    Ok(app.records.alerts(which.state, Some(actuator.id), &page.into()).await?.into())
}
