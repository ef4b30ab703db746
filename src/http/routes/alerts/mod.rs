//! Alerts.

mod change;
mod get;
mod list;
mod of_actuator;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes about alerts.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(list::list_alerts))
        .routes(routes!(get::get_alert, change::change_alert))
        .routes(routes!(of_actuator::list_actuator_alerts))
}
