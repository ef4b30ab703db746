//! Every parameter set.

use axum::extract::State;

use crate::http::App;
use crate::http::body::list::{List, PageQuery};
use crate::http::body::parameter_set::ParameterSetItem;
use crate::http::error::ApiResult;
use crate::http::extract::query::Query;
use crate::http::openapi::ListProblems;

/// Every version of every parameter set, the built-in one included, in the order in which the service first had them.
#[utoipa::path(
    get,
    path = "/v1/parameter-sets",
    tag = "parameter sets",
    params(PageQuery),
    responses((status = 200, description = "One page of parameter sets", body = List<ParameterSetItem>), ListProblems)
)]
pub(super) async fn list_parameter_sets(
    State(app): State<App>,
    Query(query): Query<PageQuery>,
) -> ApiResult<List<ParameterSetItem>> {
    let page = app.records.parameter_sets(&query.into()).await?;
    let items = page.items.iter().map(ParameterSetItem::from).collect();
    Ok(List { items, next_cursor: page.next_cursor })
}
