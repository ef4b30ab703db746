//! Validation of parameters: every value out of its range is collected before anyone is told.

use thiserror::Error;

/// What is wrong with a parameter set.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ParamsError {
    /// A value is out of its range, or not finite.
    #[error("{name}: found {value}, expected {min} to {max} {unit}")]
    OutOfRange {
        /// The parameter, with its section.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The least allowed.
        min: f64,
        /// The most allowed.
        max: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The text is not a parameter set.
    #[error("{0}")]
    Syntax(#[from] toml::de::Error),
}

/// Collects every value that is out of its range.
#[derive(Debug, Default)]
pub(crate) struct Checks(Vec<ParamsError>);

impl Checks {
    /// Notes a value that is not finite or not in `min..=max`.
    pub(crate) fn within(&mut self, name: &'static str, value: f64, min: f64, max: f64, unit: &'static str) {
        if !(min..=max).contains(&value) {
            self.0.push(ParamsError::OutOfRange { name, value, min, max, unit });
        }
    }

    /// What was noted, in order.
    pub(crate) fn into_errors(self) -> Vec<ParamsError> {
        self.0
    }
}
