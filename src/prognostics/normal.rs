//! The standard normal law, deviates that fill it evenly, and a law with heavy tails.

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, SQRT_2};

use statrs::function::erf::{erfc, erfc_inv};

/// Probabilities nearer 0 or 1 than this count as this near, where a quantile is sought.
const PROBABILITY_MIN: f64 = 1e-12;
/// One over the square root of 2 pi.
const DENSITY_MAX: f64 = 0.398_942_280_401_432_7;
/// From here on Mills' ratio is taken from its asymptotic fraction (relative error below 1e-4).
const MILLS_FAR: f64 = 6.0;

/// Term `i` of a sequence that fills 0 to 1 evenly (Weyl): the fractions of the multiples of an irrational number.
pub(super) fn spread(i: usize, irrational: f64) -> f64 {
    ((i as f64 + 0.5) * irrational).fract()
}

/// The standard normal density.
pub(super) fn density(deviate: f64) -> f64 {
    DENSITY_MAX * (-0.5 * deviate * deviate).exp()
}

/// The logarithm of a normal density of a standard deviation, at a standard deviate.
pub(super) fn log_density(deviate: f64, deviation: f64) -> f64 {
    -0.5 * deviate * deviate - deviation.ln() - 0.918_938_533_204_672_8
}

/// The logarithm of the density of Student's law with 3 degrees of freedom and a scale, at a deviate in scales: as the normal
/// law near the middle, with heavy tails.
pub(super) fn log_heavy(deviate: f64, scale: f64) -> f64 {
    -1.000_888_8 - 2.0 * (deviate * deviate / 3.0).ln_1p() - scale.ln()
}

/// The distribution function of Student's law with 3 degrees of freedom.
pub(super) fn heavy_cumulative(deviate: f64) -> f64 {
    let t = deviate.clamp(-1e6, 1e6) / 3f64.sqrt();
    0.5 + (t.atan() + t / (1.0 + t * t)) * FRAC_1_PI
}

/// The standard normal distribution function.
pub(super) fn cumulative(deviate: f64) -> f64 {
    match deviate {
        z if z < -6.0 => 0.0,
        z if z > 6.0 => 1.0,
        z => 0.5 * erfc(-z * FRAC_1_SQRT_2),
    }
}

/// Mills' ratio: the probability above a deviate, 0 or more, over the density there.
pub(super) fn mills(deviate: f64) -> f64 {
    let z = deviate;
    if z > MILLS_FAR {
        // The continued fraction's third convergent.
        return (z * z + 2.0) / (z * (z * z + 3.0));
    }
    0.5 * erfc(z * FRAC_1_SQRT_2) / density(z)
}

/// The standard normal quantile.
pub(super) fn deviate(p: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * p.clamp(PROBABILITY_MIN, 1.0 - PROBABILITY_MIN))
}
