//! Dry friction on a body that sticks and slips: the models of Coulomb, Karnopp and Borello.
//!
//! Source: section 3.2.4, with Borello's equations as corrected in docs/conventions.md.
//! Signs: the friction force opposes a positive velocity when positive.
//! Range: static friction at least the dynamic one, both non-negative.
//! Limits: no Stribeck effect; the step, not a velocity, decides when a body stops (Borello).

use serde::{Deserialize, Serialize};

use crate::numeric::lane::Lane;

/// Which model of friction holds a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrictionModel {
    /// Coulomb's: a body that has moved never stops, its velocity jumps about zero.
    Coulomb,
    /// Karnopp's: a body slower than a dead band is stuck.
    Karnopp,
    /// Borello's: a body stops in the step in which its velocity would change sign.
    Borello,
}

/// The velocity of a body of this mass after a step under an active force, N, and a friction model, m/s.
#[inline(always)]
#[must_use]
pub fn slide(model: FrictionModel, levels: &Levels<f64>, dead_band_m_per_s: f64, body: &Body) -> f64 {
    let &Body { mass_kg, velocity_m_per_s: before, active_n, time_step_s } = body;
    match model {
        FrictionModel::Borello => {
            let friction_n = borello(levels, before, active_n);
            arrest(before, before + (active_n - friction_n) / mass_kg * time_step_s)
        }
        FrictionModel::Coulomb => before + (active_n - borello(levels, before, active_n)) / mass_kg * time_step_s,
        FrictionModel::Karnopp if before.abs() <= dead_band_m_per_s && active_n.abs() <= levels.static_n => 0.0,
        FrictionModel::Karnopp => {
            let friction_n = karnopp(levels, before, active_n, dead_band_m_per_s);
            before + (active_n - friction_n) / mass_kg * time_step_s
        }
    }
}

/// A body and what drives it for one step.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// Its velocity before, m/s.
    pub velocity_m_per_s: f64,
    /// The force on it beside the friction, N.
    pub active_n: f64,
    /// The step, s.
    pub time_step_s: f64,
}

/// What a body needs to break away and to keep moving, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels<L> {
    /// The most force that a body at rest withstands (FSJ).
    pub static_n: L,
    /// The force against a moving body (FDJ).
    pub dynamic_n: L,
}

/// Borello's friction force (and Coulomb's), N, for the active force on a body: at rest (velocity exactly zero) the friction answers
/// the active force up to the static level; in motion it is the dynamic level against the velocity.
#[inline(always)]
#[must_use]
pub fn borello(levels: &Levels<f64>, velocity: f64, active_n: f64) -> f64 {
    if velocity == 0.0 { active_n.clip(levels.static_n) } else { velocity.sign_times(levels.dynamic_n) }
}

/// Borello's arrest: the velocity is zero for the step in which its sign would change.
#[inline(always)]
#[must_use]
pub fn arrest(previous: f64, velocity: f64) -> f64 {
    if previous * velocity < 0.0 { 0.0 } else { velocity }
}

