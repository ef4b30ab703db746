//! The likelihood of a history under one shape of growth, as the sums of a generalised least squares.
//!
//! `value = a (1 - shape/end) + shape/end + walk + noise`: the walk is a random walk from 0 at the start of the life, its variance
//! in proportion to the shape; the noise is independent, its variance each observation's own plus a common one.

use super::history::Point;

/// Walks that are filtered at once.
pub(super) const WALKS: usize = 8;

/// The sums of squares and products of the innovations of values, ones and shape, the logarithm of the determinant, and
/// the walk at the end.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    /// Values by values, values by ones, values by shape, ones by ones, ones by shape, shape by shape.
    pub yy: f64,
    pub y1: f64,
    pub yg: f64,
    pub one: f64,
    pub og: f64,
    pub gg: f64,
    pub log_determinant: f64,
    /// The walk that the filter sees in values, ones and shape.
    pub walk: [f64; 3],
    /// The walk's variance given all observations.
    pub walk_variance: f64,
}

/// Filters the points once for each walk variance (per unit of shape). `shape` holds the shape at each point and, last, at the
/// question.
pub(super) fn filter(points: &[Point], shape: &[f64], noise: f64, walks: &[f64; WALKS]) -> [Sums; WALKS] {
    let mut state = [[0.0; WALKS]; 3];
    let mut variance = [0.0; WALKS];
    let mut sums = [[0.0; WALKS]; 6];
    let mut determinant = [1.0; WALKS];
    let mut log_determinant = [0.0; WALKS];
    let mut before = 0.0;
    for (i, (point, &g)) in points.iter().zip(shape).enumerate() {
        let grown = (g - before).max(0.0);
        before = g;
        let [y, noise] = [point.value, point.variance + noise];
        for k in 0..WALKS {
            let prior = variance[k] + walks[k] * grown + point.jump;
            let total = 1.0 / (prior + noise);
            let gain = prior * total;
            variance[k] = gain * noise;
            determinant[k] *= total;
            let e = [y - state[0][k], 1.0 - state[1][k], g - state[2][k]];
            for (channel, e) in state.iter_mut().zip(e) {
                channel[k] += gain * e;
            }
            let t = e.map(|e| e * total);
            sums[0][k] += e[0] * t[0];
            sums[1][k] += e[0] * t[1];
            sums[2][k] += e[0] * t[2];
            sums[3][k] += e[1] * t[1];
            sums[4][k] += e[1] * t[2];
            sums[5][k] += e[2] * t[2];
        }
        // Sixteen factors stay far from the ends of the range of a number.
        if i % 16 == 15 || i + 1 == points.len() {
            for k in 0..WALKS {
                log_determinant[k] -= determinant[k].ln();
                determinant[k] = 1.0;
            }
        }
    }
    let to_go = (shape[points.len()] - before).max(0.0);
    std::array::from_fn(|k| Sums {
        yy: sums[0][k],
        y1: sums[1][k],
        yg: sums[2][k],
        one: sums[3][k],
        og: sums[4][k],
        gg: sums[5][k],
        log_determinant: log_determinant[k],
        walk: [state[0][k], state[1][k], state[2][k]],
        walk_variance: variance[k] + walks[k] * to_go,
    })
}
