//! Registering an actuator.

use jiff::Timestamp;
use serde::Deserialize;
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::http::error::ApiResult;
use crate::http::limits::NAME_CHARS_MAX;
use crate::models::parameters::ParameterSet;
use crate::store::records::{Actuator, Id, Thresholds, UsageUnit};

/// An actuator to register. White space around a text does not count.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "serial_number": "EHA-0042", "tail_number": "I-ELVN", "location": "left outboard aileron",
    "parameter_set": "reference", "thresholds": {"kgm": 0.4, "fdj_n": 1000.0}, "usage_unit": "flight_hours"
}))]
pub struct NewActuator {
    /// The part's serial number, unique in the service.
    #[schema(min_length = 1, max_length = 200)]
    serial_number: String,
    /// The aircraft.
    #[schema(min_length = 1, max_length = 200)]
    tail_number: String,
    /// Where on the aircraft, in free text.
    #[schema(min_length = 1, max_length = 200)]
    location: String,
    /// The name of its parameter set; `reference` unless told.
    #[schema(example = "reference")]
    parameter_set: Option<String>,
    /// Its failure thresholds.
    thresholds: Option<NewThresholds>,
    /// What its usage counts; `flight_hours` unless told.
    usage_unit: Option<UsageUnit>,
}

/// Failure thresholds, each with a default.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct NewThresholds {
    /// Torque-motor demagnetisation; 0.4 unless told.
    #[schema(minimum = 0.01, maximum = 1)]
    kgm: Option<f64>,
    /// Dynamic jack friction, N; 1000 unless told.
    #[schema(minimum = 210, maximum = 2000)]
    fdj_n: Option<f64>,
}

impl NewActuator {
    /// The actuator to keep.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(self, now: Timestamp) -> ApiResult<Actuator> {
        let mut errors = FieldErrors::default();
        let name = (1, NAME_CHARS_MAX);
        let actuator = Actuator {
            id: Id::now(),
            serial_number: errors.text("/serial_number", &self.serial_number, name, false),
            tail_number: errors.text("/tail_number", &self.tail_number, name, false),
            location: errors.text("/location", &self.location, name, false),
            parameter_set: parameter_set(self.parameter_set, &mut errors),
            parameter_set_hash: ParameterSet::reference().hash().into(),
            thresholds: self.thresholds.unwrap_or_default().check(&mut errors),
            usage_unit: self.usage_unit.unwrap_or(UsageUnit::FlightHours),
            created_at: now,
            revision: 0,
        };
        errors.pass(actuator)
    }
}

impl NewThresholds {
    fn check(self, errors: &mut FieldErrors) -> Thresholds {
        let default = Thresholds::default();
        let (kgm, fdj_n) = (self.kgm.unwrap_or(default.kgm), self.fdj_n.unwrap_or(default.fdj_n));
        errors.number("/thresholds/kgm", kgm, Thresholds::KGM, "");
        errors.number("/thresholds/fdj_n", fdj_n, Thresholds::FDJ_N, " N");
        Thresholds { kgm, fdj_n }
    }
}

fn parameter_set(found: Option<String>, errors: &mut FieldErrors) -> String {
    let known = ParameterSet::reference().name().to_owned();
    if let Some(found) = found.filter(|found| *found != known) {
        errors.add("/parameter_set", format!("found {found:?}, expected {known:?}"));
    }
    known
}
