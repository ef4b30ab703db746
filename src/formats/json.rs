//! JSON with an array of numbers for each column.

use std::collections::HashMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use serde_path_to_error::{Path, Segment};

use super::columns::{Columns, Make, Places, Purpose, check_number};
use super::errors::{FormatErrors, clip, only};
use super::{FormatError, ReadOptions};
use crate::models::trace::Trace;

/// Places as JSON pointers (RFC 6901).
struct Pointers;

impl Places for Pointers {
    fn names(&self) -> String {
        "/columns".into()
    }

    fn column(&self, name: &str) -> String {
        format!("/columns{}", token(name))
    }

    fn value(&self, name: &str, row: usize) -> String {
        format!("/columns{}/{row}", token(name))
    }
}

/// A step of a JSON pointer.
fn token(name: &str) -> String {
    format!("/{}", name.replace('~', "~0").replace('/', "~1"))
}

/// The pointer to the place where the reading ended; empty at the top level.
pub(super) fn pointer(path: &Path) -> String {
    path.iter()
        .map(|segment| match segment {
            Segment::Seq { index } => format!("/{index}"),
            Segment::Map { key } => token(key),
            Segment::Enum { .. } | Segment::Unknown => String::new(),
        })
        .collect()
}

/// Reads JSON, and makes something of it.
pub(super) fn read<T>(
    text: &str,
    options: &ReadOptions,
    purpose: Purpose,
    make: Make<T>,
) -> Result<T, Vec<FormatError>> {
    let mut json = serde_json::Deserializer::from_str(text);
    let document: Document =
        serde_path_to_error::deserialize(&mut json).map_err(|error| stopped(&pointer(error.path()), error.inner()))?;
    json.end().map_err(|error| stopped("", &error))?;

    let Document { columns, mut faults } = document;
    let Some(NamedNumbers(columns)) = columns else {
        faults.add(|| Pointers.names(), || "found nothing, expected an object of arrays".into());
        return Err(faults.into_errors());
    };
    let (mut names, mut data) = (Vec::new(), Vec::new());
    for (name, numbers) in columns {
        faults.add_part(&Pointers.column(&name), numbers.faults);
        names.push(name);
        data.push(numbers.values);
    }
    check_number(&names, &Pointers)?;
    let columns = Columns::resolve(names, options, purpose, &Pointers, &mut faults);
    faults.into_result()?;
    columns.into(data, make, &Pointers)
}

/// The fault that ended the reading: its message has the line and the column.
pub(super) fn stopped(pointer: &str, error: &serde_json::Error) -> Vec<FormatError> {
    let place = match pointer {
        "" => format!("line {}, column {}", error.line(), error.column()),
        _ => pointer.into(),
    };
    // What a parser of JSON calls out of range is a number that would be infinite.
    let detail = match error.to_string() {
        message if message.starts_with("number out of range") => format!("{message}, expected a finite number"),
        message if error.is_data() => message,
        message => format!("found malformed JSON: {message}"),
    };
    only(place, detail)
}

/// A whole file, with what is wrong in it but did not end the reading.
#[derive(Default)]
struct Document {
    columns: Option<NamedNumbers>,
    faults: FormatErrors,
}

/// The columns in the order of the file, doubled names and all.
struct NamedNumbers(Vec<(String, Numbers)>);

/// An array of numbers. The places of its faults are pointers from the array on.
#[derive(Default)]
pub(super) struct Numbers {
    pub(super) values: Vec<f64>,
    pub(super) faults: FormatErrors,
}

/// An element of such an array: a number, or what was found instead of one.
struct Element(Result<f64, String>);

struct DocumentVisitor;

