//! The routes and what every request passes through.

use axum::Router;
use axum::body::Body;
use axum::http::header::X_CONTENT_TYPE_OPTIONS;
use axum::http::{HeaderName, HeaderValue, Request, StatusCode};
use axum::middleware::{from_fn, map_request};
use axum::response::{IntoResponse, Response};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::request_id::{MakeRequestId, PropagateRequestIdLayer, RequestId, SetRequestIdLayer};
use tower_http::set_header::SetResponseHeaderLayer;
use tower_http::timeout::TimeoutLayer;
use utoipa_axum::router::OpenApiRouter;

use super::error::ApiError;
use super::limits::Limits;
use super::{App, host, observe, openapi, problem, routes};
use crate::jobs::text::panic_message;
use crate::store::records::Id;

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// The whole service as a router.
pub fn router(app: App) -> Router {
    let limits = app.limits.clone();
    let (routes, _) = documented().split_for_parts();
    with_middleware(routes.fallback(unknown_path).with_state(app), &limits)
}

/// The specification of every route.
#[must_use]
pub fn specification() -> utoipa::openapi::OpenApi {
    let mut document = documented().into_openapi();
    openapi::refer_to_items(&mut document);
    document
}

/// Every route with its documentation; there is no other way in.
fn documented() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(openapi::base())
        .merge(routes::actuators::routes())
        .merge(routes::traces::routes())
        .merge(routes::parameter_sets::routes())
        .merge(routes::simulations::routes())
        .merge(routes::estimations::routes())
        .merge(routes::jobs::routes())
        .merge(routes::health::routes())
        .merge(routes::maintenance::routes())
        .merge(routes::alerts::routes())
        .merge(routes::webhooks::routes())
        .merge(routes::service::routes())
        .merge(routes::specification::routes())
        .merge(routes::dashboard::routes())
}

/// Puts around some routes what every request passes through; the last layer is the outermost.
fn with_middleware(routes: Router, limits: &Limits) -> Router {
    routes
        .layer(TimeoutLayer::with_status_code(StatusCode::GATEWAY_TIMEOUT, limits.request_time))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(from_fn(host::refuse_foreign))
        .layer(from_fn(problem::write_problems))
        .layer(CompressionLayer::new())
        .layer(from_fn(observe::observe))
        .layer(SetResponseHeaderLayer::overriding(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")))
        .layer(PropagateRequestIdLayer::new(REQUEST_ID))
        .layer(SetRequestIdLayer::new(REQUEST_ID, TimedIds))
        .layer(map_request(drop_unusable_id))
}

/// Takes a client's own id away unless it is one, of 1 to 128 visible ASCII characters: it goes into the log and back.
async fn drop_unusable_id(mut request: Request<Body>) -> Request<Body> {
    let usable = |id: &HeaderValue| (1..=128).contains(&id.len()) && id.as_bytes().iter().all(u8::is_ascii_graphic);
    let mut ids = request.headers().get_all(REQUEST_ID).iter();
    if !ids.next().is_some_and(usable) || ids.next().is_some() {
        request.headers_mut().remove(REQUEST_ID);
    }
    request
}

/// Request ids that sort by time, as every id does.
#[derive(Debug, Clone, Copy)]
struct TimedIds;

impl MakeRequestId for TimedIds {
    fn make_request_id<B>(&mut self, _request: &Request<B>) -> Option<RequestId> {
        HeaderValue::from_str(&Id::now().to_string()).ok().map(RequestId::new)
    }
}

async fn unknown_path() -> ApiError {
    ApiError::UnknownPath
}

fn panicked(panic: Box<dyn std::any::Any + Send>) -> Response {
    ApiError::internal(anyhow::anyhow!("a handler panicked: {}", panic_message(panic.as_ref()))).into_response()
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::routing::get;
    use serde_json::Value;
    use tower::ServiceExt;

    use super::*;
    use crate::config::HttpConfig;

    async fn answer(routes: Router, limits: HttpConfig) -> (StatusCode, Value) {
        let router = with_middleware(routes, &Limits::from(&limits));
        let request = Request::get("/x").header("x-request-id", "abc").body(Body::empty()).unwrap();
        let response = router.oneshot(request).await.unwrap();
        assert_eq!(response.headers()["content-type"], "application/problem+json");
        assert_eq!(response.headers()["x-request-id"], "abc");
        let status = response.status();
        let body = axum::body::to_bytes(response.into_body(), 10_000).await.unwrap();
        (status, serde_json::from_slice(&body).unwrap())
    }

    #[tokio::test]
    async fn a_panic_is_a_problem_that_does_not_tell_what_happened() {
        let routes = Router::new().route("/x", get(|| async { panic!("secret") as StatusCode }));
        let (status, problem) = answer(routes, HttpConfig::default()).await;
        assert_eq!(status, StatusCode::INTERNAL_SERVER_ERROR);
        assert_eq!(problem["request_id"], "abc");
        assert_eq!(problem["status"], 500);
        assert!(!problem.to_string().contains("secret"), "{problem}");
    }

    #[tokio::test]
    async fn a_request_over_its_time_is_a_problem() {
        let routes = Router::new().route("/x", get(std::future::pending::<StatusCode>));
        let limits = HttpConfig { request_time_s: 0.01, ..HttpConfig::default() };
        let (status, problem) = answer(routes, limits).await;
        assert_eq!(status, StatusCode::GATEWAY_TIMEOUT);
        assert_eq!(problem["type"], "urn:problem-type:elevon:timeout");
    }

    #[tokio::test]
    async fn a_bare_error_status_from_anywhere_becomes_a_problem() {
        let routes = Router::new().route("/x", get(|| async { StatusCode::IM_A_TEAPOT }));
        let (status, problem) = answer(routes, HttpConfig::default()).await;
        assert_eq!(status, StatusCode::IM_A_TEAPOT);
        assert_eq!(problem["title"], "I'm a teapot");
    }
}
