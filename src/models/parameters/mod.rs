//! Parameter sets: the numbers that make the models one actuator type's models.

mod reading;
mod tree;

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

pub use self::tree::Tree;
use super::blocks::{Shared, controller, jack, torque_motor};
use super::checks::{Limits, ParamsError, Short};
use super::{monitoring, reference};
use crate::numeric::digest::sha256_hex;
use reading::BUILT_IN;

/// The built-in set's text.
const REFERENCE: &str = include_str!("../../../config/actuators/reference.toml");
/// The most characters of a set's name.
pub const NAME_CHARS_MAX: usize = 64;
/// The longest text of a set that is read, bytes (chosen: a hundred times the built-in one).
pub const TEXT_BYTES_MAX: usize = 1_000_000;
/// The column at which a written set's remarks begin.
const REMARK_COLUMN: usize = 52;

/// The values of a set as they are written down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Values {
    name: String,
    controller: controller::Params,
    torque_motor: torque_motor::Params,
    jack: jack::Params,
    reference: reference::Params,
    monitoring: monitoring::Params,
}

/// The parameters of both models of one actuator type, validated, with their hash.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSet {
    values: Values,
    hash: String,
}

/// A parameter's value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number, in the parameter's unit.
    Number(f64),
    /// One of the texts that the parameter knows.
    Text(String),
}

/// One parameter of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, with its section.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Its range in this set, and its unit.
    pub limits: Option<Limits>,
}

impl Parameter {
    /// The models whose parameter it is: `reference`, `monitoring` or `both`.
    #[must_use]
    pub fn models(&self) -> &'static str {
        match self.name.split('.').next() {
            Some("reference") => "reference",
            Some("monitoring") => "monitoring",
            _ => "both",
        }
    }
}

impl ParameterSet {
    /// The built-in reference actuator (`config/actuators/reference.toml`).
    ///
    /// # Panics
    /// Never in a build whose tests pass: the built-in text is valid.
    #[must_use]
    pub fn reference() -> Self {
        Self::of(BUILT_IN.values.clone())
    }

