//! The handlers: parse, call, answer.

pub mod actuators;
pub mod dashboard;
pub mod health;
pub mod jobs;
pub mod maintenance;
pub mod service;
pub mod simulations;
pub mod specification;
pub mod traces;

use super::App;
use super::error::{ApiError, ApiResult};
use super::extract::id::PathId;
use crate::store::records::Actuator;

/// The actuator that a path names.
async fn actuator(app: &App, id: &PathId) -> ApiResult<Actuator> {
    let id = id.of("actuator")?;
    app.records.actuator(id).await?.ok_or_else(|| ApiError::not_found("actuator", id))
}
