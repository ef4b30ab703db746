//! Validation of parameters: everything that is wrong with a set is collected before anyone is told.

use std::fmt;

use thiserror::Error;

/// The range of a parameter, and its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The parameter, with its section.
    pub name: &'static str,
    /// The least allowed.
    pub min: f64,
    /// The most allowed.
    pub max: f64,
    /// Its unit; empty when it has none.
    pub unit: &'static str,
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let space = if self.unit.is_empty() { "" } else { " " };
        write!(f, "{} to {}{space}{}", Short(self.min), Short(self.max), self.unit)
    }
}

/// A number as a person writes it: with an exponent when it is very small or large.
#[derive(Debug, Clone, Copy)]
pub struct Short(pub f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value == 0.0 || !value.is_finite() || (1e-3..1e5).contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

/// What is wrong with a parameter set.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ParamsError {
    /// The text is no TOML.
    #[error("line {line}, column {column}: {reason}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The character in it, from 1.
        column: usize,
        /// What was found or expected there.
        reason: String,
    },
    /// A parameter that does not exist.
    #[error("{}: found an unknown parameter, expected {expected}", name_of(section, key))]
    Unknown {
        /// Its section; empty at the top.
        section: String,
        /// Its name there.
        key: String,
        /// What there is in this section.
        expected: String,
    },
    /// A parameter that is not there.
    #[error("{name}: missing, expected {expected}")]
    Missing {
        /// The parameter, with its section.
        name: String,
        /// Its range and unit.
        expected: String,
    },
    /// A value of the wrong type, or a text that means nothing here.
    #[error("{name}: found {found}, expected {expected}")]
    Unreadable {
        /// The parameter, with its section.
        name: String,
        /// What was found.
        found: String,
        /// Its range and unit, or the texts that it knows.
        expected: String,
    },
    /// A value is out of its range, or not finite.
    #[error("{}: found {}, expected {limits}", limits.name, Short(*value))]
    OutOfRange {
        /// Its value.
        value: f64,
        /// The range.
        limits: Limits,
    },
}

fn name_of(section: &str, key: &str) -> String {
    if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
}

impl ParamsError {
    /// The parameter at fault as a JSON pointer (RFC 6901) from the set's root.
    #[must_use]
    pub fn pointer(&self) -> String {
        let path = |name: &str| if name.is_empty() { String::new() } else { format!("/{}", name.replace('.', "/")) };
        match self {
            Self::Syntax { .. } => String::new(),
            Self::Unknown { section, key, .. } => {
                format!("{}/{}", path(section), key.replace('~', "~0").replace('/', "~1"))
            }
            Self::Missing { name, .. } | Self::Unreadable { name, .. } => path(name),
            Self::OutOfRange { limits, .. } => path(limits.name),
        }
    }

    /// What was found and what was expected, without the parameter's name.
    #[must_use]
    pub fn detail(&self) -> String {
        let text = self.to_string();
        let name = match self {
            Self::Syntax { .. } => String::new(),
            Self::Unknown { section, key, .. } => name_of(section, key),
            Self::Missing { name, .. } | Self::Unreadable { name, .. } => name.clone(),
            Self::OutOfRange { limits, .. } => limits.name.to_owned(),
        };
        text.strip_prefix(&name).map_or(text.as_str(), |rest| rest.trim_start_matches(": ")).to_owned()
    }
}

/// Collects every range that is asked for, and every value that is out of its own.
#[derive(Debug, Default)]
pub(crate) struct Checks {
    errors: Vec<ParamsError>,
    limits: Vec<Limits>,
    drawn: Vec<&'static str>,
    /// Whether no range is drawn closer, because some value is not the set's own.
    plain: bool,
}

impl Checks {
    /// Checks of a set of which some values are stand-ins: what they would draw closer keeps its plain range.
    pub(crate) fn plain() -> Self {
        Self { plain: true, ..Self::default() }
    }

    /// Notes a range, and a value that is not finite or not in `min..=max`.
    pub(crate) fn within(&mut self, name: &'static str, value: f64, min: f64, max: f64, unit: &'static str) {
        let limits = Limits { name, min, max, unit };
        self.limits.push(limits);
        if !(min..=max).contains(&value) {
            self.errors.push(ParamsError::OutOfRange { value, limits });
        }
    }

    /// Notes what no range can say.
    pub(crate) fn refuse(&mut self, error: ParamsError) {
        self.errors.push(error);
    }

    /// As [`Checks::within`], where other values draw the range closer. While a value is known to be wrong the range is
    /// the plain one: a wrong value draws nothing.
    pub(crate) fn within_drawn(
        &mut self,
        name: &'static str,
        value: f64,
        plain: (f64, f64),
        drawn: (f64, f64),
        unit: &'static str,
    ) {
        self.drawn.push(name);
        let (min, max) = if self.errors.is_empty() && !self.plain {
            (plain.0.max(readable(drawn.0)), plain.1.min(readable(drawn.1)))
        } else {
            plain
        };
        self.within(name, value, min, max, unit);
    }

    /// The parameters whose range others draw closer, by [`Checks::within_drawn`].
    pub(crate) fn drawn(&self) -> &[&'static str] {
        &self.drawn
    }

    /// The errors and the ranges, in the order of the checks.
    pub(crate) fn into_parts(self) -> (Vec<ParamsError>, Vec<Limits>) {
        (self.errors, self.limits)
    }
}

/// A computed bound to three digits, as it is told.
fn readable(bound: f64) -> f64 {
    format!("{bound:.2e}").parse().unwrap_or(bound)
}
