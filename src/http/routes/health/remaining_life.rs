//! What remains of an actuator's life.

use axum::Json;
use axum::extract::State;
use serde_json::Value;

use crate::http::App;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::http::routes::actuator;
use crate::jobs::run::predict::RemainingLife;

/// What remains of an actuator's life: for each fault, and for the actuator, whichever fault comes first.
///
/// A forecast that cannot be made is null, and `reasons` says why.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/remaining-life",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id")),
    responses((status = 200, description = "The newest forecast", body = RemainingLife), RecordProblems)
)]
pub(super) async fn remaining_life(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Value>> {
    let actuator = actuator(&app, &id).await?;
    Ok(Json(app.jobs.forecast(&actuator).await?.document))
}
