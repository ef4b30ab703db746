//! The first stage: the flapper, a mass on the armature's stiffness and the feedback spring.
//!
//! Source: section 4.1.2, figure 4.8; CF = 2 ZF sqrt(MF (KSF + KF)), the root as docs/conventions.md corrects it.
//! Signs: the spool's position adds to the flapper's in the feedback spring, their axes being opposite.
//! Range: end stops at ±XFM, where the velocity becomes zero.
//! Limits: the play Kgioco takes effect at once, without impact.

use serde::{Deserialize, Serialize};

use crate::models::blocks::{dead_zone, end_stop};
use crate::models::checks::Checks;

/// The flapper's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Equivalent mass, kg.
    #[doc(alias = "MF")]
    pub mass_kg: f64,
    /// Damping ratio, dimensionless.
    #[doc(alias = "ZF")]
    pub damping_ratio: f64,
    /// Armature stiffness, N/m.
    #[doc(alias = "KF")]
    pub armature_stiffness_n_per_m: f64,
    /// Feedback-spring stiffness, N/m.
    #[doc(alias = "KSF")]
    pub feedback_spring_stiffness_n_per_m: f64,
    /// Play between the feedback spring's ball and the spool, m.
    #[doc(alias = "Kgioco")]
    pub feedback_backlash_m: f64,
    /// End stop, m.
    #[doc(alias = "XFM")]
    pub flapper_position_max_m: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("reference.first_stage.mass_kg", self.mass_kg, 1e-5, 1.0, "kg");
        checks.within("reference.first_stage.damping_ratio", self.damping_ratio, 0.01, 5.0, "");
        let stiffness = self.armature_stiffness_n_per_m;
        checks.within("reference.first_stage.armature_stiffness_n_per_m", stiffness, 1.0, 1e6, "N/m");
        let spring = self.feedback_spring_stiffness_n_per_m;
        checks.within("reference.first_stage.feedback_spring_stiffness_n_per_m", spring, 1.0, 1e6, "N/m");
        checks.within("reference.first_stage.feedback_backlash_m", self.feedback_backlash_m, 0.0, 1e-2, "m");
        checks.within("reference.first_stage.flapper_position_max_m", self.flapper_position_max_m, 1e-6, 1e-2, "m");
    }
}

impl Params {
    /// KSF + KF, N/m.
    pub(super) fn stiffness_n_per_m(&self) -> f64 {
        self.feedback_spring_stiffness_n_per_m + self.armature_stiffness_n_per_m
    }

    /// CF, N s/m.
    pub(super) fn damping_n_s_per_m(&self) -> f64 {
        2.0 * self.damping_ratio * (self.mass_kg * self.stiffness_n_per_m()).sqrt()
    }
}

/// Where the flapper is and how fast it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position, m.
    #[doc(alias = "XF")]
    pub position_m: f64,
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
}

/// The flapper with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    params: Params,
    damping_n_s_per_m: f64,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(params: &Params) -> Self {
        Self { params: *params, damping_n_s_per_m: params.damping_n_s_per_m() }
    }

    /// One step under the torque motor's force, with the spool where it was.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, s: &State, force_n: f64, spool_position_m: f64, time_step_s: f64) -> State {
        let p = &self.params;
        let bent_m = dead_zone::step(p.feedback_backlash_m, s.position_m + spool_position_m);
        let spring_n = p.feedback_spring_stiffness_n_per_m * bent_m;
        let armature_n = p.armature_stiffness_n_per_m * s.position_m;
        let net_n = force_n - spring_n - armature_n - self.damping_n_s_per_m * s.velocity_m_per_s;
        let velocity = s.velocity_m_per_s + net_n / p.mass_kg * time_step_s;
        let (position_m, velocity_m_per_s) =
            end_stop::hold(p.flapper_position_max_m, s.position_m + velocity * time_step_s, velocity);
        State { position_m, velocity_m_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    #[test]
    fn settles_where_the_springs_balance_the_force_and_stops_at_its_end() {
        let block = Block::new(&ParameterSet::reference().reference_model().first_stage);
        let settle = |force_n: f64| (0..20_000).fold(State::default(), |s, _| block.step(&s, force_n, 1e-5, 1e-5));
        let at_rest = settle(0.5);
        assert!((at_rest.position_m - (0.5 - 6000.0 * 1e-5) / 33_000.0).abs() < 1e-12, "{at_rest:?}");
        let loose = Params { feedback_backlash_m: 4e-6, ..ParameterSet::reference().reference_model().first_stage };
        let block = Block::new(&loose);
        let far = (0..20_000).fold(State::default(), |s, _| block.step(&s, 0.5, 1e-5, 1e-5));
        assert!((far.position_m - (0.5 - 6000.0 * (1e-5 - 2e-6)) / 33_000.0).abs() < 1e-12, "section 4.1.2: {far:?}");
        let block = Block::new(&ParameterSet::reference().reference_model().first_stage);
        let settle = |force_n: f64| (0..20_000).fold(State::default(), |s, _| block.step(&s, force_n, 1e-5, 1e-5));
        assert_eq!(settle(5.0), State { position_m: 30e-6, velocity_m_per_s: 0.0 });
    }
}
