//! The service's door: JSON over HTTP under `/v1`, its specification, its health and the dashboard.
//!
//! A handler parses, calls the store or the jobs, and answers. Every error is one RFC 9457 document, written in one
//! place ([`problem`]).

pub mod body;
pub mod error;
pub mod extract;
pub mod host;
pub mod limits;
pub mod observe;
pub mod openapi;
pub mod problem;
pub mod router;
pub mod routes;

use std::sync::Arc;

use axum::extract::FromRef;

use crate::jobs::Jobs;
use crate::store::records::Thresholds;
use crate::store::{Records, Traces};
use limits::Limits;

/// What the handlers work with. A clone is cheap.
#[derive(Clone)]
pub struct App {
    /// The records.
    pub records: Arc<dyn Records>,
    /// The bytes of the traces.
    pub traces: Arc<dyn Traces>,
    /// The jobs.
    pub jobs: Jobs,
    /// Healthy traces that make an actuator's baseline, at least 1.
    pub baseline_traces: usize,
    /// The failure thresholds of an actuator that is registered without its own.
    pub thresholds: Thresholds,
    /// What a request may cost.
    pub limits: Limits,
}

impl FromRef<App> for Limits {
    fn from_ref(app: &App) -> Self {
        app.limits.clone()
    }
}