/// Karnopp's friction force, N: inside the dead band the body counts as stuck and friction answers the active force
/// up to the static level.
#[inline(always)]
pub fn karnopp<L: Lane>(levels: &Levels<L>, velocity: L, active_n: L, dead_band: f64) -> L {
    let moving = velocity.sign_times(levels.dynamic_n);
    let stuck = active_n.clip(levels.static_n);
    velocity.same(dead_band).if_less(velocity.abs(), moving, stuck)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: Levels<f64> = Levels { static_n: 4.0, dynamic_n: 2.0 };

    fn after(model: FrictionModel, band: f64, velocity: f64, active_n: f64, time_step_s: f64) -> f64 {
        let body = Body { mass_kg: 1.0, velocity_m_per_s: velocity, active_n, time_step_s };
        super::slide(model, &LEVELS, band, &body)
    }

    /// One step of a body of 1 kg under Borello's friction.
    fn slide(velocity: f64, active_n: f64, time_step_s: f64) -> f64 {
        after(FrictionModel::Borello, 0.0, velocity, active_n, time_step_s)
    }

    /// The velocities of a body of 1 kg under a weak spring about its start, once its first swing is over.
    fn swing(model: FrictionModel, band: f64) -> Vec<f64> {
        let (mut position, mut velocity, dt) = (0.0, 3.0, 1e-2);
        let one = |_| {
            velocity = after(model, band, velocity, -0.5 * position, dt);
            position += velocity * dt;
            velocity
        };
        (0..4000).map(one).skip(2000).collect()
    }

    #[test]
    fn validate_section_3_2_4_borello_tells_the_four_cases_apart() {
        assert_eq!(slide(0.0, 3.9, 0.1), 0.0, "at rest, remains at rest");
        assert!(slide(0.0, -4.1, 0.1) < 0.0, "at rest, starts to move");
        assert_eq!(slide(1.0, 2.0, 0.1), 1.0, "in motion, remains in motion");
        assert_eq!(slide(0.1, 0.0, 0.1), 0.0, "in motion, stops");
    }

    #[test]
    fn validate_section_3_2_4_a_body_that_stops_against_a_great_force_moves_again_at_the_next_step() {
        let stopped = slide(0.1, -5.0, 0.1);
        assert_eq!(stopped, 0.0);
        assert!(slide(stopped, -5.0, 0.1) < 0.0);
    }

    #[test]
    fn validate_section_3_2_4_coulomb_never_finds_the_arrest() {
        let velocities = swing(FrictionModel::Coulomb, 0.0);
        assert!(velocities.iter().all(|v| *v != 0.0));
        assert!(velocities.windows(2).filter(|two| two[0] * two[1] < 0.0).count() > 500, "it jumps about zero");
    }

    #[test]
    fn validate_section_3_2_4_karnopp_and_borello_hold_a_body_whose_spring_is_weaker_than_the_static_friction() {
        assert!(swing(FrictionModel::Borello, 0.0).iter().all(|v| *v == 0.0));
        assert!(swing(FrictionModel::Karnopp, 0.05).iter().all(|v| *v == 0.0));
    }

    #[test]
    fn validate_section_3_2_4_too_narrow_a_dead_band_steps_over_the_arrest_and_becomes_unstable() {
        // A step changes the velocity by 0.02: a band of a millionth of that is never met, as if there were none.
        let velocities = swing(FrictionModel::Karnopp, 2e-8);
        assert!(velocities.iter().all(|v| *v != 0.0));
        assert!(velocities.windows(2).filter(|two| two[0] * two[1] < 0.0).count() > 500);
    }

    #[test]
    fn validate_section_3_2_4_too_wide_a_dead_band_makes_a_limit_cycle() {
        // A belt draws the body at 0.1 by a spring of 10. A fine band tells the slow slip from the arrest; in one
        // wider than the belt's velocity the body counts as stuck while it moves and lets go again and again.
        let breaks = |band: f64| {
            let (mut position, mut velocity, dt) = (0.0, 0.0, 1e-3);
            let levels = Levels { static_n: 2.0, dynamic_n: 2.0 };
            let one = |k: i32| {
                let active_n = 10.0 * (0.1 * f64::from(k) * dt - position) + 1.0 * (0.1 - velocity);
                let body = Body { mass_kg: 1.0, velocity_m_per_s: velocity, active_n, time_step_s: dt };
                velocity = super::slide(FrictionModel::Karnopp, &levels, band, &body);
                position += velocity * dt;
                velocity
            };
            let velocities: Vec<f64> = (0..60_000).map(one).skip(30_000).collect();
            velocities.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - velocities.iter().copied().fold(f64::INFINITY, f64::min)
        };
        assert!(breaks(1e-4) < 1e-6, "a fine band glides: {}", breaks(1e-4));
        assert!(breaks(0.2) > 0.02, "a wide band hunts: {}", breaks(0.2));
    }

    #[test]
    fn karnopp_holds_a_body_inside_the_dead_band_and_lets_it_go_beyond_the_static_level() {
        assert_eq!(karnopp(&LEVELS, 0.5, 3.0, 1.0), 3.0);
        assert_eq!(karnopp(&LEVELS, 0.5, 9.0, 1.0), 4.0);
        assert_eq!(karnopp(&LEVELS, -1.5, 9.0, 1.0), -2.0);
    }
}
