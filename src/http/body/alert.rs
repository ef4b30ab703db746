//! Lists of alerts, and acknowledging one.

use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use super::check::FieldErrors;
use super::list::PageQuery;
use crate::http::error::ApiResult;
use crate::http::extract::query::{Fields, FromQuery};
use crate::http::limits::NOTE_CHARS_MAX;
use crate::store::alerts::AlertState;
use crate::store::records::Id;

/// Which alerts of an actuator.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct AlertStateQuery {
    /// Only alerts in this state.
    #[param(inline)]
    pub state: Option<AlertState>,
}

/// Which alerts.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct AlertsQuery {
    /// Only alerts in this state.
    #[param(inline)]
    pub state: Option<AlertState>,
    /// Only alerts of this actuator.
    #[param(value_type = Option<String>)]
    pub actuator_id: Option<Id>,
}

fn state(fields: &mut Fields) -> Option<AlertState> {
    let expected = format!("one of {}", AlertState::ALL.map(AlertState::name).join(", "));
    fields.parse_with("state", expected, |text| AlertState::ALL.into_iter().find(|state| state.name() == text))
}

impl FromQuery for (AlertStateQuery, PageQuery) {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        Some((AlertStateQuery { state: state(fields) }, PageQuery::from_query(fields)?))
    }
}

impl FromQuery for (AlertsQuery, PageQuery) {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let actuator_id = fields.parse("actuator_id", "an actuator's id");
        Some((AlertsQuery { state: state(fields), actuator_id }, PageQuery::from_query(fields)?))
    }
}

/// The one state that a client can bring an alert to.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum NewAlertState {
    /// Somebody knows of it.
    Acknowledged,
}

/// An acknowledgement.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"state": "acknowledged", "note": "replacement ordered for the next check"}))]
pub struct AlertPatch {
    /// The state to bring it to. It is cleared by the service alone.
    #[expect(dead_code, reason = "it has only one value")]
    state: NewAlertState,
    /// What else is worth knowing.
    #[serde(default)]
    #[schema(max_length = 2000)]
    note: String,
}

impl AlertPatch {
    /// The note.
    ///
    /// # Errors
    /// A note that is too long or holds control characters.
    pub fn check(self) -> ApiResult<String> {
        let mut errors = FieldErrors::default();
        let note = errors.text("/note", &self.note, (0, NOTE_CHARS_MAX), true);
        errors.pass(note)
    }
}
