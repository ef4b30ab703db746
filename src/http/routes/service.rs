//! The service's own health and figures.

use axum::Json;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::openapi::PlainProblems;
use crate::telemetry;

/// The routes that look after the service.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(healthz)).routes(routes!(readyz)).routes(routes!(metrics))
}

/// How the service is.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Status {
    /// `ok`.
    #[schema(example = "ok")]
    status: &'static str,
    /// The elevon version.
    #[schema(example = "0.1.0")]
    version: &'static str,
}

const OK: Status = Status { status: "ok", version: crate::VERSION };

/// Whether the process answers.
#[utoipa::path(
    get,
    path = "/healthz",
    tag = "service",
    responses((status = 200, description = "It does", body = Status), PlainProblems)
)]
async fn healthz() -> Json<Status> {
    Json(OK)
}

/// Whether the service can work: its records can be read and written.
#[utoipa::path(
    get,
    path = "/readyz",
    tag = "service",
    responses(
        (status = 200, description = "It can", body = Status),
        (status = 503, description = "It cannot just now", content_type = "application/problem+json",
         body = crate::http::problem::ProblemDocument),
        PlainProblems
    )
)]
async fn readyz(State(app): State<App>) -> ApiResult<Json<Status>> {
    app.records.ping().await.map_err(ApiError::NotReady)?;
    Ok(Json(OK))
}

/// The service's figures, for Prometheus: requests, jobs by state, jobs that ended and how long they took.
#[utoipa::path(
    get,
    path = "/metrics",
    tag = "service",
    responses((status = 200, description = "The figures", body = String, content_type = "text/plain"), PlainProblems)
)]
async fn metrics(State(app): State<App>) -> Response {
    match app.records.job_counts().await {
        Ok(counts) => counts
            .into_iter()
            .for_each(|(state, jobs)| metrics::gauge!("elevon_jobs", "state" => state.name()).set(jobs as f64)),
        Err(error) => tracing::warn!(%error, "the jobs cannot be counted; their figures are old"),
    }
    ([(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], telemetry::metrics().render()).into_response()
}
