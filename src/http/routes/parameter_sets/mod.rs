//! Parameter sets: actuator types as data.

mod create;
mod get;
mod list;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes under `/v1/parameter-sets`.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(create::create_parameter_set, list::list_parameter_sets))
        .routes(routes!(get::get_parameter_set))
}
