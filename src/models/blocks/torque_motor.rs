//! The torque motor: the current, limited, becomes a force on the flapper.
//!
//! Source: sections 4.1.1 and 4.1.2, with the fixed gain GM.
//! Signs: a positive current pushes the flapper in the positive direction.
//! Range: the current is held within ±CorM; KGM from 0 (none) to 1 (no force left).
//! Limits: no hysteresis, no offset, no magnetic circuit.

use serde::{Deserialize, Serialize};

use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// The torque motor's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// The most current, A.
    #[doc(alias = "CorM")]
    pub current_max_a: f64,
    /// Force on the flapper per ampere of a healthy motor, N/A.
    #[doc(alias = "GM")]
    pub force_gain_n_per_a: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("torque_motor.current_max_a", self.current_max_a, 1e-4, 10.0, "A");
        checks.within("torque_motor.force_gain_n_per_a", self.force_gain_n_per_a, 1e-2, 1e5, "N/A");
    }
}

/// The current in the motor, A: what the controller asks for and the interference, within the limits.
#[inline(always)]
pub fn current<L: Lane>(p: &Params, asked_a: L, interference_a: f64) -> L {
    (asked_a + interference_a).clip(asked_a.same(p.current_max_a))
}

/// The force on the flapper, N, of a motor that has lost the part `demagnetisation` (KGM) of its gain; section 6.1.
#[inline(always)]
pub fn force<L: Lane>(p: &Params, current_a: L, demagnetisation: L) -> L {
    current_a * p.force_gain_n_per_a * (demagnetisation.same(1.0) - demagnetisation)
}
