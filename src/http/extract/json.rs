//! JSON bodies, strictly: unknown fields and wrong types are named by a JSON pointer.

use axum::extract::{FromRef, FromRequest, Request};
use serde::de::DeserializeOwned;
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
        let body = RawBody::from_request(request, state).await?;
        body.kind(&[("application/json", ())])?;
        parse(body.bytes()).map(Self)
    }
}

/// Reads one JSON value and nothing after it.
fn parse<T: DeserializeOwned>(bytes: &[u8]) -> ApiResult<T> {
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| ApiError::malformed(pointer(error.path()), error.inner().to_string()))?;
    deserializer.end().map_err(|error| ApiError::malformed("", error.to_string()))?;
    Ok(value)
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
    use serde::Deserialize;

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
        list: Vec<f64>,
    }

    fn refused_at(text: &str) -> String {
        match parse::<Outer>(text.as_bytes()) {
            Err(ApiError::Malformed(errors)) => errors[0].pointer.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_fault_is_named_by_its_json_pointer() {
        assert_eq!(refused_at(r#"{"inner": {"list": [1, "2"]}}"#), "/inner/list/1");
        assert_eq!(refused_at(r#"{"inner": {"list": [], "a/b~": 1}}"#), "/inner/a~1b~0");
        assert_eq!(refused_at(r#"{"inner": {}}"#), "/inner");
        assert_eq!(refused_at(r#"{"inner": {"list": []}} x"#), "");
        assert_eq!(refused_at("7"), "");
    }
}
