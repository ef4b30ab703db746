//! Fleet learning: what the lives of others, and a part's own earlier ones, say of a life, by a hierarchical model.
//!
//! The logarithm of a life is normal about the median of its actuator, and those medians are normal about that of the type. The
//! type's median and spread are integrated out. Each actuator says what it knows of them by one likelihood, in integers, so that
//! a fleet of any size is one sum, the same in whatever order it was made. `docs/prognostics.md` has the equations.

use super::prior::watched;

/// Stands for this model wherever its tallies are kept: tallies of another one do not add up with these.
pub const FLEET_MODEL: u32 = 1;

/// The lives that a likelihood is kept for, in usage: cells of equal width in logarithm.
const LIVES: (f64, f64) = (1.0, 1e7);
const CELLS: usize = 128;
/// The spreads of the logarithm of the lives of a type that are considered.
const SPREADS: [f64; 6] = [0.12, 0.2, 0.33, 0.55, 0.9, 1.5];
/// The standard deviation of the half-normal prior of the spread (chosen: lives of one type are mostly within a factor of three).
const SPREAD: f64 = 0.5;
/// The share of the variance that belongs to the actuator, its place and its use; the rest is each life's own (chosen: as much
/// of the one as of the other).
const OF_ACTUATOR: f64 = 0.5;
/// The share of the prior that stays with the age alone: a part may be unlike its fleet.
const UNLIKE: f64 = 0.1;
/// No life counts for less than this share of its best cell: its history may be wrong.
const FLOOR: f64 = 1e-4;
/// Steps of a tally per unit of the logarithm.
const STEPS: f64 = 65_536.0;

fn cell_width() -> f64 {
    (LIVES.1 / LIVES.0).ln() / CELLS as f64
}

/// What a history says of the length of its life, prior apart.
#[derive(Debug, Clone, PartialEq)]
pub struct LifeEvidence {
    /// The likelihood in each cell over that of the best one.
    likelihood: Vec<f64>,
}

impl LifeEvidence {
    /// Gathers (life in usage, width in logarithm, likelihood) of the cells of a posterior, which considers no life beyond
    /// `longest`: what lies beyond is as likely as what lies just before.
    pub(super) fn gathered(parts: impl Iterator<Item = (f64, f64, f64)>, longest: f64) -> Option<Self> {
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
        let beyond = ((longest / LIVES.0).ln() / width).clamp(0.0, CELLS as f64) as usize;
        if (1..CELLS).contains(&beyond) {
            let last = sums[beyond - 1];
            sums[beyond..].fill(last);
        }
        let best = sums.iter().copied().fold(0.0, f64::max);
        (best > 0.0).then(|| Self { likelihood: sums.iter().map(|sum| (sum / best).max(FLOOR)).collect() })
    }
}

/// What the lives of one actuator say of its type: the logarithm of the likelihood of every spread and median of the type over
/// that of the likeliest, in steps of 2^-16. The tallies of a fleet's actuators are added up. None without a life.
#[must_use]
pub fn tally(lives: &[LifeEvidence]) -> Option<Vec<i32>> {
    if lives.is_empty() {
        return None;
    }
    let logs: Vec<f64> = SPREADS.iter().flat_map(|&spread| Kernels::of(spread).of_type(lives)).collect();
    let best = highest(&logs);
    Some(logs.iter().map(|log| ((log - best) * STEPS).round() as i32).collect())
}

/// The lives of a fleet, as a prior.
#[derive(Debug, Clone, PartialEq)]
pub struct Fleet {
    /// The sum of the others' tallies; empty without others.
    others: Vec<i64>,
    /// The earlier lives of the same actuator.
    earlier: Vec<LifeEvidence>,
}

impl Fleet {
    /// What the tallies of the other actuators, added up, and the earlier lives of the same one promise; none where there is
    /// neither.
    ///
    /// # Panics
    /// When `others` is neither empty nor a sum of what [`tally`] makes.
    #[must_use]
    pub fn new(others: &[i64], earlier: &[LifeEvidence]) -> Option<Self> {
        assert!([0, SPREADS.len() * CELLS].contains(&others.len()), "a tally of {} numbers", others.len());
        let known = !others.is_empty() || !earlier.is_empty();
        known.then(|| Self { others: others.to_vec(), earlier: earlier.to_vec() })
    }

