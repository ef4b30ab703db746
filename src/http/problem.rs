//! RFC 9457 problem documents: how every error is answered, written by one middleware.

use std::fmt;

use axum::Json;
use axum::extract::Request;
use axum::http::header::{CONTENT_TYPE, HeaderValue};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tower_http::request_id::RequestId;
use utoipa::ToSchema;

/// The media type of a problem document.
pub const MEDIA_TYPE: &str = "application/problem+json";
/// What a problem's `type` begins with.
const TYPE_PREFIX: &str = "urn:problem-type:elevon:";

/// What is wrong with one field.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct FieldError {
    /// Where: a JSON pointer into the body (`/thresholds/kgm`), a query name (`?usage`), or a place in an uploaded file
    /// (`line 12, column load_pressure_pa`).
    #[schema(example = "?usage")]
    pub pointer: String,
    /// What was found there and what was expected.
    #[schema(example = "found -1, expected a finite number, at least 0")]
    pub detail: String,
}

impl FieldError {
    /// A fault at a place.
    pub fn new(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), detail: detail.into() }
    }
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.pointer.as_str() {
            "" => f.write_str(&self.detail),
            pointer => write!(f, "{pointer}: {}", self.detail),
        }
    }
}

/// A problem on its way out: a handler puts it into its response's extensions.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The last part of its type.
    pub kind: &'static str,
    /// Its title, the same for every problem of one type.
    pub title: &'static str,
    /// The answer's status.
    pub status: StatusCode,
    /// What happened this time.
    pub detail: String,
    /// The fields at fault.
    pub errors: Vec<FieldError>,
    /// What is logged and not told.
    pub cause: Option<String>,
}

/// A problem document (RFC 9457).
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Problem)]
pub struct ProblemDocument {
    /// The problem's type.
    #[serde(rename = "type")]
    #[schema(example = "urn:problem-type:elevon:invalid-value")]
    pub kind: String,
    /// The type's title.
    #[schema(example = "Value out of range")]
    pub title: String,
    /// The answer's status.
    #[schema(example = 422, minimum = 400, maximum = 599)]
    pub status: u16,
    /// What happened this time.
    #[schema(
        example = "the request holds values that are out of range: ?usage: found -1, expected a finite number, at least 0"
    )]
    pub detail: String,
    /// Every field at fault, at most 100; empty when none is.
    pub errors: Vec<FieldError>,
    /// The request's id, as in the `x-request-id` header and in the service's log.
    #[schema(example = "01a2b3c4-0000-7000-8000-000000000000")]
    pub request_id: String,
}

/// Gives every error answer its body, whoever made it: a handler, the router or another middleware.
pub async fn write_problems(request: Request, next: Next) -> Response {
    let request_id = request_id(request.extensions().get());
    let method = request.method().clone();
    let path = request.uri().path().to_owned();
    let mut response = next.run(request).await;
    let problem = match response.extensions_mut().remove::<Problem>() {
        Some(problem) => problem,
        None if is_bare_error(&response) => Problem::bare(response.status(), response.headers()),
        None => return response,
    };
    if problem.is_failure() {
        let cause = problem.cause.as_deref().unwrap_or(&problem.detail);
        tracing::error!(request_id, %method, path, status = problem.status.as_u16(), cause, "the request failed");
    }
    problem.answer(request_id, response)
}

/// The id of a request, as set by the outermost layer.
pub fn request_id(id: Option<&RequestId>) -> String {
    id.and_then(|id| id.header_value().to_str().ok()).unwrap_or_default().to_owned()
}

fn is_bare_error(response: &Response) -> bool {
    let status = response.status();
    status.is_client_error() || status.is_server_error()
}

impl Problem {
    /// Whether the service failed, and did not merely refuse: a full queue is no failure.
    fn is_failure(&self) -> bool {
        self.status.is_server_error() && (self.cause.is_some() || self.status != StatusCode::SERVICE_UNAVAILABLE)
    }

    /// The problem that a bare status stands for.
    fn bare(status: StatusCode, headers: &HeaderMap) -> Self {
        let (kind, title) = match status {
            StatusCode::METHOD_NOT_ALLOWED => ("method-not-allowed", "Method not allowed"),
            StatusCode::GATEWAY_TIMEOUT => ("timeout", "Request over its time"),
            StatusCode::INTERNAL_SERVER_ERROR => ("internal", "Internal error"),
            _ => ("request-refused", status.canonical_reason().unwrap_or("Request refused")),
        };
        let detail = match status {
            StatusCode::METHOD_NOT_ALLOWED => {
                let allowed = headers.get(axum::http::header::ALLOW).and_then(|value| value.to_str().ok());
                format!("this path allows {}", allowed.unwrap_or("other methods"))
            }
            StatusCode::GATEWAY_TIMEOUT => "the request was not answered within its time".into(),
            StatusCode::INTERNAL_SERVER_ERROR => "the service failed; its log says why under this request id".into(),
            _ => format!("the request was refused with status {status}"),
        };
        Self { kind, title, status, detail, errors: Vec::new(), cause: None }
    }

    /// The answer, with the headers that were set on the way.
    fn answer(self, request_id: String, response: Response) -> Response {
        let document = ProblemDocument {
            kind: format!("{TYPE_PREFIX}{}", self.kind),
            title: self.title.into(),
            status: self.status.as_u16(),
            detail: self.detail,
            errors: self.errors,
            request_id,
        };
        let mut answer = (self.status, Json(document)).into_response();
        let headers = response.headers().iter().filter(|(name, _)| !name.as_str().starts_with("content-"));
        answer.headers_mut().extend(headers.map(|(name, value)| (name.clone(), value.clone())));
        answer.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(MEDIA_TYPE));
        answer
    }
}
