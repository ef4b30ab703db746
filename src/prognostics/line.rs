//! The degradation law "line": a fault that grows at a steady rate, give or take, and is observed through noise.
//!
//! All in the units of the question: usage in ages, value 0 healthy and 1 at the threshold. The equations and the
//! reasons for the priors are in `docs/prognostics.md`.

use super::history::Point;
use super::normal::{deviate, spread};

/// Bounds of the present slope, threshold distances per age, even in logarithm (chosen: lives of up to a hundred ages; and
/// no new part that is through in less than a twentieth of its age).
const SLOPE: (f64, f64) = (1e-2, 2e1);
/// Bounds of the noise's standard deviation, threshold distances (chosen: from as good as none to the whole way).
const NOISE: (f64, f64) = (1e-3, 1.0);
/// Bounds of the wander's standard deviation over one age, threshold distances (chosen: at most as if ten independent
/// steps made a life).
const WANDER: (f64, f64) = (1e-3, 0.316);
/// Bounds of the standard deviation of the slope's drift over one age (chosen: at most from nothing to a life in a
/// third of an age).
const DRIFT: (f64, f64) = (1e-3, 3.16);
/// The most that drift may change the rate over the remaining life: one standard deviation of its logarithm (chosen).
const DRIFT_CHANGE_MAX: f64 = 1.0;
/// Doubt of the law itself: the standard deviation of the exponent of usage about the line's 1 (chosen: wear that
/// grows as the root of usage, or as its power 3/2, is nothing unusual).
const EXPONENT_DOUBT: f64 = 0.5;
/// Cells of the grids: half a decade or less each, but for the slope, whose cells follow the likelihood.
const NOISE_CELLS: usize = 16;
const WANDER_CELLS: usize = 5;
const DRIFT_CELLS: usize = 7;
const SLOPE_CELLS: usize = 32;
/// Below this curvature of the log-likelihood no slope within the bounds is told from another.
const INFORMATION_MIN: f64 = 1e-6;
/// What lies this far below the best in log-likelihood is left out.
const LOG_LIKELIHOOD_DROP: f64 = 12.0;
/// How many lines stand for the posterior.
const LINES: usize = 256;
/// How much denser the lines lie among fast slopes, which end lives soon, than among slow ones: line i of n stands for
/// the posterior's probability between 1 - (1 - i/n)^k and the same of the next.
const TAIL_POWER: i32 = 3;

/// One line of the posterior: the level at usage x from `at` is normal, its mean `level + slope x`, its variance
/// `variance + wander x`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub level: f64,
    pub slope: f64,
    pub variance: f64,
    pub wander: f64,
    /// Its share of the posterior's probability.
    pub weight: f64,
}

/// The posterior as lines whose weights add up to 1; none without a point.
pub(super) fn posterior(points: &[Point]) -> Vec<Line> {
    let Some(last) = points.last() else { return Vec::new() };
    let mut fits = Vec::with_capacity(NOISE_CELLS * WANDER_CELLS * DRIFT_CELLS);
    for noise in logarithmic(NOISE, NOISE_CELLS) {
        for wander in logarithmic(WANDER, WANDER_CELLS) {
            for drift in logarithmic(DRIFT, DRIFT_CELLS) {
                let variances = Variances { noise: noise * noise, wander: wander * wander, drift: drift * drift };
                fits.push(Fit::new(points, last.value, variances));
            }
        }
    }
    let best = fits.iter().map(Fit::log_likelihood_max).fold(f64::NEG_INFINITY, f64::max);
    let near = fits.iter().filter(|fit| fit.log_likelihood_max() > best - LOG_LIKELIHOOD_DROP);
    thinned(near.flat_map(|fit| fit.candidates(best)).collect())
}

/// The variances that the likelihood is conditional on: of the noise, and per age of the wander and the slope's drift.
#[derive(Clone, Copy)]
struct Variances {
    noise: f64,
    wander: f64,
    drift: f64,
}

/// The likelihood of the slope, and the present level given the slope, for one set of variances.
struct Fit {
    variances: Variances,
    /// The level at slope 0, and what a unit of slope takes from it.
    level: f64,
    level_per_slope: f64,
    level_variance: f64,
    /// -2 log-likelihood = constant - 2 xy slope + xx slope².
    constant: f64,
    xy: f64,
    xx: f64,
}

