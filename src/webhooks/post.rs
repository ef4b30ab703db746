//! One POST to a receiver: bounded in time and in what is read, never redirected, and told of in plain words.

use std::time::Duration;

use ureq::Agent;
use ureq::tls::{RootCerts, TlsConfig};

/// The most bytes that are read of an answer's body, which nobody looks at: enough for a receiver to finish its answer.
const ANSWER_BYTES_MAX: u64 = 4096;

/// Posts deliveries. A clone shares everything.
#[derive(Debug, Clone)]
pub(super) struct Poster {
    agent: Agent,
    timeout: Duration,
}

/// The headers that a delivery is sent with, beside its type.
#[derive(Debug, Clone)]
pub(super) struct Stamp {
    /// The delivery's id.
    pub id: String,
    /// The time of the attempt, in seconds since 1970.
    pub timestamp_s: i64,
    /// The signature.
    pub signature: String,
}

impl Poster {
    /// Posts that each take at most `timeout`. Certificates are judged as the machine's own store says.
    pub fn new(timeout: Duration) -> Self {
        let agent = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .max_idle_connections(0)
            .proxy(None)
            .timeout_global(Some(timeout))
            .tls_config(TlsConfig::builder().root_certs(RootCerts::PlatformVerifier).build())
            .user_agent(format!("elevon/{}", crate::VERSION))
            .build()
            .into();
        Self { agent, timeout }
    }

    /// Posts a body and returns the answer's status, or why there was none. It blocks.
    pub fn post(&self, url: &str, stamp: &Stamp, body: &str) -> Result<u16, String> {
        let sent = self
            .agent
            .post(url)
            .content_type("application/json")
            .header("webhook-id", &stamp.id)
            .header("webhook-timestamp", stamp.timestamp_s.to_string())
            .header("webhook-signature", &stamp.signature)
            .send(body);
        let mut answer = sent.map_err(|error| self.in_plain_words(&error))?;
        // Only for the receiver's sake: what it says beyond the status is not looked at.
        drop(answer.body_mut().with_config().limit(ANSWER_BYTES_MAX).read_to_vec());
        Ok(answer.status().as_u16())
    }

    /// Why there was no answer. The address is not repeated: it may hold what only its receiver should know.
    fn in_plain_words(&self, error: &ureq::Error) -> String {
        match error {
            ureq::Error::Timeout(_) => format!("no answer within {} s", self.timeout.as_secs_f64()),
            ureq::Error::HostNotFound => "the host's name was not found".into(),
            ureq::Error::Io(error) => format!("the connection failed: {error}"),
            ureq::Error::Rustls(error) => format!("the secure connection failed: {error}"),
            ureq::Error::Tls(error) => format!("the secure connection failed: {error}"),
            ureq::Error::Protocol(_) | ureq::Error::LargeResponseHeader(..) => "the answer is not HTTP".into(),
            _ => "the delivery could not be sent".into(),
        }
    }
}
