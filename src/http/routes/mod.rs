//! The handlers: parse, call, answer.

pub mod actuators;
pub mod alerts;
pub mod dashboard;
pub mod estimations;
pub mod health;
pub mod jobs;
pub mod maintenance;
pub mod parameter_sets;
pub mod service;
pub mod simulations;
pub mod specification;
pub mod traces;
pub mod webhooks;

use std::sync::Arc;

use super::App;
use super::error::{ApiError, ApiResult};
use super::extract::id::PathId;
use crate::jobs::sets::{self, SetError};
use crate::models::parameters::ParameterSet;
use crate::store::records::Actuator;

/// The actuator that a path names.
async fn actuator(app: &App, id: &PathId) -> ApiResult<Actuator> {
    let id = id.of("actuator")?;
    app.records.actuator(id).await?.ok_or_else(|| ApiError::not_found("actuator", id))
}

/// The parameter set that a body names, the built-in one unless told; or what is wrong with the name, to be told with the
/// body's other errors.
async fn parameter_set(app: &App, name: Option<&str>) -> ApiResult<Result<Arc<ParameterSet>, String>> {
    let name = name.unwrap_or(ParameterSet::reference_name());
    match sets::resolve(app.records.as_ref(), name.trim()).await {
        Err(SetError::Store(error)) => Err(error.into()),
        found => Ok(found.map_err(|error| error.to_string())),
    }
}
