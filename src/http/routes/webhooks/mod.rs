//! Webhooks.

mod change;
mod create;
mod delete;
mod deliveries;
mod get;
mod list;
mod test;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes under `/v1/webhooks`.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(list::list_webhooks, create::create_webhook))
        .routes(routes!(get::get_webhook, change::change_webhook, delete::delete_webhook))
        .routes(routes!(deliveries::list_deliveries))
        .routes(routes!(test::test_webhook))
}
