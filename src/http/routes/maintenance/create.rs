//! Reporting a maintenance event.

use axum::extract::State;

use crate::http::App;
use crate::http::body::accepted::Created;
use crate::http::body::maintenance::NewMaintenance;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordBodyProblems;
use crate::http::routes::actuator;
use crate::store::records::{self, Maintenance};

/// Reports what was done to an actuator.
///
/// `replaced` and `overhauled` start a new life: forecasts look at what was recorded since. Older records stay.
#[utoipa::path(
    post,
    path = "/v1/actuators/{id}/maintenance",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id")),
    request_body = NewMaintenance,
    responses(
        (status = 201, description = "The event", body = Maintenance,
         headers(("location" = String, description = "The path of the actuator's events"))),
        RecordBodyProblems
    )
)]
pub(super) async fn create_maintenance(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<NewMaintenance>,
) -> ApiResult<Created<Maintenance>> {
    let actuator = actuator(&app, &id).await?;
    let event = body.check(actuator.id, records::now())?;
    app.records.insert_maintenance(&event).await?;
    app.jobs.forecast_soon(event.actuator_id);
    Ok(Created { location: format!("/v1/actuators/{}/maintenance", actuator.id), record: event })
}
