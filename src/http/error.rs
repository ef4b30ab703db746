//! Everything that a handler can refuse or fail at.

use std::error::Error as _;
use std::fmt::Display;

use axum::http::header::{HeaderValue, RETRY_AFTER};
use axum::http::{HeaderName, StatusCode};
use axum::response::{IntoResponse, Response};
use thiserror::Error;

use super::limits::{ERRORS_MAX, RETRY_AFTER_S};
use super::problem::{FieldError, Problem};
use crate::jobs::text::causes;
use crate::store::StoreError;
use crate::store::alerts::AlertState;
use crate::store::records::JobState;

/// Why a request is not answered as it was meant. [`IntoResponse`] makes it a problem document.
#[derive(Debug, Error)]
pub enum ApiError {
    /// Nothing has this path.
    #[error("nothing is at this path")]
    UnknownPath,
    /// The request is meant for another host than this machine.
    #[error("Host: found {found:?}, expected localhost or a loopback address")]
    ForeignHost {
        /// The host that it names.
        found: String,
    },
    /// No record has this id.
    #[error("no {what} has the id {id:?}")]
    NotFound {
        /// The kind of record.
        what: &'static str,
        /// What was given as its id.
        id: String,
    },
    /// No record has this name.
    #[error("no {what} is named {name:?}")]
    NotNamed {
        /// The kind of record.
        what: &'static str,
        /// What was given as its name.
        name: String,
    },
    /// The request cannot be read: unknown names, wrong types, broken syntax.
    #[error("the request cannot be read: {}", summary(.0))]
    Malformed(Vec<FieldError>),
    /// The request can be read, but values are out of their range.
    #[error("the request holds values that are out of range: {}", summary(.0))]
    Invalid(Vec<FieldError>),
    /// The uploaded file is not a usable trace.
    #[error("the file is not a usable trace: {}", summary(.0))]
    BadTrace(Vec<FieldError>),
    /// The request needs a body and has none.
    #[error("the body is empty, expected {expected}")]
    EmptyBody {
        /// The media types that would have been right.
        expected: String,
    },
    /// The connection broke before the body was complete.
    #[error("the body did not arrive completely")]
    BrokenBody,
    /// The body's media type is absent or not understood.
    #[error("Content-Type: found {}, expected {expected}", found.as_deref().unwrap_or("none"))]
    UnsupportedMediaType {
        /// The Content-Type that was given.
        found: Option<String>,
        /// The media types that would have been right.
        expected: String,
    },
    /// The body is encoded.
    #[error("Content-Encoding: found {found}, expected identity or none")]
    UnsupportedEncoding {
        /// The Content-Encoding that was given.
        found: String,
    },
    /// The answer exists in no form that the request accepts.
    #[error("Accept: found {found:?}, expected one of {expected}")]
    NotAcceptable {
        /// The Accept that was given.
        found: String,
        /// The media types that can be had.
        expected: String,
    },
    /// The body is too long.
    #[error("the body is longer than the limit of {limit_bytes} bytes")]
    TooLarge {
        /// The longest body, bytes.
        limit_bytes: usize,
    },
    /// The body took too long to arrive.
    #[error("the body did not arrive within {limit_s} s")]
    SlowBody {
        /// The time that it may take, s.
        limit_s: f64,
    },
    /// A value that must be unique is taken.
    #[error("{field} {value:?} is taken already")]
    Taken {
        /// The field.
        field: &'static str,
        /// The value.
        value: String,
    },
    /// A value is kept for the service itself.
    #[error("{field} {value:?} is that of a built-in record, expected another {field}")]
    Reserved {
        /// The field.
        field: &'static str,
        /// The value.
        value: String,
    },
    /// The job has ended and cannot be cancelled any more.
    #[error("the job has {} already and cannot be cancelled", state.name())]
    JobOver {
        /// How it ended.
        state: JobState,
    },
    /// The alert has been acknowledged with another note or is cleared.
    #[error("the alert is {} already and cannot be acknowledged again", state.name())]
    AlertOver {
        /// Its state.
        state: AlertState,
    },
    /// Nothing is sent to a webhook that is disabled.
    #[error("the webhook is disabled, and nothing is sent to it")]
    WebhookDisabled,
    /// As many records of a kind are kept as may be.
    #[error("there are as many {what} as may be: {limit}; delete one first")]
    TooMany {
        /// The kind of record.
        what: &'static str,
        /// The most that may be kept.
        limit: u32,
    },
    /// As many jobs wait as may wait.
    #[error("{queued} jobs are waiting and {limit} may; try again in {RETRY_AFTER_S} s")]
    QueueFull {
        /// The jobs that wait.
        queued: u64,
        /// The most that may.
        limit: u64,
    },
    /// The store cannot do this just now: its disk is full, or another process holds its lock.
    #[error("the store cannot do this just now; try again in {RETRY_AFTER_S} s")]
    StoreBusy(#[source] StoreError),
    /// The records cannot be read or written just now.
    #[error("the records cannot be read or written")]
    NotReady(#[source] StoreError),
    /// Something that should work did not. The causes are logged, and not told.
    #[error("the service failed; its log says why under this request id")]
    Internal(#[source] anyhow::Error),
}

/// A result of a handler.
pub type ApiResult<T> = Result<T, ApiError>;

impl ApiError {
    /// A failure of the service itself.
    pub fn internal(cause: impl Into<anyhow::Error>) -> Self {
        Self::Internal(cause.into())
    }

    /// No record of this kind has this id.
    pub fn not_found(what: &'static str, id: impl Display) -> Self {
        Self::NotFound { what, id: id.to_string() }
    }

    /// One field that cannot be read.
    pub fn malformed(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self::Malformed(vec![FieldError::new(pointer, detail)])
    }

    /// One field that can be read and is out of its range.
    pub fn invalid(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self::Invalid(vec![FieldError::new(pointer, detail)])
    }

    /// The status, the problem type's last part and its title.
    fn kind(&self) -> (StatusCode, &'static str, &'static str) {
        match self {
            Self::UnknownPath => (StatusCode::NOT_FOUND, "unknown-path", "Unknown path"),
            Self::ForeignHost { .. } => (StatusCode::MISDIRECTED_REQUEST, "foreign-host", "Foreign host"),
            Self::NotFound { .. } | Self::NotNamed { .. } => (StatusCode::NOT_FOUND, "not-found", "No such record"),
            Self::Malformed(_) => (StatusCode::BAD_REQUEST, "malformed-request", "Malformed request"),
            Self::EmptyBody { .. } => (StatusCode::BAD_REQUEST, "empty-body", "Empty body"),
            Self::BrokenBody => (StatusCode::BAD_REQUEST, "broken-body", "Incomplete body"),
            Self::Invalid(_) => (StatusCode::UNPROCESSABLE_ENTITY, "invalid-value", "Value out of range"),
            Self::BadTrace(_) => (StatusCode::UNPROCESSABLE_ENTITY, "invalid-trace", "Unusable trace"),
            Self::UnsupportedMediaType { .. } => {
                (StatusCode::UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", "Unsupported media type")
            }
            Self::UnsupportedEncoding { .. } => {
                (StatusCode::UNSUPPORTED_MEDIA_TYPE, "unsupported-encoding", "Unsupported content encoding")
            }
            Self::NotAcceptable { .. } => (StatusCode::NOT_ACCEPTABLE, "not-acceptable", "Not acceptable"),
            Self::TooLarge { .. } => (StatusCode::PAYLOAD_TOO_LARGE, "body-too-large", "Body too large"),
            Self::SlowBody { .. } => (StatusCode::REQUEST_TIMEOUT, "slow-body", "Body too slow"),
            Self::Taken { .. } => (StatusCode::CONFLICT, "taken", "Value taken"),
            Self::Reserved { .. } => (StatusCode::CONFLICT, "reserved", "Value reserved"),
            Self::JobOver { .. } => (StatusCode::CONFLICT, "job-over", "Job over"),
            Self::AlertOver { .. } => (StatusCode::CONFLICT, "alert-over", "Alert acknowledged or cleared"),
            Self::WebhookDisabled => (StatusCode::CONFLICT, "webhook-disabled", "Webhook disabled"),
            Self::TooMany { .. } => (StatusCode::CONFLICT, "too-many", "Too many records"),
            Self::QueueFull { .. } => (StatusCode::SERVICE_UNAVAILABLE, "queue-full", "Queue full"),
            Self::StoreBusy(_) => (StatusCode::SERVICE_UNAVAILABLE, "store-busy", "Store busy or full"),
            Self::NotReady(_) => (StatusCode::SERVICE_UNAVAILABLE, "not-ready", "Not ready"),
            Self::Internal(_) => (StatusCode::INTERNAL_SERVER_ERROR, "internal", "Internal error"),
        }
    }

    /// The fields at fault.
    fn into_errors(self) -> Vec<FieldError> {
        match self {
            Self::Malformed(mut errors) | Self::Invalid(mut errors) | Self::BadTrace(mut errors) => {
                errors.truncate(ERRORS_MAX);
                errors
            }
            Self::Taken { field, value } => {
                vec![FieldError::new(format!("/{field}"), format!("found {value:?}, which is taken already"))]
            }
            Self::Reserved { field, value } => {
                let detail = format!("found {value:?}, which is that of a built-in record, expected another {field}");
                vec![FieldError::new(format!("/{field}"), detail)]
            }
            _ => Vec::new(),
        }
    }

    /// The chain of causes of a failure of the service itself.
    fn cause(&self) -> Option<String> {
        self.source().map(causes)
    }

    /// A header that says more.
    fn header(&self) -> Option<(HeaderName, HeaderValue)> {
        match self {
            Self::QueueFull { .. } | Self::StoreBusy(_) | Self::NotReady(_) => {
                Some((RETRY_AFTER, HeaderValue::from(RETRY_AFTER_S)))
            }
            _ => None,
        }
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let (status, kind, title) = self.kind();
        let header = self.header();
        let cause = self.cause();
        let detail = self.to_string();
        let problem = Problem { kind, title, status, detail, errors: self.into_errors(), cause };
        let mut response = status.into_response();
        response.headers_mut().extend(header);
        response.extensions_mut().insert(problem);
        response
    }
}

impl From<StoreError> for ApiError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Conflict { field, value } => Self::Taken { field, value },
            StoreError::TooMany { what, limit } => Self::TooMany { what, limit },
            StoreError::QueueFull { queued, limit } => Self::QueueFull { queued, limit },
            StoreError::Cursor { found } => {
                let detail = format!("found {found:?}, expected the next_cursor of a page of this list");
                Self::malformed("?cursor", detail)
            }
            passing if passing.may_pass() => Self::StoreBusy(passing),
            other => Self::internal(other),
        }
    }
}

/// The first error and the number of those that follow it.
fn summary(errors: &[FieldError]) -> String {
    match errors {
        [] => String::new(),
        [only] => only.to_string(),
        [first, rest @ ..] => format!("{first} (and {} more)", rest.len()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;

    #[test]
    fn a_store_that_may_work_again_asks_to_try_again_and_another_failure_does_not() {
        for (kind, status, retry) in [
            (ErrorKind::StorageFull, StatusCode::SERVICE_UNAVAILABLE, true),
            (ErrorKind::PermissionDenied, StatusCode::INTERNAL_SERVER_ERROR, false),
        ] {
            let error = StoreError::File { path: "00".into(), source: Error::from(kind) };
            let response = ApiError::from(error).into_response();
            assert_eq!((response.status(), response.headers().contains_key(RETRY_AFTER)), (status, retry), "{kind}");
        }
    }
}
