//! Traces.

mod change;
mod data;
mod get;
mod upload;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::formats::Format;
use crate::http::App;

/// The formats that a trace can come and go in, by media type; the first is given to those who do not choose.
const FORMATS: [(&str, Format); 2] =
    [(Format::Csv.media_type(), Format::Csv), (Format::Json.media_type(), Format::Json)];

/// The routes about traces.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(upload::upload_trace))
        .routes(routes!(get::get_trace, change::change_trace))
        .routes(routes!(data::trace_data))
}