    /// The prior of a life of a part whose age is `scale`, in usage.
    pub(super) fn prior(&self, scale: f64) -> FleetPrior {
        let width = cell_width();
        let life = |cell: usize| LIVES.0 * ((cell as f64 + 0.5) * width).exp();
        let told = |kind: usize| self.others.get(kind).map_or(0.0, |&sum| sum as f64 / STEPS);
        let of_type = SPREADS.iter().enumerate().flat_map(|(i, spread)| {
            let prior = spread.ln() - 0.5 * (spread / SPREAD).powi(2);
            (0..CELLS).map(move |cell| prior + watched(life(cell) / scale) + told(i * CELLS + cell))
        });
        let of_type = relative(&of_type.collect::<Vec<_>>());
        let kernels = SPREADS.map(Kernels::of);
        let of_actuator = kernels.iter().flat_map(|kernels| kernels.of_actuator(&self.earlier));
        let of_actuator = relative(&of_actuator.collect::<Vec<_>>());
        let mut density = vec![0.0; CELLS];
        let of_spreads = of_type.chunks_exact(CELLS).zip(of_actuator.chunks_exact(CELLS));
        for (kernels, (of_type, of_actuator)) in kernels.iter().zip(of_spreads) {
            let mut median = smoothed(&kernels.between, of_type);
            median.iter_mut().zip(of_actuator).for_each(|(m, told)| *m *= told);
            let lives = smoothed(&kernels.within, &median);
            density.iter_mut().zip(lives).for_each(|(d, life)| *d += life);
        }
        let total: f64 = density.iter().sum();
        density.iter_mut().for_each(|d| *d /= total * width);
        FleetPrior { density }
    }
}

/// The prior of a life by its fleet, as it was when a forecast was made.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetPrior {
    /// The density of the logarithm of the life in each cell.
    density: Vec<f64>,
}

impl FleetPrior {
    /// A prior that was kept as its density; none of another number of cells.
    #[must_use]
    pub fn of_density(density: Vec<f64>) -> Option<Self> {
        (density.len() == CELLS).then_some(Self { density })
    }

    /// The density of the logarithm of the life, in 128 cells from 1 to 10^7 of usage.
    #[must_use]
    pub fn density(&self) -> &[f64] {
        &self.density
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

/// The normal laws of a spread, by the distance of two cells: of a life about its actuator's median, and of this about the type's.
struct Kernels {
    within: Vec<f64>,
    between: Vec<f64>,
}

impl Kernels {
    fn of(spread: f64) -> Self {
        let kernel = |share: f64| {
            let deviation = spread * share.sqrt() / cell_width();
            let at = |i: usize| (-0.5 * ((i as f64 - (CELLS as f64 - 1.0)) / deviation).powi(2)).exp();
            let raw: Vec<f64> = (0..2 * CELLS - 1).map(at).collect();
            let total: f64 = raw.iter().sum();
            raw.iter().map(|value| value / total).collect()
        };
        Self { within: kernel(1.0 - OF_ACTUATOR), between: kernel(OF_ACTUATOR) }
    }

    /// The logarithm of the likelihood of every median of an actuator with these lives.
    fn of_actuator(&self, lives: &[LifeEvidence]) -> Vec<f64> {
        let mut logs = vec![0.0; CELLS];
        for life in lives {
            let told = smoothed(&self.within, &life.likelihood);
            logs.iter_mut().zip(told).for_each(|(log, told)| *log += told.max(f64::MIN_POSITIVE).ln());
        }
        logs
    }

    /// The logarithm of the likelihood of every median of the type.
    fn of_type(&self, lives: &[LifeEvidence]) -> Vec<f64> {
        let logs = self.of_actuator(lives);
        let medians = smoothed(&self.between, &relative(&logs));
        let best = highest(&logs);
        medians.iter().map(|sum| sum.max(f64::MIN_POSITIVE).ln() + best).collect()
    }
}

fn highest(logs: &[f64]) -> f64 {
    logs.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// From logarithms to shares of the best.
fn relative(logs: &[f64]) -> Vec<f64> {
    let best = highest(logs);
    logs.iter().map(|log| (log - best).exp()).collect()
}

/// The sums over all cells, each weighed by its distance; what lies outside is left out.
fn smoothed(kernel: &[f64], cells: &[f64]) -> Vec<f64> {
    let weighed = |cell: usize| kernel[CELLS - 1 - cell..].iter().zip(cells).map(|(k, value)| k * value).sum();
    (0..CELLS).map(weighed).collect()
}
