//! One line of the log and two metrics for every request.

use std::time::Instant;

use axum::extract::{MatchedPath, Request};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::Response;

use super::problem::request_id;

/// Counts and times a request, by its route's template, its method and its status, and logs it.
pub async fn observe(request: Request, next: Next) -> Response {
    let started = Instant::now();
    let route = request.extensions().get::<MatchedPath>().map_or("unmatched", MatchedPath::as_str).to_owned();
    let method = method_name(request.method());
    let request_id = request_id(request.extensions().get());
    let response = next.run(request).await;
    let elapsed_s = started.elapsed().as_secs_f64();
    let status = response.status().as_u16();
    let labels = [("route", route.clone()), ("method", method.to_owned()), ("status", status.to_string())];
    metrics::counter!("elevon_http_requests_total", &labels).increment(1);
    metrics::histogram!("elevon_http_request_duration_seconds", &labels).record(elapsed_s);
    tracing::debug!(request_id, method, route, status, elapsed_s, "answered");
    response
}

/// A method as a label: those that nobody defined share one, so that clients cannot make labels.
fn method_name(method: &Method) -> &'static str {
    match method.as_str() {
        "GET" => "GET",
        "HEAD" => "HEAD",
        "POST" => "POST",
        "PUT" => "PUT",
        "PATCH" => "PATCH",
        "DELETE" => "DELETE",
        "OPTIONS" => "OPTIONS",
        _ => "other",
    }
}
