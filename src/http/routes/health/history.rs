//! The history of an actuator's faults.

use axum::extract::State;
use jiff::Timestamp;
use utoipa::IntoParams;

use crate::http::App;
use crate::http::body::baseline::HealthItem;
use crate::http::body::list::{List, PageQuery};
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::{Fields, FromQuery, Query};
use crate::http::openapi::RecordListProblems;
use crate::http::routes::actuator;
use crate::jobs::baselines;
use crate::store::Paged;

/// Which part of a history.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct HistoryQuery {
    /// Only what was recorded at this time or later: RFC 3339 with an offset.
    pub(super) from: Option<Timestamp>,
    /// Only what was recorded before this time: RFC 3339 with an offset.
    pub(super) to: Option<Timestamp>,
}

impl FromQuery for (HistoryQuery, PageQuery) {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let (from, to) = (fields.time("from"), fields.time("to"));
        if let (Some(from), Some(to)) = (from, to) {
            fields.check(from <= to, "to", format!("found {to}, expected {from} or later, as from says"));
        }
        Some((HistoryQuery { from, to }, PageQuery::from_query(fields)?))
    }
}

/// The history of an actuator's faults, ascending by time of recording: one row for each trace that is not excluded, its
/// newest estimate.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/health",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id"), HistoryQuery, PageQuery),
    responses((status = 200, description = "One page of the history", body = List<HealthItem>), RecordListProblems)
)]
pub(super) async fn health_history(
    State(app): State<App>,
    id: PathId,
    Query((span, page)): Query<(HistoryQuery, PageQuery)>,
) -> ApiResult<List<HealthItem>> {
    let actuator = actuator(&app, &id).await?;
    let (span, page) = ((span.from, span.to), page.into());
    let Paged { items, next_cursor } =
        baselines::history(app.records.as_ref(), &actuator, span, &page, app.baseline_traces).await?;
    Ok(List { items: items.into_iter().map(HealthItem::from).collect(), next_cursor })
}
