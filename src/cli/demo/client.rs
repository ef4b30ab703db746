//! The demo's HTTP client: what a maintenance tool would do, with errors in the service's own words.

use std::time::Duration;

use anyhow::{Context, bail};
use serde_json::Value;
use ureq::http::Response;
use ureq::{Agent, Body};

/// Talks to one service.
#[derive(Debug, Clone)]
pub struct Client {
    agent: Agent,
    address: String,
}

impl Client {
    /// A client of the service at `http://host:port`.
    pub fn new(address: &str) -> Self {
        let agent = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(Duration::from_secs(60)))
            .build()
            .into();
        Self { agent, address: address.to_owned() }
    }

    /// Where the service is.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// The answer to a GET.
    pub fn get(&self, path: &str) -> anyhow::Result<Value> {
        let answer = self.agent.get(format!("{}{path}", self.address)).call();
        read(answer).with_context(|| format!("GET {path}"))
    }

    /// The answer to a POST of JSON.
    pub fn post(&self, path: &str, body: &Value) -> anyhow::Result<Value> {
        let answer = self.agent.post(format!("{}{path}", self.address)).send_json(body);
        read(answer).with_context(|| format!("POST {path}"))
    }

    /// The answer to a POST of a CSV file.
    pub fn post_csv(&self, path: &str, body: &[u8]) -> anyhow::Result<Value> {
        let answer = self.agent.post(format!("{}{path}", self.address)).content_type("text/csv").send(body);
        read(answer).with_context(|| format!("POST {path}"))
    }

    /// Every item of a list, page by page.
    pub fn list(&self, path: &str) -> anyhow::Result<Vec<Value>> {
        let separator = if path.contains('?') { '&' } else { '?' };
        let mut items = Vec::new();
        let mut cursor = String::new();
        loop {
            let mut page = self.get(&format!("{path}{separator}limit=500{cursor}"))?;
            match page["items"].take() {
                Value::Array(found) => items.extend(found),
                other => bail!("GET {path}: found {other}, expected a list of items"),
            }
            match page["next_cursor"].as_str() {
                Some(next) => cursor = format!("&cursor={next}"),
                None => return Ok(items),
            }
        }
    }
}

/// The answer's JSON, or an error with the problem's title and details.
fn read(answer: Result<Response<Body>, ureq::Error>) -> anyhow::Result<Value> {
    let mut answer = answer?;
    let body: Value = answer.body_mut().read_json()?;
    if answer.status().is_success() {
        return Ok(body);
    }
    bail!("{}: {} {}", answer.status(), body["detail"], body["errors"]);
}

/// A text of a record.
pub fn text<'a>(record: &'a Value, field: &str) -> anyhow::Result<&'a str> {
    record[field].as_str().with_context(|| format!("{field}: found {}, expected a text", record[field]))
}
