//! Cancelling a job.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{ConflictProblem, RecordProblems};
use crate::store::records::{Job, JobState};

/// Cancels a job that is queued or running.
#[utoipa::path(
    delete,
    path = "/v1/jobs/{id}",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses((status = 200, description = "The job, cancelled", body = Job), RecordProblems, ConflictProblem)
)]
pub(super) async fn cancel_job(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Job>> {
    let id = id.of("job")?;
    let before = app.records.job(id).await?.ok_or_else(|| ApiError::not_found("job", id))?;
    if before.state.is_final() {
        return Err(ApiError::JobOver { state: before.state });
    }
    match app.jobs.cancel(id).await? {
        Some(job) if job.state == JobState::Cancelled => Ok(Json(job)),
        Some(job) => Err(ApiError::JobOver { state: job.state }),
        None => Err(ApiError::not_found("job", id)),
    }
}
