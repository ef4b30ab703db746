//! First passage: from the lines of a posterior to the probability that the threshold has been passed.

use std::f64::consts::SQRT_2;

use super::line::Line;
use super::normal::{cumulative, deviate, spread};

/// How near a quantile comes, in standard normal deviates.
const DEVIATE_TOLERANCE: f64 = 1e-4;

/// Deviates at which each line's normal law is taken for the band.
const DRAWS: usize = 4;

/// The distribution of one fault's level, from which its life follows.
#[derive(Debug, Clone)]
pub(super) struct Life {
    lines: Vec<Line>,
    scale: f64,
}

impl Life {
    /// The life that weighted lines tell of, at least one; `scale` is their unit of usage.
    pub fn new(lines: Vec<Line>, scale: f64) -> Self {
        Self { lines, scale }
    }

    /// The probability that the threshold has been passed `elapsed` after `at`. It never falls as `elapsed` grows.
    pub fn passed(&self, elapsed: f64) -> f64 {
        let x = elapsed / self.scale;
        self.mean(|line| {
            let now = (line.level - 1.0) / line.variance.sqrt();
            let then = (line.level + line.slope * x - 1.0) / (line.variance + line.wander * x).sqrt();
            // What has been passed stays passed, though the normal law of the wander would take it back.
            cumulative(then.max(now))
        })
    }

    /// The levels (0 healthy, 1 threshold) that stay unexceeded with probability 0.05, 0.5 and 0.95 at each time
    /// `elapsed` after `at`: order statistics of the lines by weight, each taken at evenly spread deviates of its normal law.
    pub fn levels(&self, elapsed: &[f64]) -> Vec<[f64; 3]> {
        let draw =
            |(i, line)| (0..DRAWS).map(move |k| (line, deviate((spread(i, SQRT_2) + k as f64 / DRAWS as f64).fract())));
        let draws: Vec<(&Line, f64)> = self.lines.iter().enumerate().flat_map(draw).collect();
        let at = |elapsed: &f64| {
            let x = elapsed / self.scale;
            let level = |(line, z): &(&Line, f64)| {
                let deviation = (line.variance + line.wander * x).sqrt() * z;
                (line.level + line.slope * x + deviation, line.weight / DRAWS as f64)
            };
            let mut levels: Vec<(f64, f64)> = draws.iter().map(level).collect();
            levels.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            weighted_quantiles(&levels)
        };
        elapsed.iter().map(at).collect()
    }

    fn mean(&self, f: impl Fn(&Line) -> f64) -> f64 {
        self.lines.iter().map(|line| line.weight * f(line)).sum()
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
