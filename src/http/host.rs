//! Whom a request is meant for: the service has no keys, so no web page of another host may reach it under that host's
//! name (DNS rebinding).

use std::net::IpAddr;

use axum::extract::Request;
use axum::http::header::HOST;
use axum::http::uri::Authority;
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};

use super::error::ApiError;

/// Refuses a request that names another host than this machine; one that names none is answered.
pub async fn refuse_foreign(request: Request, next: Next) -> Response {
    let in_path = request.uri().authority().map(|authority| authority.as_str().as_bytes());
    let in_headers = request.headers().get_all(HOST).iter().map(|value| value.as_bytes());
    match in_path.into_iter().chain(in_headers).find(|host| !is_own(host)) {
        Some(host) => ApiError::ForeignHost { found: String::from_utf8_lossy(host).into_owned() }.into_response(),
        None => next.run(request).await,
    }
}

/// Whether a host, with or without a port, is a name of this machine's loopback.
fn is_own(host: &[u8]) -> bool {
    let Ok(authority) = Authority::try_from(host) else { return false };
    let name = authority.host().trim_start_matches('[').trim_end_matches(']');
    name.eq_ignore_ascii_case("localhost") || name.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loopback_has_these_names_and_no_others() {
        for own in ["localhost", "LocalHost:8080", "127.0.0.1", "127.8.9.1:80", "[::1]", "[::1]:8080"] {
            assert!(is_own(own.as_bytes()), "{own}");
        }
        for foreign in
            ["", "example.com", "localhost.example.com:8080", "192.0.2.1", "0.0.0.0", "[::]:80", "a b", "\u{e9}"]
        {
            assert!(!is_own(foreign.as_bytes()), "{foreign}");
        }
    }
}
