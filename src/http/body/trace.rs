//! Changing what is known of a trace.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::http::error::ApiResult;
use crate::http::limits::NOTE_CHARS_MAX;

/// Whether a trace is excluded from its actuator's history.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"excluded": true, "reason": "the pressure sensor was unplugged"}))]
pub struct TraceChange {
    /// Whether it is.
    excluded: bool,
    /// Why; not kept with a trace that is taken back.
    #[serde(default)]
    #[schema(max_length = 2000)]
    reason: String,
}

impl TraceChange {
    /// Whether the trace is to be excluded, and why.
    ///
    /// # Errors
    /// A reason that is too long or holds control characters.
    pub fn check(self) -> ApiResult<(bool, String)> {
        let mut errors = FieldErrors::default();
        let reason = errors.text("/reason", &self.reason, (0, NOTE_CHARS_MAX), true);
        errors.pass((self.excluded, if self.excluded { reason } else { String::new() }))
    }
}
