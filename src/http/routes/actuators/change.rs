//! Changing an actuator.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::body::actuator::ActuatorChange;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordBodyProblems;
use crate::http::routes::{actuator, parameter_set};
use crate::store::records::Actuator;

/// Pins an actuator to another parameter set, or to another version of its own, and changes its failure thresholds.
///
/// What is estimated from now on is estimated with the new set, what waits in the queue included. Earlier estimates stay as they
/// are, each with the hash of the set that it was made with. With another threshold the forecast is made again.
#[utoipa::path(
    patch,
    path = "/v1/actuators/{id}",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id")),
    request_body = ActuatorChange,
    responses((status = 200, description = "The actuator as it is now", body = Actuator), RecordBodyProblems)
)]
pub(super) async fn change_actuator(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<ActuatorChange>,
) -> ApiResult<Json<Actuator>> {
    let id = actuator(&app, &id).await?.id;
    let set = match body.parameter_set() {
        Some(name) => Some(parameter_set(&app, Some(name)).await?),
        None => None,
    };
    let update = body.check(set)?;
    let changed = app.records.change_actuator(id, &update).await?;
    app.jobs.forecast_soon(id);
    changed.map(Json).ok_or_else(|| ApiError::not_found("actuator", id))
}
