//! Estimations of traces that are kept.

use axum::extract::State;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;
use crate::http::body::accepted::JobAccepted;
use crate::http::body::estimation::NewEstimation;
use crate::http::error::ApiResult;
use crate::http::extract::json::ObjectBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::BodyProblems;

/// The routes about estimations.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(create_estimation))
}

/// Queues another estimation of a trace that is kept, uploaded or simulated.
///
/// The history of the trace's actuator shows the trace's newest estimate: that of the job that was asked for last. A fault
/// that it was not asked for is null there. Earlier estimates stay in their jobs.
#[utoipa::path(
    post,
    path = "/v1/estimations",
    tag = "jobs",
    request_body = NewEstimation,
    responses(
        (status = 202, description = "The job", body = JobAccepted,
         headers(("location" = String, description = "The job's path"))),
        BodyProblems
    )
)]
async fn create_estimation(
    State(app): State<App>,
    _: Query<NoQuery>,
    ObjectBody(body): ObjectBody<NewEstimation>,
) -> ApiResult<JobAccepted> {
    let trace = match body.trace_id() {
        Some(id) => app.records.trace(id).await?,
        None => None,
    };
    let spec = body.check(trace.map(|trace| trace.id))?;
    Ok(JobAccepted { job: app.jobs.enqueue(spec).await? })
}
