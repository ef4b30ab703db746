//! How well an estimate is known: the spread of the features, carried back through the model.
//!
//! The spread is that of the noise and of the known bias between the models. What no model here has, such as a leaking
//! valve, is not in it: it looks like demagnetisation in these two features.

use nalgebra::{Matrix2, Vector2};

use super::evaluate::{Evaluator, Proposal};
use super::features::{Features, Measured};
use super::search::corrected;
use crate::models::fault::{FDJ_MAX_N, FDJ_NOMINAL_N};
use crate::models::monitoring::Bias;

/// Steps of the central differences: demagnetisation, and friction in N.
const STEP: Proposal = Proposal { kgm: 2e-3, fdj_n: 5.0 };

/// A fault that is not known to within this is not known: demagnetisation, and friction as a part of itself.
const KGM_STD_MAX: f64 = 0.1;
const FDJ_STD_MAX: f64 = 0.25;

/// The standard deviations of demagnetisation and friction (N), or `None` where the features do not tell the two
/// apart. First order: the covariance of the features through the inverse of their slopes.
#[must_use]
pub fn standard_deviations(evaluator: &Evaluator, at: Proposal, measured: &Measured, bias: &Bias) -> Option<Proposal> {
    // On a bound the differences are taken just inside it.
    let kgm = at.kgm.clamp(STEP.kgm, 1.0 - STEP.kgm);
    let fdj_n = at.fdj_n.clamp(FDJ_NOMINAL_N + STEP.fdj_n, FDJ_MAX_N - STEP.fdj_n);
    let steps = [
        Proposal { kgm: kgm - STEP.kgm, fdj_n },
        Proposal { kgm: kgm + STEP.kgm, fdj_n },
        Proposal { kgm, fdj_n: fdj_n - STEP.fdj_n },
        Proposal { kgm, fdj_n: fdj_n + STEP.fdj_n },
    ];
    let around = corrected(evaluator, bias, &steps);
    let slope =
        |of: fn(&Features) -> f64, low: usize, step: f64| (of(&around[low + 1]) - of(&around[low])) / (2.0 * step);
    let current = |f: &Features| f.servovalve_current_a;
    let pressure = |f: &Features| f.load_pressure_pa;
    let slopes = Matrix2::new(
        slope(current, 0, STEP.kgm),
        slope(current, 2, STEP.fdj_n),
        slope(pressure, 0, STEP.kgm),
        slope(pressure, 2, STEP.fdj_n),
    );
    let errors = measured.standard_errors;
    let known = bias.at(at.kgm, at.fdj_n);
    let current_a = errors
        .servovalve_current_a
        .hypot(known.current_ratio_std / known.current_ratio * measured.features.servovalve_current_a);
    let pressure_pa = errors.load_pressure_pa.hypot(known.load_pressure_std_pa);
    let inverse = slopes.try_inverse()?;
    let spread = Matrix2::from_diagonal(&Vector2::new(current_a * current_a, pressure_pa * pressure_pa));
    let covariance = inverse * spread * inverse.transpose();
    let found = Proposal { kgm: covariance[(0, 0)].sqrt(), fdj_n: covariance[(1, 1)].sqrt() };
    (found.kgm < KGM_STD_MAX && found.fdj_n < FDJ_STD_MAX * at.fdj_n).then_some(found)
}
