//! What an actuator was like when its life began.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::body::baseline::BaselineDocument;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::http::routes::actuator;
use crate::jobs::baselines;

/// The actuator's own bias when its current life began: what its first healthy traces have in common.
///
/// A life begins with the actuator, and again where it is `replaced` or `overhauled`. A trace is healthy below half of the way
/// from a new actuator to its thresholds, in both faults; an excluded trace does not count. The health history tells the growth
/// since.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/baseline",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id")),
    responses((status = 200, description = "The baseline, or how far it has come", body = BaselineDocument), RecordProblems)
)]
pub(super) async fn baseline(
    State(app): State<App>,
    id: PathId,
    _: Query<NoQuery>,
) -> ApiResult<Json<BaselineDocument>> {
    let actuator = actuator(&app, &id).await?;
    let opening = baselines::current(app.records.as_ref(), &actuator, app.baseline_traces).await?;
    Ok(Json(BaselineDocument::of(&actuator, opening, app.baseline_traces)))
}
