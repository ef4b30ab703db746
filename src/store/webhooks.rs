//! Webhooks and their outbox as they are kept.

use std::fmt;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::alerts::{Alert, AlertKind};
use super::records::Id;

/// The most webhooks that a service has; each may hold one thread while something is sent to it.
pub const WEBHOOKS_MAX: u32 = 32;

/// What deliveries are signed with. It is never shown: not in logs, not in answers.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// A secret of this text.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// The text itself: for the signature, for the database, and once for who made the webhook.
    #[must_use]
    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(..)")
    }
}

/// Where alerts are sent to.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Webhook {
    /// Opaque id.
    pub id: Id,
    /// The address that deliveries are posted to.
    #[schema(example = "https://maintenance.example.com/hooks/elevon")]
    pub url: String,
    /// The kinds of alerts that it is told of.
    pub kinds: Vec<AlertKind>,
    /// Whether anything is sent to it.
    pub enabled: bool,
    /// Why the service disabled it; null when it is enabled, or was disabled by a client.
    pub disabled_because: Option<String>,
    /// When it was made.
    pub created_at: Timestamp,
}

/// What is to change of a webhook; `None` leaves a field as it is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WebhookChange {
    /// Its address.
    pub url: Option<String>,
    /// Its secret.
    pub secret: Option<Secret>,
    /// The kinds of alerts that it is told of.
    pub kinds: Option<Vec<AlertKind>>,
    /// Whether anything is sent to it.
    pub enabled: Option<bool>,
}

/// What a delivery tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum Event {
    /// An alert was raised.
    #[serde(rename = "alert.raised")]
    Raised,
    /// An alert was acknowledged.
    #[serde(rename = "alert.acknowledged")]
    Acknowledged,
    /// An alert was cleared.
    #[serde(rename = "alert.cleared")]
    Cleared,
    /// Nothing: somebody tries the webhook.
    #[serde(rename = "ping")]
    Ping,
}

impl Event {
    /// The event's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Raised => "alert.raised",
            Self::Acknowledged => "alert.acknowledged",
            Self::Cleared => "alert.cleared",
            Self::Ping => "ping",
        }
    }
}

/// The body of a delivery.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Notification<'a> {
    /// What happened.
    pub event: Event,
    /// The delivery, the same at every attempt: who has seen it already may ignore it.
    pub delivery_id: Id,
    /// When it happened.
    pub created_at: Timestamp,
    /// The alert as it was then; null for a ping.
    pub alert: Option<&'a Alert>,
}

/// Where a delivery is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DeliveryState {
    /// It is to be sent, for the first time or again.
    Pending,
    /// The receiver took it.
    Delivered,
    /// It was given up.
    Failed,
}

/// What is, was or will be sent to a webhook.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Delivery {
    /// Opaque id; the `webhook-id` of every attempt.
    pub id: Id,
    /// What it tells.
    pub event: Event,
    /// The alert that it tells of; null for a ping.
    pub alert_id: Option<Id>,
    /// Where it is in its life.
    pub state: DeliveryState,
    /// How often it was sent.
    pub attempts: u32,
    /// When it is sent next, at the earliest; null when it is over.
    pub next_attempt_at: Option<Timestamp>,
    /// The HTTP status that the newest attempt was answered with; null when there was no answer.
    pub last_status: Option<u16>,
    /// Why the newest attempt failed.
    pub last_error: Option<String>,
    /// When it was written into the outbox.
    pub created_at: Timestamp,
    /// When the receiver took it.
    pub delivered_at: Option<Timestamp>,
}

/// A delivery that is to be sent now.
#[derive(Debug, Clone, PartialEq)]
pub struct DueDelivery {
    /// The delivery.
    pub id: Id,
    /// Its webhook.
    pub webhook_id: Id,
    /// Where it goes.
    pub url: String,
    /// What it is signed with.
    pub secret: Secret,
    /// What is sent.
    pub body: String,
    /// How often it was sent.
    pub attempts: u32,
    /// When it was written into the outbox.
    pub created_at: Timestamp,
}

/// What follows from an attempt.
#[derive(Debug, Clone, PartialEq)]
pub enum Followed {
    /// The receiver took it.
    Delivered,
    /// It is sent again.
    Retry {
        /// When, at the earliest.
        at: Timestamp,
    },
    /// It is given up.
    GivenUp,
    /// The receiver wants nothing any more: the webhook is disabled if it still has this address.
    Gone {
        /// The address that said so.
        url: String,
    },
}

/// How an attempt to deliver ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// When it ended.
    pub at: Timestamp,
    /// The HTTP status that it was answered with.
    pub status: Option<u16>,
    /// Why it failed.
    pub error: Option<String>,
    /// What follows.
    pub followed: Followed,
}
