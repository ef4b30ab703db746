//! JSON bodies, strictly: unknown fields and wrong types are named by a JSON pointer.

use std::collections::BTreeMap;
use std::fmt;

use axum::extract::{FromRef, FromRequest, Request};
use serde::de::{DeserializeOwned, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_path_to_error::{Path, Segment};

use super::body::RawBody;
use crate::http::error::{ApiError, ApiResult};
use crate::http::limits::Limits;

/// A body of JSON, read into `T`.
#[derive(Debug)]
pub struct JsonBody<T>(pub T);

impl<T, S> FromRequest<S> for JsonBody<T>
where
    T: DeserializeOwned,
    Limits: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> ApiResult<Self> {
        parse(json(request, state).await?.bytes()).map(Self)
    }
}

/// A body whose type is JSON.
async fn json<S>(request: Request, state: &S) -> ApiResult<RawBody>
where
    Limits: FromRef<S>,
    S: Send + Sync,
{
    let body = RawBody::from_request(request, state).await?;
    body.kind(&[("application/json", ())])?;
    Ok(body)
}

/// Reads one JSON value and nothing after it. No body that is read so holds an array; an object may not be given as one.
fn parse<T: DeserializeOwned>(bytes: &[u8]) -> ApiResult<T> {
    read::<NoArrays>(bytes)?;
    read(bytes)
}

/// A body of JSON in which arrays may stand, read into `T`, an object.
#[derive(Debug)]
pub struct ObjectBody<T>(pub T);

impl<T, S> FromRequest<S> for ObjectBody<T>
where
    T: DeserializeOwned,
    Limits: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> ApiResult<Self> {
        let body = json(request, state).await?;
        read::<BTreeMap<String, IgnoredAny>>(body.bytes())?;
        read(body.bytes()).map(Self)
    }
}

/// Reads one JSON value and nothing after it; what it may be is for `T` to say.
///
/// # Errors
/// [`ApiError::Malformed`] with the pointer of the first fault.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> ApiResult<T> {
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| ApiError::malformed(pointer(error.path()), in_plain_words(&error.inner().to_string())))?;
    deserializer.end().map_err(|error| ApiError::malformed("", error.to_string()))?;
    Ok(value)
}

/// An error of the reader, with what was expected in JSON's words instead of the reader's.
fn in_plain_words(error: &str) -> String {
    let Some((found, rest)) = error.rsplit_once(", expected ") else { return error.to_owned() };
    let (expected, place) = rest.split_at(rest.find(" at line ").unwrap_or(rest.len()));
    let expected = match expected {
        "f64" => "a number",
        "u64" => "an integer, at least 0",
        "a map" => "an object",
        of_a_type if of_a_type.starts_with("struct ") => "an object",
        other => other,
    };
    format!("{found}, expected {expected}{place}")
}

/// Any JSON without an array in it, read and not kept.
struct NoArrays;

impl<'de> Deserialize<'de> for NoArrays {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Self)
    }
}

impl<'de> Visitor<'de> for NoArrays {
    type Value = Self;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object or a single value")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, _: A) -> Result<Self, A::Error> {
        Err(A::Error::custom("found an array, expected an object or a single value"))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self, A::Error> {
        while map.next_entry::<String, Self>()?.is_some() {}
        Ok(self)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_unit<E>(self) -> Result<Self, E> {
        Ok(self)
    }
}

/// A path as a JSON pointer (RFC 6901).
fn pointer(path: &Path) -> String {
    let segments = path.iter().filter_map(|segment| match segment {
        Segment::Seq { index } => Some(index.to_string()),
        Segment::Map { key } | Segment::Enum { variant: key } => Some(key.replace('~', "~0").replace('/', "~1")),
        Segment::Unknown => None,
    });
    segments.map(|segment| format!("/{segment}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        #[expect(dead_code, reason = "only read")]
        inner: Inner,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        #[expect(dead_code, reason = "only read")]
        number: f64,
    }

    fn refused(text: &str) -> (String, String) {
        match parse::<Outer>(text.as_bytes()) {
            Err(ApiError::Malformed(mut errors)) => {
                let error = errors.remove(0);
                (error.pointer, error.detail)
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_fault_is_named_by_its_json_pointer() {
        assert!(parse::<Outer>(br#"{"inner": {"number": 1}}"#).is_ok());
        for (text, pointer) in [
            (r#"{"inner": {"number": "2"}}"#, "/inner/number"),
            (r#"{"inner": {"number": 1, "a/b~": 1}}"#, "/inner/a~1b~0"),
            (r#"{"inner": {}}"#, "/inner"),
            (r#"{"inner": {"number": 1}} x"#, ""),
            ("7", ""),
        ] {
            assert_eq!(refused(text).0, pointer, "{text}");
        }
    }

    #[test]
    fn an_array_is_refused_wherever_it_stands() {
        for (text, pointer) in
            [("[[1]]", ""), (r#"{"inner": [1]}"#, "/inner"), (r#"{"inner": {"number": 1, "x": []}}"#, "/inner/x")]
        {
            let (found, detail) = refused(text);
            assert_eq!(found, pointer, "{text}");
            assert!(detail.starts_with("found an array, expected an object"), "{detail}");
        }
    }

    #[test]
    fn what_was_expected_is_told_in_words_of_json() {
        for (text, expected) in [
            ("7", "invalid type: integer `7`, expected an object at line 1"),
            (r#"{"inner": 7}"#, "invalid type: integer `7`, expected an object at line 1"),
            (r#"{"inner": {"number": "2"}}"#, "invalid type: string \"2\", expected a number at line 1"),
        ] {
            let detail = refused(text).1;
            assert!(detail.starts_with(expected), "{detail}");
        }
    }
}
