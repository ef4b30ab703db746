//! How the forecast of an actuator moved.

use axum::extract::State;

use super::history::HistoryQuery;
use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::body::trend::TrendItem;
use crate::http::error::ApiResult;
use crate::http::extract::id::PathId;
use crate::http::extract::query::Query;
use crate::http::openapi::RecordListProblems;
use crate::http::routes::actuator;
use crate::store::Paged;

/// How the forecast of an actuator moved: one row for each estimated trace of a life, with what was forecast last while it was
/// the newest.
///
/// Life by life, in each ascending by usage, then by the time at which the forecast was made. `from` and `to` mean the time at
/// which the trace was recorded. A trace that comes late has a row made from the traces up to it; rows of other traces stay as
/// they were made. The rows of an excluded trace are left out as long as it is.
#[utoipa::path(
    get,
    path = "/v1/actuators/{id}/remaining-life/trend",
    tag = "actuators",
    params(("id" = String, Path, description = "The actuator's id"), HistoryQuery, PageQuery),
    responses((status = 200, description = "One page of the trend", body = List<TrendItem>), RecordListProblems)
)]
pub(super) async fn remaining_life_trend(
    State(app): State<App>,
    id: PathId,
    Query((span, page)): Query<(HistoryQuery, PageQuery)>,
) -> ApiResult<List<TrendItem>> {
    let actuator = actuator(&app, &id).await?;
    app.jobs.forecast(&actuator).await?;
    let Paged { items, next_cursor } = app.records.trend(actuator.id, span.from, span.to, &page.into()).await?;
    Ok(List { items: items.into_iter().map(TrendItem::from).collect(), next_cursor })
}
