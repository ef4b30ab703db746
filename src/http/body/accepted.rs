//! Answers to what was made: 201 with the record, 202 with the job that will make it.

use axum::Json;
use axum::http::StatusCode;
use axum::http::header::LOCATION;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use crate::store::records::{Job, TraceRecord};

/// A record that was made, and its path.
#[derive(Debug)]
pub struct Created<T> {
    /// Where the record is.
    pub location: String,
    /// The record.
    pub record: T,
}

impl<T: Serialize> IntoResponse for Created<T> {
    fn into_response(self) -> Response {
        (StatusCode::CREATED, [(LOCATION, self.location)], Json(self.record)).into_response()
    }
}

/// A trace that was kept, and the job that will estimate from it.
#[derive(Debug, Serialize, ToSchema)]
pub struct UploadAccepted {
    /// The trace.
    pub trace: TraceRecord,
    /// The job.
    pub job: Job,
}

impl IntoResponse for UploadAccepted {
    fn into_response(self) -> Response {
        accepted(&self.job, &self)
    }
}

/// A job that was queued.
#[derive(Debug, Serialize, ToSchema)]
pub struct JobAccepted {
    /// The job.
    pub job: Job,
}

impl IntoResponse for JobAccepted {
    fn into_response(self) -> Response {
        accepted(&self.job, &self)
    }
}

fn accepted(job: &Job, body: &impl Serialize) -> Response {
    (StatusCode::ACCEPTED, [(LOCATION, format!("/v1/jobs/{}", job.id))], Json(body)).into_response()
}
