//! First passage: from the paths of a posterior to the probability that the threshold has been passed.

use std::f64::consts::SQRT_2;

use super::law::{Law, gamma_passes, wiener_passes};
use super::normal::{deviate, spread};
use super::posterior::Path;

/// How near a quantile comes, in standard normal deviates.
const DEVIATE_TOLERANCE: f64 = 1e-4;

/// The farthest growth that a path is followed for, threshold distances.
const GROWTH_MAX: f64 = 1e3;

/// Deviates at which each path's normal law is taken for the band.
const DRAWS: usize = 2;

/// The distribution of one fault's level, from which its life follows.
#[derive(Debug, Clone)]
pub(super) struct Life {
    paths: Vec<Path>,
    scale: f64,
}

impl Life {
    /// The life that weighted paths tell of, at least one; `scale` is their unit of usage.
    pub fn new(paths: Vec<Path>, scale: f64) -> Self {
        Self { paths, scale }
    }

    /// The probability that the threshold has been passed `elapsed` after `at`. It never falls as `elapsed` grows.
    pub fn passed(&self, elapsed: f64) -> f64 {
        let x = elapsed / self.scale;
        self.paths.iter().map(|path| path.weight * passes(path, x)).sum::<f64>().min(1.0)
    }

    /// The levels (0 healthy, 1 threshold) that stay unexceeded with probability 0.05, 0.5 and 0.95 at each time
    /// `elapsed` after `at`: order statistics of the lines by weight, each taken at evenly spread deviates of its normal law.
    pub fn levels(&self, elapsed: &[f64]) -> Vec<[f64; 3]> {
        let draw =
            |(i, path)| (0..DRAWS).map(move |k| (path, deviate((spread(i, SQRT_2) + k as f64 / DRAWS as f64).fract())));
        let draws: Vec<(&Path, f64)> = self.paths.iter().enumerate().flat_map(draw).collect();
        let at = |elapsed: &f64| {
            let x = elapsed / self.scale;
            let level = |(path, z): &(&Path, f64)| {
                let growth = growth(path, x);
                (path.level + growth + (path.scatter * growth).sqrt() * z, path.weight / DRAWS as f64)
            };
            let mut levels: Vec<(f64, f64)> = draws.iter().map(level).collect();
            levels.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            weighted_quantiles(&levels)
        };
        elapsed.iter().map(at).collect()
    }
}

/// The mean growth of a path from now on over usage `x`.
fn growth(path: &Path, x: f64) -> f64 {
    // A path at its end is followed no further than a life's thousandfold growth.
    (path.rate * (path.shape.at(path.start + x) - path.now)).clamp(0.0, GROWTH_MAX)
}

/// The probability that a path has passed the threshold after usage `x`.
fn passes(path: &Path, x: f64) -> f64 {
    let left = 1.0 - path.level;
    if left <= 0.0 {
        return 1.0;
    }
    match path.law {
        Law::Gamma => gamma_passes(left, growth(path, x), path.scatter),
        _ => wiener_passes(left, growth(path, x), path.scatter),
    }
}

/// The quantiles 0.05, 0.5 and 0.95 of (value, weight) pairs in rising order, whose weights add up to 1.
fn weighted_quantiles(levels: &[(f64, f64)]) -> [f64; 3] {
    let mut sum = 0.0;
    let mut rest = levels.iter();
    let mut value = levels[0].0;
    [0.05, 0.5, 0.95].map(|p| {
        while sum < p {
            let Some(&(next, weight)) = rest.next() else { break };
            value = next;
            sum += weight;
        }
        value
    })
}

/// Where the rising `cdf` reaches `p` between `low` and `high`: false position (Illinois) on the standard normal
/// deviate of the probability, which is nearly straight for what is nearly normal.
pub(super) fn quantile(mut low: f64, mut high: f64, p: f64, cdf: impl Fn(f64) -> f64) -> f64 {
    let target = deviate(p);
    let excess = |x: f64| deviate(cdf(x)) - target;
    let (mut below, mut above) = (excess(low), excess(high));
    if below >= 0.0 {
        return low;
    }
    if above <= 0.0 {
        return high;
    }
    for _ in 0..100 {
        let x = (low + (high - low) * below / (below - above)).clamp(low, high);
        let y = excess(x);
        if y.abs() < DEVIATE_TOLERANCE || high - low <= 1e-12 * high.abs() {
            return x;
        }
        if y < 0.0 {
            (low, below) = (x, y);
            above *= 0.5;
        } else {
            (high, above) = (x, y);
            below *= 0.5;
        }
    }
    0.5 * (low + high)
}
