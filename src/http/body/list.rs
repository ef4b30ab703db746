//! Lists and their pages.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::{IntoParams, ToSchema};

use crate::http::extract::query::{Fields, FromQuery};
use crate::http::limits::{PAGE_LIMIT_DEFAULT, PAGE_LIMITS};
use crate::store::{Page, Paged};

/// One page of a list.
#[derive(Debug, Serialize, ToSchema)]
pub struct List<T> {
    /// The records, in the list's order.
    pub items: Vec<T>,
    /// What to pass as `cursor` for the page that follows; null on the last page.
    pub next_cursor: Option<String>,
}

impl<T> From<Paged<T>> for List<T> {
    fn from(paged: Paged<T>) -> Self {
        Self { items: paged.items, next_cursor: paged.next_cursor }
    }
}

impl<T: Serialize> IntoResponse for List<T> {
    fn into_response(self) -> Response {
        Json(self).into_response()
    }
}

/// Which page of a list.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PageQuery {
    /// The `next_cursor` of the page before; without it, the first page.
    pub cursor: Option<String>,
    /// The most records to return.
    #[param(minimum = 1, maximum = 500, default = 50)]
    pub limit: Option<u32>,
}

impl FromQuery for PageQuery {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let (min, max) = PAGE_LIMITS;
        Some(Self { cursor: fields.text("cursor"), limit: fields.integer("limit", min..=max) })
    }
}

impl From<PageQuery> for Page {
    fn from(query: PageQuery) -> Self {
        Self { after: query.cursor, limit: query.limit.unwrap_or(PAGE_LIMIT_DEFAULT) }
    }
}
