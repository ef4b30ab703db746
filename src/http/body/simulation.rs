//! Asking for a simulation.

use super::check::FieldErrors;
use crate::http::error::ApiResult;
use crate::http::limits::COMMAND_CHARS_MAX;
use crate::jobs::kind::SimulationSpec;
use crate::models::drive::{Drive, DriveError};
use crate::models::simulate::SimulationError;

/// A simulation whose every field is in its range, its command without the space around it.
///
/// # Errors
/// Every field out of its range.
pub fn check(mut spec: SimulationSpec) -> ApiResult<SimulationSpec> {
    let mut found = FieldErrors::default();
    spec.command = found.text("/command", &spec.command, (1, COMMAND_CHARS_MAX), false);
    // A command that cannot be read must not hide the other fields' errors.
    let command = read_command(&spec.command, &mut found).unwrap_or(Drive::Diagnostic);
    for error in spec.recipe_with(command).check() {
        if let SimulationError::OutOfRange { name, found: value, expected } = error {
            found.add(pointer(name), format!("{name}: found {value}, expected {expected}"));
        }
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
    read.map_err(|error| found.add("/command", error.to_string())).ok()
}

/// Where a field of the recipe stands in the body; what is said of two fields points to the first.
fn pointer(name: &str) -> String {
    let field = name.split(' ').next().unwrap_or_default();
    format!("/{}", field.replace('.', "/"))
}
