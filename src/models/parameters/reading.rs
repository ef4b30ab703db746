//! From a document to a parameter set: the built-in set says which parameters there are and of what type, the models'
//! checks say their ranges. What is wrong is put right by the built-in set's value, so that the rest is checked too.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use serde::Deserialize as _;
use serde::de::DeserializeOwned;

use super::tree::{Tree, join};
use super::{REFERENCE, Values};
use crate::models::checks::{Checks, Limits, ParamsError};

/// The section that a set may lack.
const OPTIONAL: &str = "monitoring.bias.surface";

/// What the built-in set tells of every set.
pub(super) struct BuiltIn {
    pub(super) values: Values,
    /// Every parameter of a set and its type.
    pub(super) tree: Tree,
    /// The ranges in the built-in set.
    limits: Vec<Limits>,
    /// The parameters that have no range but the one that others draw.
    drawn_by_others: BTreeSet<&'static str>,
}

pub(super) static BUILT_IN: LazyLock<BuiltIn> = LazyLock::new(|| {
    let values: Values = toml::from_str(REFERENCE).expect("the built-in parameter set has every parameter");
    let (errors, limits) = values.check();
    assert!(errors.is_empty(), "the built-in parameter set is valid: {errors:?}");
    let tree = Tree::of(&values);
    let drawn_by_others = drawn_by_others(&tree, &limits);
    BuiltIn { values, tree, limits, drawn_by_others }
});

/// The parameters whose range moves when all the values do and that have no plain range.
fn drawn_by_others(tree: &Tree, limits: &[Limits]) -> BTreeSet<&'static str> {
    let mut moved = tree.clone();
    move_numbers(&mut moved);
    let moved: Values = typed(&moved).expect("other numbers are of the same types");
    let checks = moved.checks(Checks::default());
    let has_plain: BTreeSet<&'static str> = checks.drawn().iter().copied().collect();
    let (_, others) = checks.into_parts();
    let moved = limits.iter().filter(|limits| !others.contains(*limits)).map(|limits| limits.name);
    moved.filter(|name| !has_plain.contains(name)).collect()
}

fn move_numbers(tree: &mut Tree) {
    match tree {
        Tree::Table(entries) => entries.iter_mut().for_each(|(_, value)| move_numbers(value)),
        Tree::Float(value) => *value = *value * 0.9 - 1e-9,
        _ => {}
    }
}

impl BuiltIn {
    /// What a parameter may be, in words.
    fn expected(&self, name: &str) -> String {
        match (self.limits.iter().find(|limits| limits.name == name), self.tree.at(name)) {
            (Some(limits), Some(Tree::Array(items))) => match items.first() {
                Some(Tree::Array(_)) => format!("rows of numbers, each {limits}"),
                _ => format!("an array of numbers, each {limits}"),
            },
            (Some(limits), _) => limits.to_string(),
            (None, Some(Tree::Text(_))) => "a text".into(),
            (None, Some(Tree::Table(_))) => "a table of parameters".into(),
            _ => "a finite number".into(),
        }
    }

    /// The place of a parameter in the order of a set.
    fn place(&self, name: &str) -> usize {
        let (mut place, mut next) = (usize::MAX, 0);
        self.tree.leaves("", &mut |leaf, _| {
            if place == usize::MAX && (leaf == name || leaf.starts_with(&format!("{name}."))) {
                place = next;
            }
            next += 1;
        });
        place
    }
}

/// The syntax of a TOML document.
pub(super) fn document(text: &str) -> Result<Tree, ParamsError> {
    toml::from_str(text).map_err(|error| {
        let start = error.span().map_or(0, |span| span.start).min(text.len());
        let before = text.get(..start).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        ParamsError::Syntax {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            reason: error.message().split_whitespace().collect::<Vec<_>>().join(" "),
        }
    })
}

/// The values of a document, or all that is wrong with it, in the order of the built-in set.
pub(super) fn values(mut tree: Tree) -> Result<Values, Vec<ParamsError>> {
    let built_in = &*BUILT_IN;
    let mut reader = Reader { built_in, errors: Vec::new(), repaired: BTreeSet::new() };
    reader.shape(&mut tree, &built_in.tree, "");
    let values: Option<Values> = reader.types(&mut tree);
    let Reader { mut errors, repaired, .. } = reader;
    if let Some(values) = &values {
        let whole = repaired.is_empty();
        let checks = values.checks(if whole { Checks::default() } else { Checks::plain() });
        errors.extend(checks.into_parts().0.into_iter().filter(|error| match error {
            // Where a value that draws the range may be a repaired one, nothing can be said.
            ParamsError::OutOfRange { limits, .. } => {
                !repaired.contains(limits.name) && (whole || !built_in.drawn_by_others.contains(limits.name))
            }
            // A size that does not go with a repaired axis.
            ParamsError::Unreadable { .. } => whole,
            _ => true,
        }));
    }
    match values {
        Some(values) if errors.is_empty() => Ok(values),
        _ => {
            let place = |error: &ParamsError| match error {
                ParamsError::Unknown { section, .. } => built_in.place(section),
                ParamsError::Missing { name, .. } | ParamsError::Unreadable { name, .. } => built_in.place(name),
                ParamsError::OutOfRange { limits, .. } => built_in.place(limits.name),
                ParamsError::Syntax { .. } => 0,
            };
            errors.sort_by_cached_key(place);
            Err(errors)
        }
    }
}

