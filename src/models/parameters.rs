//! Parameter sets: the numbers that make the models one actuator type's models.

use serde::{Deserialize, Serialize};

use super::blocks::{Shared, controller, jack, torque_motor};
use super::checks::{Checks, ParamsError};
use super::{monitoring, reference};
use crate::numeric::digest::sha256_hex;

/// The built-in set's text.
const REFERENCE: &str = include_str!("../../config/actuators/reference.toml");

/// The values of a set as they are written down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Values {
    name: String,
    controller: controller::Params,
    torque_motor: torque_motor::Params,
    jack: jack::Params,
    reference: reference::Params,
    monitoring: monitoring::Params,
}

/// The parameters of both models of one actuator type, validated, with their hash.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSet {
    values: Values,
    hash: String,
}

impl ParameterSet {
    /// The built-in reference actuator (`config/actuators/reference.toml`).
    ///
    /// # Panics
    /// Never in a build whose tests pass: the built-in text is valid.
    #[must_use]
    pub fn reference() -> Self {
        Self::parse(REFERENCE).expect("the built-in parameter set is valid")
    }

    /// Reads and validates a set.
    ///
    /// # Errors
    /// The first error of syntax, or every value out of its range; never empty.
    pub fn parse(text: &str) -> Result<Self, Vec<ParamsError>> {
        let values: Values = toml::from_str(text).map_err(|error| vec![error.into()])?;
        let mut checks = Checks::default();
        values.controller.check(&mut checks);
        values.torque_motor.check(&mut checks);
        values.jack.check(&mut checks);
        values.reference.check(&mut checks);
        values.monitoring.check(&mut checks);
        let errors = checks.into_errors();
        if !errors.is_empty() {
            return Err(errors);
        }
        let canonical = serde_json::to_vec(&values).expect("plain numbers and a name serialise");
        let hash = sha256_hex(&canonical);
        Ok(Self { values, hash })
    }

    /// The set's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.values.name
    }

    /// SHA-256 of the set's values, in hexadecimal: it tells two sets of one name apart.
    #[must_use]
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// What both models have.
    #[must_use]
    pub fn shared(&self) -> Shared {
        let Values { controller, torque_motor, jack, .. } = self.values;
        Shared { controller, torque_motor, jack }
    }

    /// What the reference model has of its own.
    #[must_use]
    pub fn reference_model(&self) -> &reference::Params {
        &self.values.reference
    }

    /// What the monitoring model has of its own.
    #[must_use]
    pub fn monitoring_model(&self) -> &monitoring::Params {
        &self.values.monitoring
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_follows_the_values_and_not_the_comments() {
        let same = ParameterSet::parse(&format!("# another comment\n{REFERENCE}")).unwrap();
        assert_eq!(same, ParameterSet::reference());
        let other = ParameterSet::parse(&REFERENCE.replace("mass_kg = 10.0", "mass_kg = 10.1")).unwrap();
        assert_ne!(other.hash(), same.hash());
    }

    #[test]
    fn every_value_out_of_range_is_named_with_its_range_and_unit() {
        let text = REFERENCE.replace("area_m2 = 8.0e-4", "area_m2 = -1.0").replace("mass_kg = 10.0", "mass_kg = nan");
        let errors = ParameterSet::parse(&text).unwrap_err();
        assert_eq!(errors.len(), 2);
        assert_eq!(errors[0].to_string(), "jack.area_m2: found -1, expected 0.000001 to 1 m2");
    }

    #[test]
    fn an_unknown_or_missing_parameter_is_an_error() {
        assert!(ParameterSet::parse(&REFERENCE.replace("mass_kg = 10.0", "mass_lb = 22.0")).is_err());
        assert!(ParameterSet::parse(&format!("{REFERENCE}\nspeed = 1\n")).is_err());
    }
}
