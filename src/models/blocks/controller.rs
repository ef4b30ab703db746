//! The position controller: the error becomes a current.
//!
//! Source: section 4.1, figure 4.3: three gains in parallel, of which the thesis uses the proportional one.
//! Signs: a jack short of its command asks for a positive current.
//! Range: any; the torque motor saturates the current.
//! Limits: the derivative is not filtered; the integral is held within the most current, so that it cannot wind up.

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
    /// Current per metre and second of error, A/(m s).
    #[doc(alias = "GAI")]
    pub integral_gain_a_per_m_s: f64,
    /// Current per velocity of the error, A s/m.
    #[doc(alias = "GAD")]
    pub derivative_gain_a_s_per_m: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("controller.proportional_gain_a_per_m", self.proportional_gain_a_per_m, 1e-3, 1e3, "A/m");
        checks.within("controller.integral_gain_a_per_m_s", self.integral_gain_a_per_m_s, 0.0, 1e4, "A/(m s)");
        checks.within("controller.derivative_gain_a_s_per_m", self.derivative_gain_a_s_per_m, 0.0, 10.0, "A s/m");
    }
}

/// What the controller remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// The integral's current, A.
    pub integral_a: f64,
    /// The error of the step before, m.
    pub error_m: f64,
}

/// The state after a step and the current asked for, A; the integral stays within ±`current_max_a`.
#[inline(always)]
#[must_use]
pub fn step(p: &Params, s: &State, error_m: f64, current_max_a: f64, time_step_s: f64) -> (State, f64) {
    if p.integral_gain_a_per_m_s == 0.0 && p.derivative_gain_a_s_per_m == 0.0 {
        // The thesis's controller; what the other parts would add is zero, but takes time.
        return (State { integral_a: s.integral_a, error_m }, error_m * p.proportional_gain_a_per_m);
    }
    let integral_a = (s.integral_a + p.integral_gain_a_per_m_s * error_m * time_step_s).clip(current_max_a);
    let derivative_a = p.derivative_gain_a_s_per_m * ((error_m - s.error_m) / time_step_s);
    (State { integral_a, error_m }, error_m * p.proportional_gain_a_per_m + integral_a + derivative_a)
}

/// The current asked for by the proportional part alone, A.
#[inline(always)]
pub fn proportional<L: Lane>(p: &Params, position_command_m: f64, jack_position_m: L) -> L {
    (jack_position_m.same(position_command_m) - jack_position_m) * p.proportional_gain_a_per_m
}

#[cfg(test)]
mod tests {
    use super::*;

    const PID: Params =
        Params { proportional_gain_a_per_m: 2.0, integral_gain_a_per_m_s: 3.0, derivative_gain_a_s_per_m: 0.5 };

    #[test]
    fn validate_figure_4_3_the_three_parts_add_up() {
        let (s, first_a) = step(&PID, &State::default(), 0.1, 1.0, 0.01);
        assert!((first_a - (2.0 * 0.1 + 3.0 * 0.1 * 0.01 + 0.5 * 0.1 / 0.01)).abs() < 1e-12);
        let (_, second_a) = step(&PID, &s, 0.1, 1.0, 0.01);
        assert!((second_a - (2.0 * 0.1 + 3.0 * 0.2 * 0.01)).abs() < 1e-12, "a constant error has no derivative");
    }

    #[test]
    fn the_integral_does_not_wind_up() {
        let mut s = State::default();
        for _ in 0..10_000 {
            s = step(&PID, &s, 0.5, 0.04, 0.01).0;
        }
        assert_eq!(s.integral_a, 0.04);
        assert!(step(&PID, &s, -0.5, 0.04, 0.01).0.integral_a < 0.04, "it leaves the limit at once");
    }
}
