//! Registering an actuator.

use axum::extract::State;

use crate::http::App;
use crate::http::body::accepted::Created;
use crate::http::body::actuator::NewActuator;
use crate::http::error::ApiResult;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{BodyProblems, ConflictProblem};
use crate::http::routes::parameter_set;
use crate::store::records::{self, Actuator};

/// Registers an actuator.
///
/// It is pinned to the version of its parameter set that its name means now; its traces are estimated with that version,
/// whatever is kept later. The built-in set goes with the program: a newer elevon estimates with its own.
#[utoipa::path(
    post,
    path = "/v1/actuators",
    tag = "actuators",
    request_body = NewActuator,
    responses(
        (status = 201, description = "The actuator", body = Actuator,
         headers(("location" = String, description = "Its path"))),
        BodyProblems,
        ConflictProblem
    )
)]
pub(super) async fn create_actuator(
    State(app): State<App>,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<NewActuator>,
) -> ApiResult<Created<Actuator>> {
    let set = parameter_set(&app, body.parameter_set()).await?;
    let actuator = body.check(set, app.thresholds, records::now())?;
    app.records.insert_actuator(&actuator).await?;
    Ok(Created { location: format!("/v1/actuators/{}", actuator.id), record: actuator })
}
