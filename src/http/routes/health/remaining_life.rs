//! What remains of an actuator's life.

use axum::Json;
use axum::extract::State;
use serde_json::Value;
use utoipa::IntoParams;

use crate::http::App;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{Fields, FromQuery, Query};
use crate::http::openapi::RecordListProblems;
use crate::http::routes::actuator;
use crate::jobs::run::predict::RemainingLife;

/// The most usage ahead within which a risk is asked.
const WITHIN_MAX: f64 = 1e6;

/// Which risks are asked about.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct RiskQuery {
    /// The usage ahead within which the probability of a failure is asked, above 0, in the actuator's usage unit; the
    /// service's own (`prognostics.risk_window` of its settings) unless told.
    #[param(exclusive_minimum = 0.0, maximum = 1000000)]
    within: Option<f64>,
    /// The probability of a failure at which to act, above 0 and below 1; the service's own (`prognostics.act_at_risk`)
    /// unless told.
    #[param(exclusive_minimum = 0.0, exclusive_maximum = 1.0)]
    risk: Option<f64>,
}

impl FromQuery for RiskQuery {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let within = "a number above 0, at most 1000000";
        let within = fields.number("within", within, |within| within > 0.0 && within <= WITHIN_MAX);
        let risk = fields.number("risk", "a number above 0, below 1", |risk| risk > 0.0 && risk < 1.0);
        Some(Self { within, risk })
    }
}

/// What remains of an actuator's life: for each fault, and for the actuator, whichever fault comes first.
///
/// A forecast that cannot be made is null, and `reasons` says why. `risk` and `act_by` answer the query, or the service's
/// settings where it asks for nothing else.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/remaining-life",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id"), RiskQuery),
    responses((status = 200, description = "The newest forecast", body = RemainingLife), RecordListProblems)
)]
pub(super) async fn remaining_life(
    State(app): State<App>,
    id: PathId,
    Query(asked): Query<RiskQuery>,
) -> ApiResult<Json<Value>> {
    let actuator = actuator(&app, &id).await?;
    Ok(Json(app.jobs.remaining_life(&actuator, asked.within, asked.risk).await?))
}
