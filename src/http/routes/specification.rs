//! The specification of this service, by the service.

use std::sync::LazyLock;

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;
use crate::http::openapi::{self, PlainProblems};

/// The routes of the specification.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(openapi_yaml)).routes(routes!(openapi_json))
}

static YAML: LazyLock<String> = LazyLock::new(|| openapi::yaml().expect("the specification is YAML"));
static JSON: LazyLock<String> = LazyLock::new(|| openapi::json().expect("the specification is JSON"));

/// This specification as YAML.
#[utoipa::path(
    get,
    path = "/openapi.yaml",
    tag = "service",
    responses(
        (status = 200, description = "The specification", body = String, content_type = "application/yaml"),
        PlainProblems
    )
)]
async fn openapi_yaml() -> Response {
    ([(CONTENT_TYPE, "application/yaml")], YAML.as_str()).into_response()
}

/// This specification as JSON.
#[utoipa::path(
    get,
    path = "/openapi.json",
    tag = "service",
    responses(
        (status = 200, description = "The specification", body = serde_json::Value),
        PlainProblems
    )
)]
async fn openapi_json() -> Response {
    ([(CONTENT_TYPE, "application/json")], JSON.as_str()).into_response()
}
