//! Degradation laws: how a fault's level grows with usage, and when a path of it first passes the threshold.
//!
//! All in the units of the question: usage in scales from the start of the life, level 0 healthy and 1 at the threshold. The
//! equations and the reasons for the figures are in `docs/prognostics.md`.

use super::normal::{cumulative, density, mills};

/// Beyond this many standard deviations a passage is certain, or impossible.
const CERTAIN: f64 = 6.0;

/// A degradation law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Law {
    /// Wiener process with a steady drift.
    Wiener,
    /// Gamma process with a steady mean: the damage never heals.
    Gamma,
    /// Growth in proportion to the damage done, scattered as a Wiener process in the growth.
    Exponential,
    /// Growth as a power of usage, scattered as a Wiener process in the growth.
    Power,
}

impl Law {
    pub fn name(self) -> &'static str {
        match self {
            Self::Wiener => "wiener",
            Self::Gamma => "gamma",
            Self::Exponential => "exponential",
            Self::Power => "power",
        }
    }
}

/// The mean growth's shape over usage, 0 at 0 and 1 at 1 scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// `x`.
    Linear,
    /// `(exp(rate x) - 1) / (exp(rate) - 1)`; `scale` is the denominator.
    Exponential { rate: f64, scale: f64 },
    /// `x^exponent`.
    Power { exponent: f64 },
}

impl Shape {
    /// The exponential of a rate per scale, above 0.
    pub fn exponential(rate: f64) -> Self {
        Self::Exponential { rate, scale: rate.exp_m1() }
    }

    /// The shape at usage `x`, 0 or more.
    pub fn at(self, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Exponential { rate, scale } => (rate * x).exp_m1() / scale,
            Self::Power { exponent } => x.powf(exponent),
        }
    }

    /// The usage at which the shape comes to `growth`, 0 or more.
    pub fn reaches(self, growth: f64) -> f64 {
        match self {
            Self::Linear => growth,
            Self::Exponential { rate, scale } => (growth * scale).ln_1p() / rate,
            Self::Power { exponent } => growth.powf(1.0 / exponent),
        }
    }
}

/// The probability that a Wiener process has passed `left` (above 0) once its mean growth is `growth`, its variance
/// `scatter` times that: the inverse Gaussian law.
pub(super) fn wiener_passes(left: f64, growth: f64, scatter: f64) -> f64 {
    let deviation = (scatter * growth).sqrt();
    if deviation <= 0.0 {
        return f64::from(u8::from(growth >= left));
    }
    let ahead = (growth - left) / deviation;
    let reflected = (growth + left) / deviation;
    if ahead.abs() > CERTAIN {
        return f64::from(u8::from(ahead > 0.0));
    }
    // exp(2 left / scatter) times the normal tail at `reflected`, without the overflow.
    (cumulative(ahead) + density(ahead) * mills(reflected)).min(1.0)
}

/// The probability that a gamma process has passed `left` (above 0) once its mean growth is `growth`, its variance
/// `scatter` times that: the gamma law, by Wilson and Hilferty's cube root.
pub(super) fn gamma_passes(left: f64, growth: f64, scatter: f64) -> f64 {
    if growth <= 0.0 {
        return 0.0;
    }
    let ninth = scatter / (9.0 * growth);
    let root = (left / growth).cbrt();
    cumulative((1.0 - ninth - root) / ninth.sqrt())
}
