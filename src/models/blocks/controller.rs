//! The position controller: the error becomes a current.
//!
//! Source: section 4.1, figure 4.3; only the proportional gain is non-null there.
//! Signs: a jack short of its command asks for a positive current.
//! Range: any; the torque motor saturates the current.
//! Limits: no integral or derivative action.

use serde::{Deserialize, Serialize};

use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// The controller's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Current per metre of error, A/m.
    #[doc(alias = "GAP")]
    pub proportional_gain_a_per_m: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("controller.proportional_gain_a_per_m", self.proportional_gain_a_per_m, 1e-3, 1e3, "A/m");
    }
}

/// The current asked for, A.
#[inline(always)]
pub fn step<L: Lane>(p: &Params, position_command_m: f64, jack_position_m: L) -> L {
    (jack_position_m.same(position_command_m) - jack_position_m) * p.proportional_gain_a_per_m
}