impl<'de> Visitor<'de> for DocumentVisitor {
    type Value = Document;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object with columns and metadata")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Document, A::Error> {
        let mut document = Document::default();
        let mut metadata = None;
        while let Some(key) = map.next_key::<String>()? {
            let detail = match key.as_str() {
                "columns" if document.columns.is_none() => {
                    document.columns = Some(map.next_value()?);
                    continue;
                }
                "metadata" if metadata.is_none() => {
                    metadata = Some(map.next_value::<HashMap<String, IgnoredAny>>()?);
                    continue;
                }
                "columns" | "metadata" => "found it twice, expected it once",
                _ => "found a field that is not known here, expected columns or metadata",
            };
            map.next_value::<IgnoredAny>()?;
            document.faults.add(|| token(&key), || detail.into());
        }
        Ok(document)
    }
}

struct NamedNumbersVisitor;

impl<'de> Visitor<'de> for NamedNumbersVisitor {
    type Value = NamedNumbers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object with an array of numbers for each column")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<NamedNumbers, A::Error> {
        let mut columns = Vec::new();
        while let Some(column) = map.next_entry()? {
            columns.push(column);
        }
        Ok(NamedNumbers(columns))
    }
}

struct NumbersVisitor;

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = Numbers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an array of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Numbers, A::Error> {
        let mut numbers = Numbers::default();
        let mut row = 0;
        while let Some(Element(element)) = elements.next_element()? {
            match element {
                Ok(value) => numbers.values.push(value),
                Err(found) => {
                    numbers.faults.add(|| format!("/{row}"), || format!("found {found}, expected a number"));
                }
            }
            row += 1;
        }
        Ok(numbers)
    }
}

struct ElementVisitor;

impl<'de> Visitor<'de> for ElementVisitor {
    type Value = Element;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Element, E> {
        Ok(Element(Ok(value)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Element, E> {
        Ok(Element(Ok(value as f64)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Element, E> {
        Ok(Element(Ok(value as f64)))
    }

    fn visit_str<E>(self, text: &str) -> Result<Element, E> {
        Ok(Element(Err(format!("the text \"{}\"", clip(text)))))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Element, E> {
        Ok(Element(Err(value.to_string())))
    }

    fn visit_unit<E>(self) -> Result<Element, E> {
        Ok(Element(Err("null".into())))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Element, A::Error> {
        while elements.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Element(Err("an array".into())))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Element, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Element(Err("an object".into())))
    }
}

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(DocumentVisitor)
    }
}

impl<'de> Deserialize<'de> for NamedNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(NamedNumbersVisitor)
    }
}

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(NumbersVisitor)
    }
}

impl<'de> Deserialize<'de> for Element {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ElementVisitor)
    }
}

/// A trace as a file holds it.
#[derive(Serialize)]
struct Written<'a> {
    #[serde(serialize_with = "serialize_columns")]
    columns: &'a Trace,
    metadata: &'a Map<String, Value>,
}

fn serialize_columns<S: Serializer>(trace: &&Trace, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(trace.columns())
}

/// Writes a trace as JSON.
pub(super) fn write(trace: &Trace, metadata: &Map<String, Value>) -> Vec<u8> {
    let written = Written { columns: trace, metadata };
    serde_json::to_vec(&written).expect("finite numbers under names are JSON, and memory takes every write")
}

#[cfg(test)]
mod tests {
    use super::super::tests::errors;
    use super::*;

    /// A file with 12 samples whose time, and whose end after the columns, are as given.
    fn file(time_s: &str, end: &str) -> String {
        let ones = ["1"; 12].join(",");
        let others = format!("\"position_command_mm\": [{ones}], \"load_pressure_pa\": [{ones}]");
        format!("{{\"columns\": {{\"time_s\": {time_s}, {others}}}{end}}}")
    }

    fn times() -> String {
        format!("{:?}", (0..12).collect::<Vec<_>>())
    }

    fn read(text: &str) -> Result<Trace, Vec<FormatError>> {
        super::super::read(super::super::Format::Json, text.as_bytes(), &ReadOptions::default())
    }

    fn faults(text: &str) -> Vec<String> {
        errors(read(text))
    }

    #[test]
    fn columns_are_read_and_metadata_are_accepted() {
        for end in ["", ", \"metadata\": {\"tail\": \"I-ABCD\", \"deep\": [{}, null]}"] {
            let trace = read(&file(&times(), end)).unwrap();
            assert_eq!((trace.samples(), trace.position_command_m()[3]), (12, 0.001));
        }
    }

