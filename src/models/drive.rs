//! Commands: what the jack is told to do, as a function of time.

use std::str::FromStr;

use thiserror::Error;

/// A commanded position over time, zero before t = 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// The thesis's diagnostic command (section 6.3): ramp, back to zero, step.
    Diagnostic,
}

/// Why a command could not be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("command: found {found:?}, expected {expected}")]
pub struct DriveError {
    /// What was given.
    pub found: String,
    /// What would have been right.
    pub expected: &'static str,
}

impl FromStr for Drive {
    type Err = DriveError;

    fn from_str(text: &str) -> Result<Self, DriveError> {
        match text {
            "diagnostic" => Ok(Self::Diagnostic),
            _ => Err(DriveError { found: text.into(), expected: "diagnostic" }),
        }
    }
}
