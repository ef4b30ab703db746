//! Asking for a simulation.

use std::sync::Arc;

use super::check::FieldErrors;
use crate::http::error::ApiResult;
use crate::http::limits::COMMAND_CHARS_MAX;
use crate::jobs::kind::SimulationSpec;
use crate::jobs::sets;
use crate::models::drive::{Drive, DriveError};
use crate::models::parameters::ParameterSet;

/// A simulation whose every field is in its range, its command without the space around it, pinned to a parameter set: the
/// one that it names, or what is wrong with the name.
///
/// # Errors
/// Every field out of its range.
pub fn check(mut spec: SimulationSpec, set: Result<Arc<ParameterSet>, String>) -> ApiResult<SimulationSpec> {
    let mut found = FieldErrors::default();
    spec.command = found.text("/command", &spec.command, (1, COMMAND_CHARS_MAX), false);
    // A command that cannot be read must not hide the other fields' errors.
    let command = if found.is_empty() { read_command(&spec.command, &mut found) } else { None };
    let recipe = spec.recipe_with(command.unwrap_or(Drive::Diagnostic));
    for error in recipe.check(set.as_deref().unwrap_or(&ParameterSet::reference())) {
        let Some(field) = error.field() else { continue };
        let text = error.to_string();
        // A product of two fields is named in the text too.
        let detail = if field.contains(' ') { &text } else { text.trim_start_matches(field).trim_start_matches(": ") };
        found.add(pointer(field), detail);
    }
    match set {
        Ok(set) => spec.parameter_set = Some(sets::named(&set)),
        Err(detail) => found.add("/parameter_set", detail),
    }
    found.pass(spec)
}

/// Reads a command. A file of the service's machine is none of a client's business.
fn read_command(text: &str, found: &mut FieldErrors) -> Option<Drive> {
    if text.starts_with("file:") {
        found.add("/command", "found a file, expected a command that needs none; files work on the command line only");
        return None;
    }
    let read: Result<Drive, DriveError> = text.parse();
    read.map_err(|error| found.add("/command", format!("found {:?}, expected {}", error.found, error.expected))).ok()
}

/// Where a field of the recipe stands in the body; what is said of two fields points to the first.
fn pointer(name: &str) -> String {
    let field = name.split(' ').next().unwrap_or_default();
    format!("/{}", field.replace('.', "/"))
}
