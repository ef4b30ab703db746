//! Dry friction on a body that sticks and slips: Borello's model and Karnopp's.
//!
//! Source: section 3.2.4, with Borello's equations as corrected in docs/conventions.md.
//! Signs: the friction force opposes a positive velocity when positive.
//! Range: static friction at least the dynamic one, both non-negative.
//! Limits: no Stribeck effect; the step, not a velocity, decides when a body stops (Borello).

use crate::numeric::lane::Lane;

/// What a body needs to break away and to keep moving, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels<L> {
    /// The most force that a body at rest withstands (FSJ).
    pub static_n: L,
    /// The force against a moving body (FDJ).
    pub dynamic_n: L,
}

/// Borello's friction force, N, for the active force on a body: at rest (velocity exactly zero) the friction answers
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

    /// One step of a body of 1 kg under Borello's friction.
    fn slide(velocity: f64, active_n: f64, time_step_s: f64) -> f64 {
        arrest(velocity, velocity + (active_n - borello(&LEVELS, velocity, active_n)) * time_step_s)
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
    fn karnopp_holds_a_body_inside_the_dead_band_and_lets_it_go_beyond_the_static_level() {
        assert_eq!(karnopp(&LEVELS, 0.5, 3.0, 1.0), 3.0);
        assert_eq!(karnopp(&LEVELS, 0.5, 9.0, 1.0), 4.0);
        assert_eq!(karnopp(&LEVELS, -1.5, 9.0, 1.0), -2.0);
    }
}
