//! Making, changing and trying webhooks.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use serde::{Deserialize, Deserializer, Serialize, de};
use serde_json::Value;
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::http::error::{ApiError, ApiResult};
use crate::store::alerts::AlertKind;
use crate::store::records::Id;
use crate::store::webhooks::{Delivery, Secret, Webhook, WebhookChange};
use crate::webhooks::{address, signature};

/// A webhook to make.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"url": "https://maintenance.example.com/hooks/elevon", "kinds": ["threshold", "risk"]}))]
pub struct NewWebhook {
    /// Where deliveries are posted to: http or https, without credentials and fragment. Addresses of private networks are
    /// allowed.
    #[schema(max_length = 2048)]
    url: String,
    /// What deliveries are signed with, visible ASCII; after `whsec_`, the key in base64. Made by the service unless given, and
    /// shown only then, only here.
    #[schema(min_length = 16, max_length = 256)]
    #[serde(default, deserialize_with = "secret")]
    secret: Option<String>,
    /// The kinds of alerts that it is told of; all unless told.
    kinds: Option<Vec<AlertKind>>,
    /// Whether anything is sent to it; `true` unless told.
    enabled: Option<bool>,
}

/// What is to change of a webhook; what is left out stays as it is.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"enabled": false}))]
pub struct WebhookPatch {
    /// Where deliveries are posted to.
    #[schema(max_length = 2048)]
    url: Option<String>,
    /// What deliveries are signed with, from the next attempt on.
    #[schema(min_length = 16, max_length = 256)]
    #[serde(default, deserialize_with = "secret")]
    secret: Option<String>,
    /// The kinds of alerts that it is told of.
    kinds: Option<Vec<AlertKind>>,
    /// Whether anything is sent to it. What waits for a webhook that is disabled is sent once it is enabled again.
    enabled: Option<bool>,
}

/// A webhook that was made.
#[derive(Debug, Serialize, ToSchema)]
pub struct NewWebhookAnswer {
    /// The webhook.
    #[serde(flatten)]
    pub webhook: Webhook,
    /// The secret, if the service made it: it is not shown again. Null when the client gave its own.
    pub secret: Option<String>,
}

impl NewWebhook {
    /// The webhook to keep, its secret, and that secret again if it is to be shown.
    ///
    /// # Errors
    /// Every field out of its range; a system without randomness.
    pub fn check(self, now: Timestamp) -> ApiResult<(Webhook, Secret, Option<String>)> {
        let mut errors = FieldErrors::default();
        let url = noted(&mut errors, "/url", address::parse(&self.url));
        let given = self.secret.as_deref().map(signature::parse);
        let given = given.and_then(|secret| noted(&mut errors, "/secret", secret));
        let kinds = kinds(&mut errors, self.kinds.unwrap_or(AlertKind::ALL.to_vec()));
        let webhook = Webhook {
            id: Id::now(),
            url: url.unwrap_or_default(),
            kinds,
            enabled: self.enabled.unwrap_or(true),
            disabled_because: None,
            created_at: now,
        };
        let webhook = errors.pass(webhook)?;
        if let Some(secret) = given {
            return Ok((webhook, secret, None));
        }
        let made = signature::generate().map_err(ApiError::internal)?;
        let shown = made.reveal().to_owned();
        Ok((webhook, made, Some(shown)))
    }
}

impl WebhookPatch {
    /// What to change.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(self) -> ApiResult<WebhookChange> {
        let mut errors = FieldErrors::default();
        let url = self.url.as_deref().map(address::parse);
        let secret = self.secret.as_deref().map(signature::parse);
        let change = WebhookChange {
            url: url.and_then(|url| noted(&mut errors, "/url", url)),
            secret: secret.and_then(|secret| noted(&mut errors, "/secret", secret)),
            kinds: self.kinds.map(|found| kinds(&mut errors, found)),
            enabled: self.enabled,
        };
        errors.pass(change)
    }
}

/// A secret or null. What is of another type is refused without repeating it.
fn secret<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::Null => Ok(None),
        Value::String(text) => Ok(Some(text)),
        _ => Err(de::Error::custom("found no string, expected one")),
    }
}

fn noted<T>(errors: &mut FieldErrors, pointer: &str, found: Result<T, String>) -> Option<T> {
    found.map_err(|detail| errors.add(pointer, detail)).ok()
}

/// The kinds once each, at least one.
fn kinds(errors: &mut FieldErrors, mut kinds: Vec<AlertKind>) -> Vec<AlertKind> {
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.is_empty() {
        errors.add("/kinds", "found none, expected at least one of threshold, risk");
    }
    kinds
}

/// A delivery that was queued.
#[derive(Debug, Serialize, ToSchema)]
pub struct DeliveryAccepted {
    /// The delivery.
    pub delivery: Delivery,
}

impl IntoResponse for DeliveryAccepted {
    fn into_response(self) -> Response {
        (StatusCode::ACCEPTED, Json(self)).into_response()
    }
}
