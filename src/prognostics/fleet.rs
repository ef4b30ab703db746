//! Fleet learning: what the lives of others say of a life, by a hierarchical model.
//!
//! The lives of one type are log-normal about a median that the type has, with a spread that the type has. Each life, ended or
//! not, says what it knows of its own length by a likelihood; median and spread, with weak priors, are integrated out.

use serde::{Deserialize, Serialize};

/// The lives that a likelihood is kept for, in usage: cells of equal width in logarithm.
const LIVES: (f64, f64) = (1e1, 1e6);
const CELLS: usize = 96;
/// The spreads of the logarithm of the lives that are considered.
const SPREADS: [f64; 8] = [0.08, 0.12, 0.18, 0.27, 0.4, 0.6, 0.9, 1.35];
/// The standard deviation of the half-normal prior of the spread (chosen: lives of one type are mostly within a factor of three).
const SPREAD: f64 = 0.5;
/// The share of the prior that stays with the age alone: a part may be unlike its fleet.
const UNLIKE: f64 = 0.1;
/// No life counts for less than this share of its best cell: its history may be wrong.
const FLOOR: f64 = 1e-4;

fn cell_width() -> f64 {
    (LIVES.1 / LIVES.0).ln() / CELLS as f64
}

/// What a history says of the length of its life, prior apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LifeEvidence {
    /// The likelihood in each cell over that of the best one.
    likelihood: Vec<f64>,
}

impl LifeEvidence {
    /// Gathers (life in usage, width in logarithm, likelihood) of the cells of a posterior.
    pub(super) fn gathered(parts: impl Iterator<Item = (f64, f64, f64)>) -> Option<Self> {
        let width = cell_width();
        let mut sums = vec![0.0; CELLS];
        for (life, across, likelihood) in parts {
            let low = ((life / LIVES.0).ln() - 0.5 * across) / width;
            let high = low + across / width;
            let cells = low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(CELLS);
            for cell in cells {
                let overlap = high.min(cell as f64 + 1.0) - low.max(cell as f64);
                sums[cell] += likelihood * overlap.max(0.0) * width;
            }
        }
        let best = sums.iter().copied().fold(0.0, f64::max);
        (best > 0.0).then(|| Self { likelihood: sums.iter().map(|sum| sum / best).collect() })
    }
}

/// The lives of a type, as a prior.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// The density of the logarithm of the life in each cell.
    density: Vec<f64>,
    /// How many lives it rests on.
    pub lives: usize,
}

impl Fleet {
    /// What the lives of others promise; none without a life.
    #[must_use]
    pub fn of(lives: &[LifeEvidence]) -> Option<Self> {
        let lives: Vec<_> = lives.iter().filter(|life| life.likelihood.len() == CELLS).collect();
        if lives.is_empty() {
            return None;
        }
        let width = cell_width();
        let mut kinds = Vec::with_capacity(SPREADS.len() * CELLS);
        for spread in SPREADS {
            for median in 0..CELLS {
                let kernel = kernel(median, spread / width);
                let known = |life: &&LifeEvidence| {
                    let expected: f64 = kernel.iter().zip(&life.likelihood).map(|(k, l)| k * (l + FLOOR)).sum();
                    expected.max(f64::MIN_POSITIVE).ln()
                };
                let prior = (spread / SPREAD).powi(2) * -0.5 + spread.ln();
                kinds.push((prior + lives.iter().map(known).sum::<f64>(), kernel));
            }
        }
        let best = kinds.iter().map(|kind| kind.0).fold(f64::NEG_INFINITY, f64::max);
        let mut density = vec![0.0; CELLS];
        let mut total = 0.0;
        for (log, kernel) in kinds.iter().filter(|kind| kind.0 > best - 20.0) {
            let weight = (log - best).exp();
            total += weight;
            density.iter_mut().zip(kernel).for_each(|(d, k)| *d += weight * k);
        }
        density.iter_mut().for_each(|d| *d /= total * width);
        Some(Self { density, lives: lives.len() })
    }

    /// The logarithm of the density at a life, in usage, beside that of the age alone.
    pub(super) fn log_density(&self, life: f64, age_alone: f64) -> f64 {
        let place = ((life / LIVES.0).ln() / cell_width() - 0.5).clamp(0.0, CELLS as f64 - 1.0);
        let cell = (place as usize).min(CELLS - 2);
        let part = place - cell as f64;
        let fleet = self.density[cell] * (1.0 - part) + self.density[cell + 1] * part;
        ((1.0 - UNLIKE) * fleet + UNLIKE * age_alone.exp()).ln()
    }
}

/// The shares of the cells in a normal law about the middle of cell `median`; what lies outside is left out.
fn kernel(median: usize, spread: f64) -> Vec<f64> {
    let at =
        |cell: usize| (-0.5 * ((cell as f64 - median as f64) / spread).powi(2)).exp() / (spread * 2.506_628_274_631);
    (0..CELLS).map(at).collect()
}
