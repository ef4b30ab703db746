//! Registering an actuator, and changing one.

use std::sync::Arc;

use jiff::Timestamp;
use serde::Deserialize;
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::http::error::{ApiError, ApiResult};
use crate::http::limits::NAME_CHARS_MAX;
use crate::models::parameters::ParameterSet;
use crate::store::records::{Actuator, ActuatorUpdate, Id, Thresholds, UsageUnit};

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

/// What is to change of an actuator: at least one of the fields. What is not told stays as it is.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"thresholds": {"kgm": 0.35}}))]
pub struct ActuatorChange {
    /// Its parameter set: NAME or NAME@HASH, as at its registration.
    #[schema(example = "reference")]
    parameter_set: Option<String>,
    /// Its failure thresholds.
    thresholds: Option<ChangedThresholds>,
}

impl ActuatorChange {
    /// The parameter set that it names.
    #[must_use]
    pub fn parameter_set(&self) -> Option<&str> {
        self.parameter_set.as_deref()
    }

    /// The change to make; `set` is the parameter set that it names, if it names one, or what is wrong with the name.
    ///
    /// # Errors
    /// Nothing to change; a set that no actuator can be pinned to, and every threshold out of its range.
    pub fn check(self, set: Option<Result<Arc<ParameterSet>, String>>) -> ApiResult<ActuatorUpdate> {
        let mut errors = FieldErrors::default();
        let ChangedThresholds { kgm, fdj_n } = self.thresholds.unwrap_or_default();
        let parameter_set = set.map(|set| pin(set, &mut errors));
        check_thresholds(kgm, fdj_n, &mut errors);
        let update = ActuatorUpdate { parameter_set, threshold_kgm: kgm, threshold_fdj_n: fdj_n };
        if errors.is_empty() && update == ActuatorUpdate::default() {
            return Err(ApiError::malformed("", "found nothing to change, expected parameter_set or thresholds"));
        }
        errors.pass(update)
    }
}

/// Failure thresholds, each with the service's default (`prognostics.thresholds` of its settings).
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct NewThresholds {
    /// Torque-motor demagnetisation; the service's default, 0.4 unless set, if not told.
    #[schema(minimum = 0.01, maximum = 1)]
    kgm: Option<f64>,
    /// Dynamic jack friction, N; the service's default, 1000 unless set, if not told.
    #[schema(minimum = 210, maximum = 2000)]
    fdj_n: Option<f64>,
}

/// Failure thresholds to change.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct ChangedThresholds {
    /// Torque-motor demagnetisation; as it is if not told.
    #[schema(minimum = 0.01, maximum = 1)]
    kgm: Option<f64>,
    /// Dynamic jack friction, N; as it is if not told.
    #[schema(minimum = 210, maximum = 2000)]
    fdj_n: Option<f64>,
}

impl NewActuator {
    /// The parameter set that it names.
    #[must_use]
    pub fn parameter_set(&self) -> Option<&str> {
        self.parameter_set.as_deref()
    }

    /// The actuator to keep, pinned to a parameter set: the one that it names, or what is wrong with the name. `defaults`
    /// are its thresholds where it has none of its own.
    ///
    /// # Errors
    /// Every field out of its range.
    pub fn check(
        self,
        set: Result<Arc<ParameterSet>, String>,
        defaults: Thresholds,
        now: Timestamp,
    ) -> ApiResult<Actuator> {
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
            thresholds: self.thresholds.unwrap_or_default().check(defaults, &mut errors),
            usage_unit: self.usage_unit.unwrap_or(UsageUnit::FlightHours),
            created_at: now,
            revision: 0,
        };
        errors.pass(actuator)
    }
}

impl NewThresholds {
    fn check(self, defaults: Thresholds, errors: &mut FieldErrors) -> Thresholds {
        check_thresholds(self.kgm, self.fdj_n, errors);
        Thresholds { kgm: self.kgm.unwrap_or(defaults.kgm), fdj_n: self.fdj_n.unwrap_or(defaults.fdj_n) }
    }
}

/// Notes every threshold that is told and out of its range.
fn check_thresholds(kgm: Option<f64>, fdj_n: Option<f64>, errors: &mut FieldErrors) {
    if let Some(kgm) = kgm {
        errors.number("/thresholds/kgm", kgm, Thresholds::KGM, "");
    }
    if let Some(fdj_n) = fdj_n {
        errors.number("/thresholds/fdj_n", fdj_n, Thresholds::FDJ_N, " N");
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
