//! One actuator.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::http::routes::actuator;
use crate::store::records::Actuator;

/// One actuator.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id")),
    responses((status = 200, description = "The actuator", body = Actuator), RecordProblems)
)]
pub(super) async fn get_actuator(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Actuator>> {
    Ok(Json(actuator(&app, &id).await?))
}
