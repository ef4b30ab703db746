//! A request's body: read once, within its limits of bytes, time and memory.

use std::future::poll_fn;
use std::pin::Pin;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{FromRef, FromRequest, Request};
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE, EXPECT};
use axum::http::{HeaderMap, HeaderName};
use tokio::sync::OwnedSemaphorePermit;

use crate::http::error::{ApiError, ApiResult};
use crate::http::limits::Limits;

/// How many times the limit is read and thrown away, so that a client that writes before it reads sees the refusal.
const DISCARD_FACTOR: usize = 4;

/// A body with what its headers say of it.
#[derive(Debug)]
pub struct RawBody {
    bytes: Vec<u8>,
    headers: HeaderMap,
    /// Held as long as the bytes are.
    permit: OwnedSemaphorePermit,
}

impl<S> FromRequest<S> for RawBody
where
    Limits: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> ApiResult<Self> {
        let limits = Limits::from_ref(state);
        let (parts, body) = request.into_parts();
        if body.size_hint().lower() > limits.body_bytes as u64 {
            // Who waits for `100 Continue` sends nothing; who does not may read the refusal only after all was written.
            if !parts.headers.contains_key(EXPECT) {
                tokio::spawn(tokio::time::timeout(limits.body_time, discard(body, limits.body_bytes)));
            }
            return Err(ApiError::TooLarge { limit_bytes: limits.body_bytes });
        }
        let permit = limits.bodies.acquire_owned().await.map_err(ApiError::internal)?;
        let bytes = tokio::time::timeout(limits.body_time, read(body, limits.body_bytes))
            .await
            .map_err(|_| ApiError::SlowBody { limit_s: limits.body_time.as_secs_f64() })??;
        Ok(Self { bytes, headers: parts.headers, permit })
    }
}

impl RawBody {
    /// What the body's media type stands for.
    ///
    /// # Errors
    /// An empty body, an encoded one, a media type that is absent or not among `accepted`.
    pub fn kind<T: Copy>(&self, accepted: &[(&str, T)]) -> ApiResult<T> {
        let expected = || accepted.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" or ");
        if self.bytes.is_empty() {
            return Err(ApiError::EmptyBody { expected: expected() });
        }
        if let Some(found) = self.header(CONTENT_ENCODING).filter(|value| !value.eq_ignore_ascii_case("identity")) {
            return Err(ApiError::UnsupportedEncoding { found });
        }
        let found = self.header(CONTENT_TYPE);
        let essence = found.as_deref().and_then(|value| value.split(';').next()).unwrap_or_default().trim();
        match accepted.iter().find(|(name, _)| name.eq_ignore_ascii_case(essence)) {
            Some((_, kind)) => Ok(*kind),
            None => Err(ApiError::UnsupportedMediaType { found, expected: expected() }),
        }
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes, and the permit to hold them: who takes the bytes holds it as long.
    pub fn into_bytes(self) -> (Vec<u8>, OwnedSemaphorePermit) {
        (self.bytes, self.permit)
    }

    /// A header as text; what is not text is shown with replacement characters.
    fn header(&self, name: HeaderName) -> Option<String> {
        self.headers.get(name).map(|value| String::from_utf8_lossy(value.as_bytes()).into_owned())
    }
}

/// Reads a body of at most `limit` bytes.
async fn read(mut body: Body, limit: usize) -> ApiResult<Vec<u8>> {
    let mut bytes = Vec::new();
    while let Some(data) = next(&mut body).await {
        let data = data.map_err(|_| ApiError::BrokenBody)?;
        if bytes.len() + data.len() > limit {
            drop(bytes);
            discard(body, limit).await;
            return Err(ApiError::TooLarge { limit_bytes: limit });
        }
        bytes.extend_from_slice(&data);
    }
    Ok(bytes)
}

/// Reads a body that is refused and keeps nothing of it.
async fn discard(mut body: Body, limit: usize) {
    let mut left = limit.saturating_mul(DISCARD_FACTOR);
    while let Some(Ok(data)) = next(&mut body).await {
        left = left.saturating_sub(data.len());
        if left == 0 {
            return;
        }
    }
}

/// The next piece of a body, empty when it is not of its data.
async fn next(body: &mut Body) -> Option<Result<Bytes, axum::Error>> {
    let frame = poll_fn(|context| Pin::new(&mut *body).poll_frame(context)).await?;
    Some(frame.map(|frame| frame.into_data().unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use axum::http::HeaderValue;
    use tokio::sync::Semaphore;

    use super::*;

    fn body_with(name: HeaderName, value: &'static str) -> RawBody {
        let permit = Arc::new(Semaphore::new(1)).try_acquire_owned().unwrap();
        let mut headers = HeaderMap::from_iter([(CONTENT_TYPE, HeaderValue::from_static("text/csv"))]);
        headers.insert(name, HeaderValue::from_static(value));
        RawBody { bytes: vec![b'x'], headers, permit }
    }

    #[tokio::test]
    async fn a_body_of_the_limit_is_read_and_one_byte_more_is_not() {
        assert_eq!(read(Body::from("12345678"), 8).await.unwrap(), b"12345678");
        assert!(matches!(read(Body::from("123456789"), 8).await, Err(ApiError::TooLarge { limit_bytes: 8 })));
        assert!(matches!(read(Body::from(vec![0; 99]), 8).await, Err(ApiError::TooLarge { limit_bytes: 8 })));
    }

    #[test]
    fn parameters_and_case_of_a_media_type_do_not_matter() {
        let accepted = [("text/csv", 1), ("application/json", 2)];
        for (value, kind) in [("text/csv; charset=utf-8", 1), ("Text/CSV", 1), ("application/json ;q=1", 2)] {
            assert_eq!(body_with(CONTENT_TYPE, value).kind(&accepted).unwrap(), kind);
        }
        let error = body_with(CONTENT_TYPE, "text/plain").kind(&accepted).unwrap_err().to_string();
        assert_eq!(error, "Content-Type: found text/plain, expected text/csv or application/json");
    }

    #[test]
    fn identity_is_the_only_encoding() {
        let accepted = [("text/csv", ())];
        assert!(body_with(CONTENT_ENCODING, "Identity").kind(&accepted).is_ok());
        let error = body_with(CONTENT_ENCODING, "gzip").kind(&accepted).unwrap_err();
        assert!(matches!(error, ApiError::UnsupportedEncoding { .. }));
    }
}