/// A name that is no parameter's, with what there is in the section that it names.
pub(super) fn unknown(name: &str) -> ParamsError {
    let (section, key) = name.rsplit_once('.').unwrap_or(("", name));
    let tree = &BUILT_IN.tree;
    if let Some(Tree::Table(_)) = tree.at(name) {
        let expected = format!("one of its parameters, as {name}.NAME");
        return ParamsError::Unreadable { name: name.into(), found: "a section".into(), expected };
    }
    let inside = if section.is_empty() { Some(tree) } else { tree.at(section) };
    let names: Vec<&str> = match inside {
        Some(Tree::Table(entries)) => {
            entries.iter().map(|(key, _)| key.as_str()).filter(|key| *key != "name").collect()
        }
        _ => Vec::new(),
    };
    let expected = if names.is_empty() { "SECTION.NAME of a parameter set".into() } else { names.join(", ") };
    ParamsError::Unknown { section: section.into(), key: key.into(), expected }
}

/// Reads a document and puts right what is wrong with it, noting it.
struct Reader<'b> {
    built_in: &'b BuiltIn,
    errors: Vec<ParamsError>,
    repaired: BTreeSet<String>,
}

impl Reader<'_> {
    /// Names that are unknown or missing, and values that are of another type than the model's.
    fn shape(&mut self, found: &mut Tree, model: &Tree, name: &str) {
        match (&mut *found, model) {
            (Tree::Table(entries), Tree::Table(known)) => {
                entries.retain(|(key, _)| known.iter().any(|(name, _)| name == key) || self.unknown(name, key, known));
                for (key, model) in known {
                    let inner = join(name, key);
                    match entries.iter_mut().find(|(found, _)| found == key) {
                        Some((_, value)) => self.shape(value, model, &inner),
                        None if inner == OPTIONAL => {}
                        None => {
                            model.leaves(&inner, &mut |leaf, _| {
                                // One of its keys is missing only where the section is there.
                                if !leaf.starts_with(OPTIONAL) || name == OPTIONAL {
                                    self.missing(leaf);
                                }
                            });
                            entries.push((key.clone(), model.clone()));
                        }
                    }
                }
            }
            (Tree::Text(_), Tree::Text(_)) | (Tree::Integer(_), Tree::Integer(_) | Tree::Float(_)) => {}
            (Tree::Float(value), Tree::Integer(_) | Tree::Float(_)) => {
                let ranged = self.built_in.limits.iter().any(|limits| limits.name == name);
                if !value.is_finite() && !ranged {
                    self.repair(found, model, name);
                }
            }
            (Tree::Array(items), Tree::Array(model)) if items_alike(items, model) => {}
            _ => self.repair(found, model, name),
        }
    }

    /// Notes an unknown name, which is not kept.
    fn unknown(&mut self, section: &str, key: &str, known: &[(String, Tree)]) -> bool {
        let expected = known.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        self.errors.push(ParamsError::Unknown { section: section.into(), key: key.into(), expected });
        false
    }

    fn missing(&mut self, name: String) {
        let expected = self.built_in.expected(&name);
        self.errors.push(ParamsError::Missing { name: name.clone(), expected });
        self.repaired.insert(name);
    }

    /// Notes a value of the wrong type and puts the model's in its place.
    fn repair(&mut self, found: &mut Tree, model: &Tree, name: &str) {
        let expected = self.built_in.expected(name);
        self.errors.push(ParamsError::Unreadable { name: name.into(), found: found.describe(), expected });
        *found = model.clone();
        model.leaves(name, &mut |leaf, _| {
            self.repaired.insert(leaf);
        });
    }

    /// The document in its types. A text that its type does not know is noted and put right, one after the other.
    fn types<T: DeserializeOwned>(&mut self, tree: &mut Tree) -> Option<T> {
        loop {
            let (path, reason) = match typed(tree) {
                Ok(values) => return Some(values),
                Err(error) => error,
            };
            let name = path.trim_end_matches(".?").to_owned();
            let found = tree.at(&name).map_or_else(String::new, Tree::describe);
            let expected = reason.split_once("expected ").map_or(reason.clone(), |(_, words)| words.replace('`', ""));
            self.errors.push(ParamsError::Unreadable { name: name.clone(), found, expected });
            let (Some(place), Some(model)) = (tree.at_mut(&name), self.built_in.tree.at(&name)) else { return None };
            if !self.repaired.insert(name) {
                return None;
            }
            *place = model.clone();
        }
    }
}

/// Whether an array has numbers where the model's has, and such arrays where the model's has.
fn items_alike(found: &[Tree], model: &[Tree]) -> bool {
    found.iter().all(|item| match (item, model.first()) {
        (Tree::Array(inner), Some(Tree::Array(model))) => items_alike(inner, model),
        (Tree::Integer(_) | Tree::Float(_), Some(Tree::Float(_))) => true,
        _ => false,
    })
}

/// A tree in its types, or the path of what does not fit and why.
fn typed<T: DeserializeOwned>(tree: &Tree) -> Result<T, (String, String)> {
    let value = tree.to_toml().unwrap_or(toml::Value::Table(toml::Table::new()));
    serde_path_to_error::deserialize(value).map_err(|error| {
        let reason = error.inner().message().split_whitespace().collect::<Vec<_>>().join(" ");
        (error.path().to_string(), reason)
    })
}

impl Values {
    /// Every value out of its range, and every range, in the order of a set.
    pub(super) fn check(&self) -> (Vec<ParamsError>, Vec<Limits>) {
        self.checks(Checks::default()).into_parts()
    }

    fn checks(&self, mut checks: Checks) -> Checks {
        self.controller.check(&mut checks);
        self.torque_motor.check(&mut checks);
        self.jack.check(&mut checks);
        self.reference.check(&self.torque_motor, &self.jack, &mut checks);
        self.monitoring.check(&mut checks);
        checks
    }
}

/// Reads what was kept of a set.
pub(super) fn json(value: &serde_json::Value) -> Tree {
    Tree::deserialize(value).unwrap_or(Tree::Other("no document"))
}
