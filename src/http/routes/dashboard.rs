//! The dashboard: a page, its style and its scripts, which the program carries within it.

use axum::extract::Path;
use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::http::App;
use crate::http::error::{ApiError, ApiResult};
use crate::http::openapi::PlainProblems;

/// The page may load from this service alone, and nothing may frame it.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
    base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";
const INDEX: &str = include_str!("../dashboard/index.html");

/// The page's other files: name, media type, content.
const ASSETS: &[(&str, &str, &str)] = &[
    ("actuator.js", SCRIPT, include_str!("../dashboard/actuator.js")),
    ("alerts.js", SCRIPT, include_str!("../dashboard/alerts.js")),
    ("answer.js", SCRIPT, include_str!("../dashboard/answer.js")),
    ("api.js", SCRIPT, include_str!("../dashboard/api.js")),
    ("chart.js", SCRIPT, include_str!("../dashboard/chart.js")),
    ("dashboard.js", SCRIPT, include_str!("../dashboard/dashboard.js")),
    ("dom.js", SCRIPT, include_str!("../dashboard/dom.js")),
    ("figure.js", SCRIPT, include_str!("../dashboard/figure.js")),
    ("fleet.js", SCRIPT, include_str!("../dashboard/fleet.js")),
    ("format.js", SCRIPT, include_str!("../dashboard/format.js")),
    ("gauges.js", SCRIPT, include_str!("../dashboard/gauges.js")),
    ("icon.svg", SVG, include_str!("../dashboard/icon.svg")),
    ("plot.js", SCRIPT, include_str!("../dashboard/plot.js")),
    ("status.js", SCRIPT, include_str!("../dashboard/status.js")),
    ("strip.js", SCRIPT, include_str!("../dashboard/strip.js")),
    ("style.css", CSS, include_str!("../dashboard/style.css")),
    ("theme.js", SCRIPT, include_str!("../dashboard/theme.js")),
    ("trend.js", SCRIPT, include_str!("../dashboard/trend.js")),
];

/// The routes of the dashboard.
pub fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::new().routes(routes!(dashboard)).routes(routes!(asset))
}

/// The dashboard.
#[utoipa::path(
    get,
    path = "/",
    tag = "service",
    responses((status = 200, description = "A page", body = String, content_type = "text/html"), PlainProblems)
)]
async fn dashboard() -> Response {
    file(HTML, INDEX)
}

/// A file of the dashboard.
#[utoipa::path(
    get,
    path = "/assets/{name}",
    tag = "service",
    params(("name" = String, Path, description = "The file's name, as in `style.css`")),
    responses(
        (status = 200, description = "The file", content(
            (String = "text/css"), (String = "text/javascript"), (String = "image/svg+xml")
        )),
        (status = 404, description = "No such file", content_type = "application/problem+json",
         body = crate::http::problem::ProblemDocument),
        PlainProblems
    )
)]
async fn asset(Path(name): Path<String>) -> ApiResult<Response> {
    let found = ASSETS.iter().find(|(asset, ..)| *asset == name);
    found.map(|(_, media_type, text)| file(media_type, text)).ok_or(ApiError::UnknownPath)
}

fn file(media_type: &'static str, text: &'static str) -> Response {
    ([(CONTENT_TYPE, media_type), (CONTENT_SECURITY_POLICY, POLICY)], text).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_dashboard_is_served() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/http/dashboard");
        let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut files: Vec<_> = names.filter(|name| name != "index.html").collect();
        files.sort();
        assert_eq!(files, ASSETS.iter().map(|(name, ..)| *name).collect::<Vec<_>>());
    }
}
