//! Section 3.2.4: what dry friction may do to a body's energy in one step, model by model.
//!
//! Over a step the work of a force is itself times the mean of the velocities before and after, times the step: these
//! works add up to the change of the kinetic energy exactly. A friction that never stops the body inside its step
//! (Coulomb) or only there (Karnopp's dead band) gives a little back where the velocity steps over zero.

use proptest::prelude::*;

use elevon::models::blocks::friction::{Body, FrictionModel, Levels, slide};

/// A body, its friction, and the velocities that one step leads to with that friction and without any.
#[derive(Debug)]
struct Step {
    body: Body,
    after: f64,
    without: f64,
}

impl Step {
    fn new(model: FrictionModel, body: Body, levels: Levels<f64>, band: f64) -> Self {
        let after = slide(model, &levels, band, &body);
        let without = body.velocity_m_per_s + body.active_n / body.mass_kg * body.time_step_s;
        Self { body, after, without }
    }

    /// The friction's impulse, N s, from the momentum that is missing.
    fn impulse(&self) -> f64 {
        self.body.mass_kg * (self.without - self.after)
    }

    /// The friction's work on the body, J.
    fn work_j(&self) -> f64 {
        -self.impulse() * 0.5 * (self.body.velocity_m_per_s + self.after)
    }

    fn turns(&self) -> bool {
        self.body.velocity_m_per_s * self.after < 0.0
    }

    /// The most that rounding does to the work, J.
    fn rounding_j(&self) -> f64 {
        let fastest = self.body.velocity_m_per_s.abs().max(self.without.abs()).max(self.after.abs());
        1e-12 * self.body.mass_kg * fastest * fastest
    }
}

/// Bodies at rest, slow and fast, under forces about and beyond their friction.
fn steps() -> impl Strategy<Value = (Body, Levels<f64>, f64)> {
    let velocity = prop_oneof![Just(0.0), -1.0..1.0_f64, -1e-3..1e-3_f64, -1e-6..1e-6_f64];
    let numbers = (0.01..1e3_f64, velocity, -1.5..1.5_f64, 1e-7..1e-3_f64, 0.0..2e3_f64, 1.0..10.0_f64, 0.0..1e-3_f64);
    numbers.prop_map(|(mass_kg, velocity_m_per_s, force, time_step_s, dynamic_n, ratio, band)| {
        let levels = Levels { static_n: dynamic_n * ratio, dynamic_n };
        (Body { mass_kg, velocity_m_per_s, active_n: force * levels.static_n, time_step_s }, levels, band)
    })
}

proptest! {
    #![proptest_config(super::cases(4000))]

    #[test]
    fn validate_section_3_2_4_borello_s_friction_takes_energy_and_its_arrest_takes_all((body, levels, band) in steps()) {
        let s = Step::new(FrictionModel::Borello, body, levels, band);
        prop_assert!(!s.turns(), "a velocity never changes its sign: {s:?}");
        // In the step of the arrest the reset stands in for the time at rest: the energy left is none.
        prop_assert!(s.after == 0.0 || s.work_j() <= s.rounding_j(), "{s:?}");
        let most = body.velocity_m_per_s.abs().max(s.without.abs());
        prop_assert!(s.after.abs() <= most * (1.0 + 1e-12), "never faster than without friction: {s:?}");
        let held = body.velocity_m_per_s == 0.0 && body.active_n.abs() <= levels.static_n;
        prop_assert!(!held || s.after == 0.0, "{s:?}");
    }

    #[test]
    fn validate_section_3_2_4_coulomb_s_friction_takes_energy_until_the_velocity_steps_over_zero(
        (body, levels, band) in steps(),
    ) {
        let s = Step::new(FrictionModel::Coulomb, body, levels, band);
        // Over zero it pushes on for the rest of the step: by its own impulse at most, and at half the speed reached.
        let given_back_j = if s.turns() { 0.5 * levels.dynamic_n * body.time_step_s * s.after.abs() } else { 0.0 };
        prop_assert!(s.work_j() <= given_back_j + s.rounding_j(), "{s:?}");
        let jump = levels.dynamic_n * body.time_step_s / body.mass_kg;
        let most = body.velocity_m_per_s.abs().max(s.without.abs()) + if s.turns() { jump } else { 0.0 };
        prop_assert!(s.after.abs() <= most * (1.0 + 1e-12), "{s:?}");
    }

    #[test]
    fn validate_section_3_2_4_karnopp_s_friction_takes_energy_outside_its_dead_band((body, levels, band) in steps()) {
        let s = Step::new(FrictionModel::Karnopp, body, levels, band);
        let stuck = body.velocity_m_per_s.abs() <= band;
        if stuck && body.active_n.abs() <= levels.static_n {
            prop_assert_eq!(s.after, 0.0);
        } else if stuck {
            // It answers the force, not the velocity: against a velocity of the other sign that is a push.
            let push_j = levels.static_n * body.time_step_s * band;
            prop_assert!(s.work_j() <= push_j + s.rounding_j(), "{s:?}");
        } else {
            let given_back_j = if s.turns() { 0.5 * levels.dynamic_n * body.time_step_s * s.after.abs() } else { 0.0 };
            prop_assert!(s.work_j() <= given_back_j + s.rounding_j(), "{s:?}");
        }
    }
}
