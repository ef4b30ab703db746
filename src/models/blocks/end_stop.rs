//! An end stop: a hard limit of travel at which the body loses its velocity.
//!
//! Source: section 4.1.2 (flapper, spool) and 4.1.4 (jack): the saturated integrator resets the velocity.
//! Signs: symmetrical about zero.
//! Range: a limit above zero.
//! Limits: no rebound, no contact stiffness.

use crate::numeric::lane::Lane;

/// The position held within ±`limit_m` and the velocity, which is exactly zero where the limit held it.
#[inline(always)]
pub fn step<L: Lane>(limit_m: f64, position_m: L, velocity: L) -> (L, L) {
    let limit_m = position_m.same(limit_m);
    let velocity = limit_m.if_less(position_m.abs(), velocity.same(0.0), velocity);
    (position_m.clip(limit_m), velocity)
}

/// The same for one body alone, as a branch: it is seldom taken, and a select would make every step wait for it.
#[inline(always)]
pub fn hold(limit_m: f64, position_m: f64, velocity: f64) -> (f64, f64) {
    if position_m.abs() <= limit_m { (position_m, velocity) } else { held(limit_m, position_m) }
}

#[cold]
fn held(limit_m: f64, position_m: f64) -> (f64, f64) {
    (position_m.clip(limit_m), 0.0)
}

#[cfg(test)]
mod tests {
    #[test]
    fn stops_a_body_at_the_limit_and_leaves_it_alone_inside() {
        for (position, expected) in [(0.5, (0.5, 3.0)), (-1.5, (-1.0, 0.0)), (1.0, (1.0, 3.0)), (7.0, (1.0, 0.0))] {
            assert_eq!(super::step(1.0, position, 3.0), expected);
            assert_eq!(super::hold(1.0, position, 3.0), expected);
        }
    }
}
