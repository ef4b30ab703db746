//! The known difference between the two models' features.

use serde::{Deserialize, Serialize};

use crate::models::checks::Checks;

/// The known difference between the two models' features, with its spread.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bias {
    /// Steady current of the reference model over this model's, dimensionless.
    pub current_ratio: f64,
    /// Standard deviation of that ratio over the fault levels.
    pub current_ratio_std: f64,
    /// Standard deviation of the difference of the pressure features, Pa.
    pub load_pressure_std_pa: f64,
}

impl Bias {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("monitoring.bias.current_ratio", self.current_ratio, 0.5, 2.0, "");
        checks.within("monitoring.bias.current_ratio_std", self.current_ratio_std, 0.0, 0.5, "");
        checks.within("monitoring.bias.load_pressure_std_pa", self.load_pressure_std_pa, 0.0, 1e6, "Pa");
    }
}
