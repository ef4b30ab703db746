//! Jobs.

mod cancel;
mod get;
mod list;

use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;

/// The routes under `/v1/jobs`.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(list::list_jobs)).routes(routes!(get::get_job, cancel::cancel_job))
}