    /// The name of the built-in set.
    #[must_use]
    pub fn reference_name() -> &'static str {
        &BUILT_IN.values.name
    }

    /// Whether a set may have this name: 1 to 64 of the characters A-Z, a-z, 0-9, `.`, `_` and `-`.
    #[must_use]
    pub fn is_name(text: &str) -> bool {
        (1..=NAME_CHARS_MAX).contains(&text.len())
            && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte))
    }

    /// Reads and validates a set from TOML.
    ///
    /// # Errors
    /// The first error of syntax, or else every parameter that is unknown, missing, of the wrong type or out of its
    /// range; never empty.
    pub fn parse(text: &str) -> Result<Self, Vec<ParamsError>> {
        Self::from_tree(reading::document(text).map_err(|error| vec![error])?)
    }

    /// Validates a set whose name is beside its parameters.
    ///
    /// # Errors
    /// As [`ParameterSet::parse`], without errors of syntax.
    pub fn from_parts(name: &str, parameters: Tree) -> Result<Self, Vec<ParamsError>> {
        let mut parameters = parameters;
        let entries = match &mut parameters {
            Tree::Table(entries) => entries,
            other => {
                let (found, expected) = (other.describe(), "a table of parameters".into());
                return Err(vec![ParamsError::Unreadable { name: String::new(), found, expected }]);
            }
        };
        if entries.iter().any(|(key, _)| key == "name") {
            let expected = "the set's sections; its name stands beside them".into();
            return Err(vec![ParamsError::Unknown { section: String::new(), key: "name".into(), expected }]);
        }
        entries.insert(0, ("name".into(), Tree::Text(name.into())));
        Self::from_tree(parameters)
    }

    /// Reads a set back from its name and [`ParameterSet::to_json`].
    ///
    /// # Errors
    /// As [`ParameterSet::from_parts`]: a set of another version may lack parameters of this one.
    pub fn from_json(name: &str, parameters: &serde_json::Value) -> Result<Self, Vec<ParamsError>> {
        Self::from_parts(name, reading::json(parameters))
    }

    /// The same set with other values of some parameters, each by its name with its section.
    ///
    /// # Errors
    /// As [`ParameterSet::from_parts`].
    pub fn with(&self, changes: &[(String, String)]) -> Result<Self, Vec<ParamsError>> {
        let mut tree = Tree::of(&self.values);
        let mut errors = Vec::new();
        for (name, text) in changes {
            match tree.at_mut(name).filter(|_| name != "name") {
                Some(place @ (Tree::Integer(_) | Tree::Float(_))) => {
                    *place = text.trim().parse().map_or_else(|_| Tree::Text(text.clone()), Tree::Float);
                }
                Some(place @ Tree::Text(_)) => *place = Tree::Text(text.clone()),
                _ => errors.push(reading::unknown(name)),
            }
        }
        match Self::from_tree(tree) {
            Ok(set) if errors.is_empty() => Ok(set),
            Ok(_) => Err(errors),
            Err(others) => Err(errors.into_iter().chain(others).collect()),
        }
    }

    fn from_tree(tree: Tree) -> Result<Self, Vec<ParamsError>> {
        let bad_name = match tree.at("name") {
            Some(name @ Tree::Text(text)) if !Self::is_name(text) => {
                let expected = format!("1 to {NAME_CHARS_MAX} of the characters A-Z, a-z, 0-9, ., _ and -");
                Some(ParamsError::Unreadable { name: "name".into(), found: name.describe(), expected })
            }
            _ => None,
        };
        match (reading::values(tree), bad_name) {
            (Ok(values), None) => Ok(Self::of(values)),
            (values, bad_name) => Err(bad_name.into_iter().chain(values.err().into_iter().flatten()).collect()),
        }
    }

    fn of(values: Values) -> Self {
        let canonical = serde_json::to_vec(&values).expect("plain numbers and names serialise");
        let hash = sha256_hex(&canonical);
        Self { values, hash }
    }

    /// The set's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.values.name
    }

    /// SHA-256 of the set's values, in hexadecimal: it tells two sets of one name apart.
    #[must_use]
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// What both models have.
    #[must_use]
    pub fn shared(&self) -> Shared {
        let Values { controller, torque_motor, jack, .. } = self.values;
        Shared { controller, torque_motor, jack }
    }

    /// What the reference model has of its own.
    #[must_use]
    pub fn reference_model(&self) -> &reference::Params {
        &self.values.reference
    }

    /// What the monitoring model has of its own.
    #[must_use]
    pub fn monitoring_model(&self) -> &monitoring::Params {
        &self.values.monitoring
    }

    /// Every parameter, in the order of the set.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let (_, limits) = self.values.check();
        let mut parameters = Vec::new();
        Tree::of(&self.values).leaves("", &mut |name, leaf| {
            let value = match leaf {
                Tree::Integer(value) => Value::Number(*value as f64),
                Tree::Float(value) => Value::Number(*value),
                Tree::Text(text) if name != "name" => Value::Text(text.clone()),
                _ => return,
            };
            let limits = limits.iter().find(|limits| limits.name == name).copied();
            parameters.push(Parameter { name, value, limits });
        });
        parameters
    }

    /// The sections as JSON, without the set's name.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let mut document = serde_json::to_value(&self.values).expect("plain numbers and names serialise");
        if let Some(sections) = document.as_object_mut() {
            sections.remove("name");
        }
        document
    }

    /// The set as a file that [`ParameterSet::parse`] reads: the built-in one as it was written, with where its values
    /// come from, another one with its ranges.
    #[must_use]
    pub fn to_toml(&self) -> String {
        if self.values == BUILT_IN.values {
            return REFERENCE.into();
        }
        let mut text = format!("name = {:?}\n", self.values.name);
        let mut section = String::new();
        for Parameter { name, value, limits } in self.parameters() {
            let (inside, key) = name.rsplit_once('.').unwrap_or_default();
            if inside != section {
                section = inside.to_owned();
                let _ = write!(text, "\n[{section}]\n");
            }
            let line = match value {
                Value::Number(value) => format!("{key} = {value:?}"),
                Value::Text(value) => format!("{key} = {value:?}"),
            };
            let _ = match limits {
                Some(limits) => writeln!(text, "{line:<REMARK_COLUMN$}# {limits}"),
                None => writeln!(text, "{line}"),
            };
        }
        text + &self.bias_surface_toml().map_or_else(String::new, |surface| format!("\n{surface}"))
    }

    /// The section of the bias's surface as it is written in a file; `None` where the set has none.
    #[must_use]
    pub fn bias_surface_toml(&self) -> Option<String> {
        let surface = self.values.monitoring.bias.surface.as_ref()?;
        let mut text = String::from("[monitoring.bias.surface]\n");
        Tree::of(surface).leaves("", &mut |key, leaf| {
            let _ = writeln!(text, "{key} = {}", leaf.array_text());
        });
        Some(text)
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => Short(*value).fmt(f),
            Self::Text(text) => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests;
