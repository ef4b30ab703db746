//! Actuators.

mod change;
mod create;
mod get;
mod list;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes under `/v1/actuators` that are about actuators alone.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(create::create_actuator, list::list_actuators))
        .routes(routes!(get::get_actuator, change::change_actuator))
}
