//! Simulations.

use axum::extract::State;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;
use crate::http::body::accepted::JobAccepted;
use crate::http::body::simulation::check;
use crate::http::error::ApiResult;
use crate::http::extract::json::JsonBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::BodyProblems;
use crate::http::routes::parameter_set;
use crate::jobs::kind::{JobSpec, SimulationSpec};

/// The routes about simulations.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(create_simulation))
}

/// Queues a simulation; the job's result names the trace that it made.
#[utoipa::path(
    post,
    path = "/v1/simulations",
    tag = "jobs",
    request_body = SimulationSpec,
    responses(
        (status = 202, description = "The job", body = JobAccepted,
         headers(("location" = String, description = "The job's path"))),
        BodyProblems
    )
)]
async fn create_simulation(
    State(app): State<App>,
    _: Query<NoQuery>,
    JsonBody(body): JsonBody<SimulationSpec>,
) -> ApiResult<JobAccepted> {
    let set = parameter_set(&app, body.parameter_set.as_deref()).await?;
    let spec = check(body, set)?;
    Ok(JobAccepted { job: app.jobs.enqueue(JobSpec::Simulation(spec)).await? })
}
