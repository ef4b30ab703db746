//! A receiver of webhooks on a socket of its own, which checks signatures by its own arithmetic.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

/// What came in.
#[derive(Debug, Clone)]
pub struct Received {
    pub path: String,
    pub headers: HeaderMap,
    pub body: String,
}

#[derive(Clone)]
struct Shared {
    received: Arc<Mutex<Vec<Received>>>,
    answers: Arc<Mutex<VecDeque<u16>>>,
    /// One permit for each request that came in.
    came: Arc<Semaphore>,
    /// One permit for each request that may be answered.
    go: Arc<Semaphore>,
}

/// The receiver; it answers 200 when no other answers are left.
pub struct Receiver {
    pub url: String,
    shared: Shared,
}

impl Receiver {
    /// A receiver that gives these answers first.
    pub async fn answering(answers: &[u16]) -> Self {
        let receiver = Self::slow(answers).await;
        receiver.let_go();
        receiver
    }

    /// A receiver that answers nothing before [`Receiver::let_go`].
    pub async fn slow(answers: &[u16]) -> Self {
        let shared = Shared {
            received: Arc::default(),
            answers: Arc::new(Mutex::new(answers.iter().copied().collect())),
            came: Arc::new(Semaphore::new(0)),
            go: Arc::new(Semaphore::new(0)),
        };
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/hook", listener.local_addr().unwrap());
        let router = Router::new().fallback(receive).with_state(shared.clone());
        tokio::spawn(async move { axum::serve(listener, router).await.unwrap() });
        Self { url, shared }
    }

    /// Answers whatever waits and comes.
    pub fn let_go(&self) {
        self.shared.go.add_permits(1000);
    }

    /// Returns once one more request has come in.
    pub async fn called(&self) {
        self.shared.came.acquire().await.unwrap().forget();
    }

    /// Everything that came in, in order.
    pub fn received(&self) -> Vec<Received> {
        self.shared.received.lock().unwrap().clone()
    }
}

async fn receive(State(shared): State<Shared>, uri: Uri, headers: HeaderMap, body: Bytes) -> Response {
    let body = String::from_utf8(body.to_vec()).unwrap();
    shared.received.lock().unwrap().push(Received { path: uri.path().to_owned(), headers, body });
    shared.came.add_permits(1);
    shared.go.acquire().await.unwrap().forget();
    let status = shared.answers.lock().unwrap().pop_front().unwrap_or(200);
    (StatusCode::from_u16(status).unwrap(), [("location", "/elsewhere")], "x".repeat(100_000)).into_response()
}

impl Received {
    pub fn header(&self, name: &str) -> &str {
        self.headers[name].to_str().unwrap()
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap()
    }

    /// Whether the signature is that of this key.
    pub fn is_signed_with(&self, key: &[u8]) -> bool {
        let signed = format!("{}.{}.{}", self.header("webhook-id"), self.header("webhook-timestamp"), self.body);
        let expected = format!("v1,{}", base64(&hmac_sha256(key, signed.as_bytes())));
        self.header("webhook-signature") == expected
    }
}

/// HMAC after RFC 2104, for keys of at most a block.
fn hmac_sha256(key: &[u8], message: &[u8]) -> Vec<u8> {
    let padded = |pad: u8| -> Vec<u8> { (0..64).map(|i| key.get(i).copied().unwrap_or(0) ^ pad).collect() };
    assert!(key.len() <= 64);
    let inner = Sha256::digest([&padded(0x36), message].concat());
    Sha256::digest([&padded(0x5c)[..], &inner[..]].concat()).to_vec()
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base64 after RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    let group = |chunk: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        let digit =
            |i: usize| if i <= chunk.len() { DIGITS[(bits >> (18 - 6 * i)) as usize & 63] as char } else { '=' };
        [0, 1, 2, 3].map(digit)
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// The bytes that base64 stands for.
pub fn from_base64(text: &str) -> Vec<u8> {
    let digits: Vec<u32> = text
        .trim_end_matches('=')
        .bytes()
        .map(|byte| DIGITS.iter().position(|digit| *digit == byte).unwrap() as u32)
        .collect();
    let group = |chunk: &[u32]| -> Vec<u8> {
        let bits = (0..4).fold(0, |bits, i| bits << 6 | chunk.get(i).copied().unwrap_or(0));
        bits.to_be_bytes()[1..chunk.len()].to_vec()
    };
    digits.chunks(4).flat_map(group).collect()
}

#[test]
fn validate_the_receivers_arithmetic_by_rfc_4231_and_rfc_4648() {
    // RFC 4231, test case 2.
    let hex: String =
        hmac_sha256(b"Jefe", b"what do ya want for nothing?").iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(hex, "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    for (bytes, text) in [("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
        assert_eq!((base64(bytes.as_bytes()), from_base64(text)), (text.to_owned(), bytes.as_bytes().to_vec()));
    }
}
