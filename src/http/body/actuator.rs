//! Registering an actuator.

use std::sync::Arc;

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
    /// Its parameter set: NAME, the version of that name that was kept last, or NAME@HASH, the one whose hash begins with
    /// these 8 or more digits; `reference` unless told.
    #[schema(example = "reference")]
    parameter_set: Option<String>,
    /// Its failure thresholds.
    thresholds: Option<NewThresholds>,
    /// What its usage counts; `flight_hours` unless told.
    usage_unit: Option<UsageUnit>,
}

/// What is to change of an actuator.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ActuatorChange {
    /// Its parameter set: NAME or NAME@HASH, as at its registration.
    #[schema(example = "reference")]
    pub parameter_set: String,
}

impl ActuatorChange {
    /// The name and the hash of the set to pin it to: the one that it names, or what is wrong with the name.
    ///
    /// # Errors
    /// A set that no actuator can be pinned to.
    pub fn check(set: Result<Arc<ParameterSet>, String>) -> ApiResult<(String, String)> {
        let mut errors = FieldErrors::default();
        let pinned = pin(set, &mut errors);
        errors.pass(pinned)
    }
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
    /// The parameter set that it names.
    #[must_use]
    pub fn parameter_set(&self) -> Option<&str> {
        self.parameter_set.as_deref()
    }

    /// The actuator to keep, pinned to a parameter set: the one that it names, or what is wrong with the name.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(self, set: Result<Arc<ParameterSet>, String>, now: Timestamp) -> ApiResult<Actuator> {
        let mut errors = FieldErrors::default();
        let name = (1, NAME_CHARS_MAX);
        let serial_number = errors.text("/serial_number", &self.serial_number, name, false);
        let tail_number = errors.text("/tail_number", &self.tail_number, name, false);
        let location = errors.text("/location", &self.location, name, false);
        let (parameter_set, parameter_set_hash) = pin(set, &mut errors);
        let actuator = Actuator {
            id: Id::now(),
            serial_number,
            tail_number,
            location,
            parameter_set,
            parameter_set_hash,
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

/// The name and the hash that an actuator is pinned to. The built-in set goes with the program, so that no earlier version
/// of it can be pinned.
fn pin(set: Result<Arc<ParameterSet>, String>, errors: &mut FieldErrors) -> (String, String) {
    let built_in = ParameterSet::reference();
    let set = set.unwrap_or_else(|detail| {
        errors.add("/parameter_set", detail);
        Arc::new(built_in.clone())
    });
    if set.name() == built_in.name() && set.hash() != built_in.hash() {
        let (name, hash) = (set.name(), set.hash());
        let detail = format!("found {name}@{hash}, which came with another version of elevon, expected {name} alone");
        errors.add("/parameter_set", detail);
    }
    (set.name().to_owned(), set.hash().to_owned())
}