    #[test]
    fn every_element_that_is_no_number_has_its_pointer() {
        let time_s = r#"[0, "1.5m", null, true, [4, [5]], {"a": {}}, 6, 7, 8, 9, 10, -11]"#;
        let expected = ["the text \"1.5m\"", "null", "true", "an array", "an object"];
        let expected: Vec<_> = (1..)
            .zip(expected)
            .map(|(i, found)| format!("/columns/time_s/{i}: found {found}, expected a number"))
            .collect();
        assert_eq!(faults(&file(time_s, "")), expected);
    }

    #[test]
    fn a_number_that_would_be_infinite_is_refused_at_its_place() {
        for number in ["1e999", "-1e999"] {
            let found = faults(&file(&times().replace(" 3,", &format!(" {number},")), ""));
            assert!(
                found[0].starts_with("/columns/time_s/3: ") && found[0].ends_with("expected a finite number"),
                "{found:?}"
            );
        }
    }

    #[test]
    fn other_shapes_are_refused_at_their_place() {
        for (text, expected) in [
            (
                "[1]".to_owned(),
                "line 1, column 0: invalid type: sequence, expected an object with columns and metadata",
            ),
            ("{}".into(), "/columns: found nothing, expected an object of arrays"),
            (r#"{"columns": []}"#.into(), "/columns: invalid type: sequence, expected an object with an array"),
            (file("3", ""), "/columns/time_s: invalid type: integer `3`, expected an array of numbers"),
            (file("null", ""), "/columns/time_s: invalid type: null, expected an array of numbers"),
            (file(&times(), ", \"a/b~c\": 1"), "/a~1b~0c: found a field that is not known here"),
            (file(&times(), ", \"columns\": {}"), "/columns: found it twice"),
            (file(&times(), ", \"metadata\": 1"), "/metadata: invalid type: integer `1`"),
            (file(&times(), "").replace("load_pressure_pa", "time_s"), "/columns/time_s: found a second column"),
            (file("[0, 1, 2]", ""), "/columns/position_command_mm: found 12 values, expected 3 as time_s has"),
            (file("[0, 1, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11]", ""), "/columns/time_s/2: found 1.0 s after 1.0 s"),
        ] {
            let found = faults(&text);
            assert!(found[0].starts_with(expected), "{found:?} instead of {expected}");
        }
    }

    #[test]
    fn malformed_text_is_refused_at_its_line_and_column() {
        for (text, place) in [
            ("{\"columns\"\n 1}", "line 2, column 2: "),
            ("{} x", "line 1, column 4: "),
            ("csv,csv", "line 1, column 1: "),
        ] {
            let found = faults(text);
            assert!(found[0].starts_with(place) && found[0].contains("malformed JSON"), "{found:?}");
        }
        let found = faults("{\"columns\": {\"time_s\": [1,\n2,, 3]}}");
        assert!(found[0].starts_with("/columns/time_s/2: ") && found[0].contains("line 2 column 3"), "{found:?}");
    }

    #[test]
    fn deep_nesting_is_refused_like_any_other_wrong_type() {
        let deep = "[".repeat(100_000) + &"]".repeat(100_000);
        let found = faults(&file(&times().replace(" 3,", &format!(" {deep},")), &format!(", \"x\": {deep}")));
        assert_eq!(found[0], "/x: found a field that is not known here, expected columns or metadata");
        assert_eq!(found[1], "/columns/time_s/3: found an array, expected a number");
    }

    #[test]
    fn files_have_both_parts_of_the_form() {
        let trace = read(&file(&times(), "")).unwrap();
        let metadata = Map::from_iter([("seed".to_owned(), Value::from(7))]);
        let text = String::from_utf8(write(&trace, &metadata)).unwrap();
        assert!(text.starts_with("{\"columns\":{\"time_s\":[0.0,1.0,"), "{text}");
        assert!(text.ends_with("},\"metadata\":{\"seed\":7}}"), "{text}");
    }
}
