//! Histories as JSON.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::{Asked, At, Direction, Histories, History, Places, UsageUnit};
use crate::formats::FormatError;
use crate::formats::errors::{FormatErrors, only};
use crate::formats::json::{Numbers, pointer, stopped};

/// A whole file, or one history of a batch.
#[derive(Deserialize)]
struct Object {
    id: Option<Value>,
    threshold: Option<f64>,
    direction: Option<Direction>,
    healthy: Option<f64>,
    life_start: Option<f64>,
    unit: Option<UsageUnit>,
    usage: Option<Numbers>,
    t: Option<Numbers>,
    value: Option<Numbers>,
    h: Option<Numbers>,
    std: Option<Vec<Option<f64>>>,
    at: Option<Usages>,
    cuts: Option<Usages>,
    eol: Option<f64>,
    histories: Option<Vec<Object>>,
}

/// One usage or many.
struct Usages(At);

/// Reads one history or a batch.
pub(super) fn read(text: &str) -> Result<Histories, Vec<FormatError>> {
    let mut json = serde_json::Deserializer::from_str(text);
    let mut object: Object = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let pointer = pointer(error.path());
        not_finite(text, &pointer, error.inner()).unwrap_or_else(|| stopped(&pointer, error.inner()))
    })?;
    json.end().map_err(|error| stopped("", &error))?;

    let asked = object.asked();
    let mut faults = FormatErrors::default();
    let Some(objects) = object.histories.take() else {
        // What is asked of the only history is asked of the file.
        let history = object.history(String::new(), &mut faults);
        return faults.into_result().map(|()| Histories { asked, histories: vec![history], batch: false });
    };
    if object.usage.is_some() || object.t.is_some() {
        let detail = "found a history beside them, expected histories or usage and value";
        faults.add(|| "/histories".into(), || detail.into());
    }
    let mut histories = Vec::with_capacity(objects.len());
    for (i, object) in objects.into_iter().enumerate() {
        let mut history = object.history(format!("/histories/{i}"), &mut faults);
        history.id.get_or_insert_with(|| i.into());
        histories.push(history);
    }
    faults.into_result().map(|()| Histories { asked, histories, batch: true })
}

/// The fault of a file that holds what JSON has no number for, as some programs write it.
fn not_finite(text: &str, pointer: &str, error: &serde_json::Error) -> Option<Vec<FormatError>> {
    let line = text.lines().nth(error.line().checked_sub(1)?)?;
    let from = error.column().saturating_sub(2);
    let rest = line.get(from..)?;
    let found = ["NaN", "-Infinity", "Infinity", "nan", "-inf", "inf"];
    let found = found.into_iter().find(|name| (0..2).any(|i| rest.get(i..).is_some_and(|r| r.starts_with(name))))?;
    let place = format!("line {}, column {}", error.line(), error.column());
    let place = if pointer.is_empty() { place } else { format!("{pointer} ({place})") };
    error.is_syntax().then(|| only(place, format!("found {found}, expected a finite number")))
}

impl Object {
    fn asked(&self) -> Asked {
        let Self { threshold, direction, healthy, life_start, unit, .. } = *self;
        Asked { threshold, direction, healthy, life_start, unit }
    }

    fn history(self, place: String, faults: &mut FormatErrors) -> History {
        let asked = self.asked();
        if self.histories.is_some() {
            let detail = "found histories in a history, expected usage and value";
            faults.add(|| format!("{place}/histories"), || detail.into());
        }
        if let Some(id) = self.id.as_ref().filter(|id| !(id.is_string() || id.is_number())) {
            faults.add(|| format!("{place}/id"), || format!("found {id}, expected a text or a number"));
        }
        let (usage_name, usage) = numbers(&place, [("usage", self.usage), ("t", self.t)], faults);
        let (value_name, value) = numbers(&place, [("value", self.value), ("h", self.h)], faults);
        let std = self.std.unwrap_or_else(|| vec![None; usage.len()]);
        for (name, length) in [(value_name, value.len()), ("std", std.len())] {
            if length != usage.len() {
                let expected = format!("{}, as many as in {usage_name}", usage.len());
                faults.add(|| format!("{place}/{name}"), || format!("found {length} numbers, expected {expected}"));
            }
        }
        if self.at.is_some() && self.cuts.is_some() {
            faults.add(|| format!("{place}/cuts"), || "found both at and cuts, expected one of them".into());
        }
        let at = self.at.or(self.cuts).map(|usages| usages.0);
        let names = [usage_name, value_name, "std"];
        let places = Places::Pointer { history: place, names };
        History { id: self.id, asked, usage, value, std, at, end_of_life: self.eol, places }
    }
}

/// The numbers of an array that has two names, and the name that it goes by.
fn numbers(
    place: &str,
    named: [(&'static str, Option<Numbers>); 2],
    faults: &mut FormatErrors,
) -> (&'static str, Vec<f64>) {
    let [(first, one), (second, other)] = named;
    if one.is_some() && other.is_some() {
        let detail = format!("found both {first} and {second}, expected one of them");
        faults.add(|| format!("{place}/{second}"), || detail);
    }
    let name = if one.is_none() && other.is_some() { second } else { first };
    match one.or(other) {
        Some(Numbers { values, faults: found }) => {
            faults.add_part(&format!("{place}/{name}"), found);
            (name, values)
        }
        None => {
            faults.add(|| format!("{place}/{name}"), || "found nothing, expected an array of numbers".into());
            (name, Vec::new())
        }
    }
}

struct UsagesVisitor;

impl<'de> Visitor<'de> for UsagesVisitor {
    type Value = Usages;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, an array of numbers or an object of numbers")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Usages, E> {
        Ok(Usages(At::One(value)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Usages, E> {
        Ok(Usages(At::One(value as f64)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Usages, E> {
        Ok(Usages(At::One(value as f64)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Usages, A::Error> {
        let mut usages = Vec::new();
        while let Some(usage) = elements.next_element()? {
            usages.push(usage);
        }
        Ok(Usages(At::Many(usages)))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Usages, A::Error> {
        let mut usages = Vec::new();
        while let Some((_, usage)) = map.next_entry::<String, f64>()? {
            usages.push(usage);
        }
        Ok(Usages(At::Many(usages)))
    }
}

impl<'de> Deserialize<'de> for Usages {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(UsagesVisitor)
    }
}