impl Fit {
    /// One pass of a Kalman filter back from `at`, where wander and drift are 0 by definition. The filter is linear, so
    /// it runs on the values (less `offset`), on the level's regressor 1 and on the slope's regressor x alike; least
    /// squares on the three innovations does the rest.
    fn new(points: &[Point], offset: f64, variances: Variances) -> Self {
        let Variances { noise, wander, drift } = variances;
        let (mut state, mut rate) = ([0.0; 3], [0.0; 3]);
        let (mut p_state, mut p_cross, mut p_rate) = (0.0, 0.0, 0.0);
        let (mut yy, mut y1, mut xy, mut n, mut x1, mut xx) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut log_variance, mut usage) = (0.0, 0.0);
        for point in points.iter().rev() {
            let back = usage - point.usage;
            usage = point.usage;
            p_state += back * (2.0 * p_cross + back * p_rate + wander + drift * back * back / 3.0);
            p_cross += back * (p_rate + 0.5 * drift * back);
            p_rate += back * drift;
            let noise = noise + point.variance;
            let total = p_state + noise;
            let (gain, rate_gain) = (p_state / total, p_cross / total);
            let mut innovation = [point.value - offset, 1.0, point.usage];
            for i in 0..3 {
                state[i] += back * rate[i];
                innovation[i] -= state[i];
                state[i] += gain * innovation[i];
                rate[i] += rate_gain * innovation[i];
            }
            p_rate = (p_rate - rate_gain * p_cross).max(0.0);
            p_cross *= noise / total;
            p_state *= noise / total;
            log_variance += total.ln();
            let [y, one, x] = innovation;
            yy += y * y / total;
            y1 += y * one / total;
            xy += x * y / total;
            n += one * one / total;
            x1 += x * one / total;
            xx += x * x / total;
        }
        Self {
            variances,
            level: offset + y1 / n,
            level_per_slope: x1 / n,
            level_variance: 1.0 / n,
            constant: log_variance + n.ln() + yy - y1 * y1 / n,
            xy: xy - x1 * y1 / n,
            xx: xx - x1 * x1 / n,
        }
    }

    fn log_likelihood(&self, slope: f64) -> f64 {
        -0.5 * (self.constant + slope * (slope * self.xx - 2.0 * self.xy))
    }

    fn log_likelihood_max(&self) -> f64 {
        let best = if self.xx < INFORMATION_MIN { SLOPE.0 } else { self.xy / self.xx };
        self.log_likelihood(best.clamp(SLOPE.0, SLOPE.1))
    }

    /// The bounds of the slopes that are not left out.
    fn slopes(&self) -> (f64, f64) {
        if self.xx < INFORMATION_MIN {
            return SLOPE;
        }
        let best = self.xy / self.xx;
        let outside = best - best.clamp(SLOPE.0, SLOPE.1);
        let reach = (outside * outside + 2.0 * LOG_LIKELIHOOD_DROP / self.xx).sqrt();
        ((best - reach).clamp(SLOPE.0, SLOPE.1), (best + reach).clamp(SLOPE.0, SLOPE.1))
    }

    /// The cells of the slope's grid; weights are relative to the log-likelihood `best`.
    fn candidates(&self, best: f64) -> impl Iterator<Item = Candidate> {
        let bounds = self.slopes();
        let width = (bounds.1 / bounds.0).ln().max(f64::EPSILON);
        logarithmic(bounds, SLOPE_CELLS).map(move |slope| {
            let level = self.level - slope * self.level_per_slope;
            let line = Line { level, slope, variance: self.level_variance, wander: self.variances.wander, weight: 0.0 };
            let left = (1.0 - level).max(0.0) / slope;
            let drift_change = (self.variances.drift * left / 3.0).sqrt() / slope;
            let rate_deviation = drift_change.min(DRIFT_CHANGE_MAX).hypot(EXPONENT_DOUBT * left.ln_1p());
            Candidate { weight: (self.log_likelihood(slope) - best).exp() * width, line, rate_deviation }
        })
    }
}

/// A line with its share of the posterior and the standard deviation of the logarithm of the rate to come over the
/// present slope.
struct Candidate {
    weight: f64,
    line: Line,
    rate_deviation: f64,
}

/// The midpoints of `n` cells of equal width in logarithm.
fn logarithmic((low, high): (f64, f64), n: usize) -> impl Iterator<Item = f64> {
    let step = (high / low).ln() / n as f64;
    (0..n).map(move |i| low * ((i as f64 + 0.5) * step).exp())
}

/// Systematic selection in order of slope, ever finer towards the fast ones; each line gets its rate to come at an evenly
/// spread deviate.
fn thinned(mut candidates: Vec<Candidate>) -> Vec<Line> {
    candidates.sort_by(|a, b| a.line.slope.total_cmp(&b.line.slope));
    let total: f64 = candidates.iter().map(|c| c.weight).sum();
    // The probability up to a point among the lines.
    let up_to = |point: f64| 1.0 - (1.0 - point / LINES as f64).powi(TAIL_POWER);
    let mut lines = Vec::with_capacity(LINES);
    let mut sum = 0.0;
    for candidate in candidates {
        sum += candidate.weight;
        while lines.len() < LINES && up_to(lines.len() as f64 + 0.5) * total <= sum {
            let i = lines.len();
            let rate = (candidate.rate_deviation * deviate(spread(i, std::f64::consts::GOLDEN_RATIO))).exp();
            let weight = up_to(i as f64 + 1.0) - up_to(i as f64);
            lines.push(Line { slope: candidate.line.slope * rate, weight, ..candidate.line });
        }
    }
    lines
}
