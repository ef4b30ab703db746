//! One job.

use axum::Json;
use axum::extract::State;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::id::PathId;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::RecordProblems;
use crate::store::records::Job;

/// One job.
///
/// An estimation's `result` holds what was found (`kgm`, `kgm_std`, `fdj_n`, `fdj_n_std`, `cost`, `verdict`, `reasons`, ...)
/// and the `trace_id`; a simulation's holds the `trace_id` and what the trace was made from (`parameter_set_hash`, `seed`,
/// `version`, ...). A trace that tells nothing is no failure: the job succeeds with the verdict `inconclusive`.
#[utoipa::path(
    get,
    path = "/v1/jobs/{id}",
    tag = "jobs",
    params(("id" = String, Path, description = "The job's id")),
    responses((status = 200, description = "The job", body = Job), RecordProblems)
)]
pub(super) async fn get_job(State(app): State<App>, id: PathId, _: Query<NoQuery>) -> ApiResult<Json<Job>> {
    let id = id.of("job")?;
    let job = app.records.job(id).await?;
    job.map(Json).ok_or_else(|| ApiError::not_found("job", id))
}
