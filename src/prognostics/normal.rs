//! The standard normal law, and deviates that fill it evenly.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use statrs::function::erf::{erfc, erfc_inv};

/// Probabilities nearer 0 or 1 than this count as this near, where a quantile is sought.
const PROBABILITY_MIN: f64 = 1e-12;

/// Term `i` of a sequence that fills 0 to 1 evenly (Weyl): the fractions of the multiples of an irrational number.
pub(super) fn spread(i: usize, irrational: f64) -> f64 {
    ((i as f64 + 0.5) * irrational).fract()
}

/// The standard normal distribution function.
pub(super) fn cumulative(deviate: f64) -> f64 {
    match deviate {
        z if z < -6.0 => 0.0,
        z if z > 6.0 => 1.0,
        z => 0.5 * erfc(-z * FRAC_1_SQRT_2),
    }
}

/// The standard normal quantile.
pub(super) fn deviate(p: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * p.clamp(PROBABILITY_MIN, 1.0 - PROBABILITY_MIN))
}
