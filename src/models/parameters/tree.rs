//! A parameter set before it is known to be one: whatever tables, arrays, numbers and texts a TOML or JSON document holds.

use std::fmt;

use serde::de::{Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// The longest text that is shown of what was found.
const SHOWN_CHARS_MAX: usize = 40;

/// A document's values in its own order. Truth values and nulls are read, so that they can be named as wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum Tree {
    /// A table.
    Table(Vec<(String, Tree)>),
    /// An integer.
    Integer(i64),
    /// A number.
    Float(f64),
    /// A text.
    Text(String),
    /// An array.
    Array(Vec<Tree>),
    /// What no parameter is, in words.
    Other(&'static str),
}

impl Tree {
    /// The tree of a value.
    pub(super) fn of(value: &impl Serialize) -> Self {
        let value = toml::Value::try_from(value).expect("parameters are numbers and texts in tables and arrays");
        Self::deserialize(value).expect("every value has a tree")
    }

    /// What it is, in words.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Table(_) => "a table".into(),
            Self::Integer(value) => value.to_string(),
            Self::Float(value) => value.to_string(),
            Self::Text(text) => format!("{:?}", text.chars().take(SHOWN_CHARS_MAX).collect::<String>()),
            Self::Array(_) => "an array".into(),
            Self::Other(words) => (*words).into(),
        }
    }

    /// What is at a path of names.
    pub(super) fn at(&self, path: &str) -> Option<&Self> {
        path.split('.').try_fold(self, |tree, key| match tree {
            Self::Table(entries) => entries.iter().find(|(name, _)| name == key).map(|(_, value)| value),
            _ => None,
        })
    }

    /// What is at a path of names, to change it.
    pub(super) fn at_mut(&mut self, path: &str) -> Option<&mut Self> {
        path.split('.').try_fold(self, |tree, key| match tree {
            Self::Table(entries) => entries.iter_mut().find(|(name, _)| name == key).map(|(_, value)| value),
            _ => None,
        })
    }

    /// Calls `visit` with the path of everything that is no table, in order.
    pub(super) fn leaves<'t>(&'t self, path: &str, visit: &mut impl FnMut(String, &'t Self)) {
        match self {
            Self::Table(entries) => entries.iter().for_each(|(key, value)| value.leaves(&join(path, key), visit)),
            leaf => visit(path.to_owned(), leaf),
        }
    }

    /// An array of numbers as TOML has it: on one line, or a line for each row.
    pub(super) fn array_text(&self) -> String {
        match self {
            Self::Array(items) if matches!(items.first(), Some(Self::Array(_))) => {
                let rows: String = items.iter().map(|row| format!("    {},\n", row.array_text())).collect();
                format!("[\n{rows}]")
            }
            Self::Array(items) => format!("[{}]", items.iter().map(Self::array_text).collect::<Vec<_>>().join(", ")),
            Self::Float(value) => format!("{value:?}"),
            other => other.describe(),
        }
    }

    /// The document as TOML has it; what is no parameter is left out.
    pub(super) fn to_toml(&self) -> Option<toml::Value> {
        Some(match self {
            Self::Table(entries) => toml::Value::Table(
                entries.iter().filter_map(|(key, value)| Some((key.clone(), value.to_toml()?))).collect(),
            ),
            Self::Integer(value) => toml::Value::Integer(*value),
            Self::Float(value) => toml::Value::Float(*value),
            Self::Text(text) => toml::Value::String(text.clone()),
            Self::Array(items) => toml::Value::Array(items.iter().filter_map(Self::to_toml).collect()),
            Self::Other(_) => return None,
        })
    }
}

/// A name within a section.
pub(super) fn join(section: &str, key: &str) -> String {
    if section.is_empty() { key.to_owned() } else { format!("{section}.{key}") }
}

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyValue)
    }
}

struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Tree;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Tree, A::Error> {
        let mut entries: Vec<(String, Tree)> = Vec::new();
        while let Some((key, value)) = map.next_entry::<String, Tree>()? {
            if entries.iter().any(|(name, _)| *name == key) {
                return Err(A::Error::custom(format!("found {key:?} twice, expected each name once")));
            }
            entries.push((key, value));
        }
        Ok(Tree::Table(entries))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Tree, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = seq.next_element()? {
            items.push(item);
        }
        Ok(Tree::Array(items))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Tree, E> {
        Ok(Tree::Other(if value { "true" } else { "false" }))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Tree, E> {
        Ok(Tree::Integer(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Tree, E> {
        Ok(i64::try_from(value).map_or(Tree::Float(value as f64), Tree::Integer))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Tree, E> {
        Ok(Tree::Float(value))
    }

    fn visit_str<E>(self, text: &str) -> Result<Tree, E> {
        Ok(Tree::Text(text.to_owned()))
    }

    fn visit_unit<E>(self) -> Result<Tree, E> {
        Ok(Tree::Other("null"))
    }
}
