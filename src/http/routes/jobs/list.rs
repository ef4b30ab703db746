//! Every job.

use axum::extract::State;
use utoipa::IntoParams;

use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::query::{Fields, FromQuery, Query};
use crate::http::openapi::ListProblems;
use crate::store::records::{Job, JobState};

/// Which jobs.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct JobsQuery {
    /// Only jobs in this state.
    #[param(inline)]
    state: Option<JobState>,
}

impl FromQuery for (JobsQuery, PageQuery) {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let expected = format!("one of {}", JobState::ALL.map(JobState::name).join(", "));
        let named = |text: &str| JobState::ALL.into_iter().find(|state| state.name() == text);
        let state = fields.parse_with("state", expected, named);
        Some((JobsQuery { state }, PageQuery::from_query(fields)?))
    }
}

/// Every job, newest first.
#[utoipa::path(
    get,
    path = "/v1/jobs",
    tag = "jobs",
    params(JobsQuery, PageQuery),
    responses((status = 200, description = "One page of jobs", body = List<Job>), ListProblems)
)]
pub(super) async fn list_jobs(
    State(app): State<App>,
    Query((which, page)): Query<(JobsQuery, PageQuery)>,
) -> ApiResult<List<Job>> {
    Ok(app.records.jobs(which.state, &page.into()).await?.into())
}
