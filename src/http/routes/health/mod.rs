//! Health: of one actuator over time, what remains of its life, and of the fleet.

mod baseline;
mod fleet;
mod history;
mod remaining_life;
mod trend;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes about health.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(history::health_history))
        .routes(routes!(baseline::baseline))
        .routes(routes!(remaining_life::remaining_life))
        .routes(routes!(trend::remaining_life_trend))
        .routes(routes!(fleet::fleet_health))
}
