//! The first stage of the monitoring model: a second-order transfer function from force to flapper position.
//!
//! Source: section 4.2: XF/T = 1/(KFm + KSFm) / (s²/SNF² + 2 ZF s/SNF + 1).
//! Signs: the spool's position counts against the torque motor's force.
//! Range: end stops at ±XFM, where the velocity becomes zero.
//! Limits: no backlash.

use serde::{Deserialize, Serialize};

use super::State;
use crate::models::blocks::end_stop;
use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// The flapper's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Natural frequency, rad/s.
    #[doc(alias = "SNF")]
    pub natural_frequency_rad_per_s: f64,
    /// Damping ratio, dimensionless.
    #[doc(alias = "ZF")]
    pub damping_ratio: f64,
    /// Stiffness of the flapper, N/m.
    #[doc(alias = "KFm")]
    pub flapper_stiffness_n_per_m: f64,
    /// Stiffness of the feedback spring, N/m.
    #[doc(alias = "KSFm")]
    pub feedback_spring_stiffness_n_per_m: f64,
    /// End stop, m.
    #[doc(alias = "XFM")]
    pub flapper_position_max_m: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        let (frequency, zeta) = (self.natural_frequency_rad_per_s, self.damping_ratio);
        checks.within("monitoring.first_stage.damping_ratio", zeta, 0.01, 5.0, "");
        // Half of where the semi-implicit step of 1e-5 s stops being stable (Jury's condition).
        let frequency_max = ((1.0 + zeta * zeta).sqrt() - zeta) / 1e-5;
        let name = "monitoring.first_stage.natural_frequency_rad_per_s";
        checks.within_drawn(name, frequency, (10.0, 1e5), (10.0, frequency_max), "rad/s");
        let stiffness = self.flapper_stiffness_n_per_m;
        checks.within("monitoring.first_stage.flapper_stiffness_n_per_m", stiffness, 1.0, 1e7, "N/m");
        let spring = self.feedback_spring_stiffness_n_per_m;
        checks.within("monitoring.first_stage.feedback_spring_stiffness_n_per_m", spring, 1.0, 1e7, "N/m");
        checks.within("monitoring.first_stage.flapper_position_max_m", self.flapper_position_max_m, 1e-6, 1e-2, "m");
    }

    /// KFm + KSFm, N/m.
    pub(super) fn stiffness_n_per_m(&self) -> f64 {
        self.flapper_stiffness_n_per_m + self.feedback_spring_stiffness_n_per_m
    }
}

/// The flapper's position and velocity after a semi-implicit step.
#[inline(always)]
pub fn step<L: Lane>(p: &Params, s: &State<L>, force_n: L, time_step_s: f64) -> (L, L) {
    let (frequency, stiffness) = (p.natural_frequency_rad_per_s, p.stiffness_n_per_m());
    let net_n = force_n - s.spool_position_m * p.feedback_spring_stiffness_n_per_m;
    let acceleration = (net_n * (1.0 / stiffness) - s.flapper_position_m) * (frequency * frequency)
        - s.flapper_velocity_m_per_s * (2.0 * p.damping_ratio * frequency);
    let velocity = s.flapper_velocity_m_per_s + acceleration * time_step_s;
    end_stop::step(p.flapper_position_max_m, s.flapper_position_m + velocity * time_step_s, velocity)
}
