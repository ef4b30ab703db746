//! Reporting what was done to an actuator.

use jiff::Timestamp;
use serde::Deserialize;
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::http::error::ApiResult;
use crate::http::extract::time;
use crate::http::limits::{NOTE_CHARS_MAX, USAGE_MAX};
use crate::store::records::{Id, Maintenance, MaintenanceKind};

/// A maintenance event to report. `replaced` and `overhauled` start a new life; older records stay.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "kind": "overhauled", "at": "2026-03-01T12:00:00Z", "usage": 1250.5, "note": "seals and torque motor renewed"
}))]
pub struct NewMaintenance {
    /// What was done.
    kind: MaintenanceKind,
    /// When: RFC 3339 with an offset.
    #[serde(deserialize_with = "time::deserialize")]
    at: Timestamp,
    /// The actuator's usage then, in its usage unit.
    #[schema(minimum = 0, maximum = 10000000)]
    usage: f64,
    /// What else is worth knowing.
    #[serde(default)]
    #[schema(max_length = 2000)]
    note: String,
}

impl NewMaintenance {
    /// The event to keep.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(self, actuator_id: Id, now: Timestamp) -> ApiResult<Maintenance> {
        let mut errors = FieldErrors::default();
        errors.number("/usage", self.usage, 0.0..=USAGE_MAX, "");
        let note = errors.text("/note", &self.note, (0, NOTE_CHARS_MAX), true);
        let Self { kind, at, usage, .. } = self;
        errors.pass(Maintenance { id: Id::now(), actuator_id, kind, at, usage, note, created_at: now })
    }
}
