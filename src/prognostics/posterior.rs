//! The posterior of the laws, their lives and their noises, on a grid, and the paths that stand for it.
//!
//! All in the units of the question. The equations and the reasons for the priors are in `docs/prognostics.md`.

use super::filter::{Sums, WALKS, filter};
use super::fleet::LifeEvidence;
use super::history::Point;
use super::law::{Law, Shape};
use super::normal::{cumulative, density, deviate, heavy_cumulative, log_density, log_heavy, spread};
use super::prior::ScaledPrior;

/// Bounds of the common noise's standard deviation, threshold distances (chosen: from as good as none to the whole way).
const NOISE: (f64, f64) = (3e-4, 1.0);
/// Cells of the noise in the first look, and then where it matters.
const NOISE_COARSE: usize = 14;
const NOISE_FINE: usize = 5;
/// The fine cells reach as far as the coarse ones that lie this near the best in log-likelihood.
const NOISE_DROP: f64 = 4.0;
/// Bounds of the walk's variance over one scale, squared threshold distances.
const WALK: (f64, f64) = (1e-7, 6e-2);
/// The prior of the noise's standard deviation, threshold distances: heavy-tailed in the logarithm (chosen: an indicator that
/// is worth watching is seen to a few hundredths of the way, three in four within a factor of two).
const NOISE_USUAL: (f64, f64) = (0.02, 0.5);
/// The prior of the walk's variance over the mean growth, threshold distances: heavy-tailed in the logarithm (chosen: a life
/// is some four hundred independent steps, three in four within a factor of two; where use is unsteady or damage comes in
/// bouts it is a few).
const SCATTER: (f64, f64) = (1.0 / 400.0, 0.5);
/// The prior of the exponential's rate times its life: log-normal (chosen: the rate of growth is some twenty times as
/// high at the end as at the beginning).
const RATE: (f64, f64) = (3.0, 0.4);
/// The prior of the power's exponent: log-normal (chosen: damage grows about as the square of usage).
const EXPONENT: (f64, f64) = (2.0, 0.4);
/// Cells of the exponential's rate per scale and their bounds.
const RATES: ((f64, f64), usize) = ((0.02, 8.0), 14);
/// Cells of the power's exponent, in deviates of its prior.
const EXPONENTS: ((f64, f64), usize) = ((-2.0, 2.4), 10);
/// Cells of the life in a first look at each fit, how far they reach in standard deviations of the growth, and the parts that
/// a cell is cut into where the posterior is.
const LIVES: usize = 10;
const REACH: f64 = 5.0;
const PARTS: usize = 4;
/// A cell is where the posterior is within this of the best in the logarithm, or beside one that is.
const NEAR: f64 = 7.0;
/// Bounds of the life, scales.
const LIFE: (f64, f64) = (0.05, 1e3);
/// What lies this far below the best in log-likelihood is left out.
const DROP: f64 = 7.0;
/// How many paths stand for the posterior.
const PATHS: usize = 192;
/// The prior of the level at the start of the life, threshold distances: its standard deviation where the healthy level is
/// known and where it is taken from the history.
const START_KNOWN: f64 = 0.1;
const START_LEARNT: f64 = 0.3;
/// The least distance from the start to the threshold.
const WAY_MIN: f64 = 0.05;

/// A path that the damage may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    pub law: Law,
    pub shape: Shape,
    /// The level now.
    pub level: f64,
    /// Mean growth per unit of the shape.
    pub rate: f64,
    /// The usage now, in scales from the start of the life, and the shape there.
    pub start: f64,
    pub now: f64,
    /// The scatter: variance of the growth over its mean.
    pub scatter: f64,
    /// Its share of the posterior's probability.
    pub weight: f64,
}

/// What is asked of the posterior.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting<'a> {
    /// The usage of the question, in scales from the start of the life.
    pub at: f64,
    /// The prior of the life.
    pub life: &'a ScaledPrior,
    /// The usage of one scale.
    pub scale: f64,
    /// Whether the healthy level is known.
    pub healthy_known: bool,
}

/// The posterior.
pub(super) struct Posterior {
    /// The paths; their weights add up to 1.
    pub paths: Vec<Path>,
    /// The laws and their probabilities.
    pub laws: Vec<(Law, f64)>,
    /// What the history says of the length of the life, prior apart.
    pub evidence: Option<LifeEvidence>,
}

/// The posterior given the points, at least one.
pub(super) fn posterior(points: &[Point], setting: Setting<'_>) -> Posterior {
    let candidates = Grid::new(points, setting).candidates();
    let monotone = monotone(points, &candidates, setting);
    let total: f64 = candidates.iter().map(|c| c.weight).sum();
    let share = |shape: fn(&Shape) -> bool| {
        // A sum of nothing is a negative zero.
        (0.0 + candidates.iter().filter(|c| shape(&c.shape)).map(|c| c.weight).sum::<f64>()) / total
    };
    let linear = share(|s| matches!(s, Shape::Linear));
    let exponential = share(|s| matches!(s, Shape::Exponential { .. }));
    let laws = vec![
        (Law::Wiener, linear * (1.0 - monotone)),
        (Law::Gamma, linear * monotone),
        (Law::Exponential, exponential),
        (Law::Power, (1.0 - linear - exponential).max(0.0)),
    ];
    let lives = candidates.iter().map(|c| (c.life * setting.scale, c.width, c.likelihood));
    Posterior {
        paths: paths(&candidates, setting.at, monotone),
        laws,
        evidence: LifeEvidence::gathered(lives, LIFE.1 * setting.scale),
    }
}

/// A cell of the grid.
#[derive(Clone, Copy)]
struct Candidate {
    shape: Shape,
    now: f64,
    noise: f64,
    /// Prior times likelihood times width, relative to the best.
    weight: f64,
    /// The same without the prior of the life and the width, and the width in the logarithm of the life.
    likelihood: f64,
    width: f64,
    /// The start's level, the growth per unit of the shape.
    start: f64,
    rate: f64,
    scatter: f64,
    /// The life of the mean, scales.
    life: f64,
    /// The level now: mean and variance.
    level: f64,
    variance: f64,
}

struct Grid<'a> {
    points: &'a [Point],
    setting: Setting<'a>,
    start_variance: f64,
    walks: [f64; WALKS],
}

/// One fit: shape, noise and walk.
struct Fit {
    shape: Shape,
    log_prior: f64,
    now: f64,
    noise: f64,
    walk: f64,
    /// How far the walk's cell reaches below and above in the logarithm: the first and the last are open.
    walk_reach: [f64; 2],
    sums: Sums,
    /// The growth per unit of shape over the way to the threshold: the best and its standard deviation.
    pace: (f64, f64),
    best: f64,
}

impl<'a> Grid<'a> {
    fn new(points: &'a [Point], setting: Setting<'a>) -> Self {
        let start = if setting.healthy_known { START_KNOWN } else { START_LEARNT };
        let mut walks = [0.0; WALKS];
        for (walk, value) in walks.iter_mut().zip(logarithmic(WALK, WALKS)) {
            *walk = value;
        }
        Self { points, setting, start_variance: start * start, walks }
    }

    fn candidates(&self) -> Vec<Candidate> {
        let coarse: Vec<Fit> =
            logarithmic(NOISE, NOISE_COARSE).flat_map(|noise| self.fits(Shape::Linear, 0.0, noise)).collect();
        let best = coarse.iter().map(|fit| fit.best + fit.log_prior).fold(f64::NEG_INFINITY, f64::max);
        let near = |fit: &&Fit| fit.best + fit.log_prior > best - NOISE_DROP;
        let width = (NOISE.1 / NOISE.0).powf(0.5 / NOISE_COARSE as f64);
        let low = coarse.iter().filter(near).map(|fit| fit.noise).fold(f64::INFINITY, f64::min) / width;
        let high = coarse.iter().filter(near).map(|fit| fit.noise).fold(0.0, f64::max) * width;
        let noises: Vec<f64> = logarithmic(((low * 0.8).max(NOISE.0), high), NOISE_FINE).collect();
        let mut fits = Vec::with_capacity(20 * NOISE_FINE * WALKS);
        for (shape, log_prior) in self.shapes() {
            for &noise in &noises {
                fits.extend(self.fits(shape, log_prior, noise));
            }
        }
        let best = fits.iter().map(|fit| fit.best + fit.log_prior).fold(f64::NEG_INFINITY, f64::max);
        fits.retain(|fit| fit.best + fit.log_prior > best - DROP);
        let mut candidates = self.lives(&fits);
        // From logarithms to shares of the best.
        let highest = |of: fn(&Candidate) -> f64| candidates.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        let (weight, likelihood) = (highest(|c| c.weight), highest(|c| c.likelihood));
        candidates.retain(|c| c.weight > weight - 2.0 * DROP || c.likelihood > likelihood - DROP);
        for c in &mut candidates {
            (c.weight, c.likelihood) = ((c.weight - weight).exp(), (c.likelihood - likelihood).exp());
        }
        candidates
    }

    /// The shapes with the logarithms of their priors. That of the exponential's rate depends on the life and is counted there.
    fn shapes(&self) -> Vec<(Shape, f64)> {
        let ((low, high), n) = RATES;
        let mut shapes = vec![(Shape::Linear, 0.0)];
        shapes.extend(logarithmic((low, high), n).map(|rate| (Shape::exponential(rate), 0.0)));
        let ((low, high), n) = EXPONENTS;
        let width = (high - low) / n as f64;
        shapes.extend((0..n).map(|i| {
            let z = low + (i as f64 + 0.5) * width;
            let exponent = EXPONENT.0 * (EXPONENT.1 * z).exp();
            (Shape::Power { exponent }, (width * EXPONENT.1).ln() + log_density(z, EXPONENT.1))
        }));
        shapes
    }

    fn fits(&self, shape: Shape, log_prior: f64, noise: f64) -> impl Iterator<Item = Fit> {
        let at = self.setting.at;
        let growth: Vec<f64> =
            self.points.iter().map(|p| shape.at(p.usage)).chain(std::iter::once(shape.at(at))).collect();
        let now = growth[self.points.len()];
        let sums = filter(self.points, &growth, noise * noise, &self.walks);
        let log_prior = log_prior + log_heavy((noise / NOISE_USUAL.0).ln() / NOISE_USUAL.1, NOISE_USUAL.1);
        let half = 0.5 * (WALK.1 / WALK.0).ln() / WALKS as f64;
        let reach = move |open: bool| if open { f64::INFINITY } else { half };
        (0..WALKS).map(move |k| {
            let (pace, best) = self.pace(&sums[k]);
            let walk_reach = [reach(k == 0), reach(k + 1 == WALKS)];
            Fit { shape, log_prior, now, noise, walk: self.walks[k], walk_reach, sums: sums[k], pace, best }
        })
    }

    /// The best growth per unit of shape over the way, its standard deviation, and the log-likelihood there.
    fn pace(&self, s: &Sums) -> ((f64, f64), f64) {
        let one = s.one + 1.0 / self.start_variance;
        let determinant = (one * s.gg - s.og * s.og).max(1e-12 * one * (s.gg + 1e-6));
        let rate = (one * s.yg - s.og * s.y1) / determinant;
        let start = (s.gg * s.y1 - s.og * s.yg) / determinant;
        let way = (1.0 - start).max(WAY_MIN);
        let pace = rate / way;
        // By the delta method, with what a start nearer the threshold does to the pace.
        let variance = (one - 2.0 * pace * s.og + pace * pace * s.gg).max(0.0) / determinant / (way * way);
        let bounded = pace.clamp(1e-9, 1e9);
        ((pace, variance.sqrt().max(1e-9)), self.given(s, bounded).0)
    }

    /// The log-likelihood of a pace with the start integrated out, and the start's mean and variance.
    fn given(&self, s: &Sums, pace: f64) -> (f64, f64, f64) {
        let yy = s.yy - 2.0 * pace * s.yg + pace * pace * s.gg;
        let y1 = s.y1 - pace * (s.yg + s.og) + pace * pace * s.gg;
        let one = s.one - 2.0 * pace * s.og + pace * pace * s.gg + 1.0 / self.start_variance;
        let start = y1 / one;
        let twice = yy - start * y1 + s.log_determinant + (one * self.start_variance).ln();
        (-0.5 * twice, start, 1.0 / one)
    }

    /// The cells of the life in each fit: a first look at a few, and those near the best, and beside these, in parts.
    fn lives(&self, fits: &[Fit]) -> Vec<Candidate> {
        let looks: Vec<[Candidate; LIVES]> = fits
            .iter()
            .map(|fit| {
                let (short, width) = self.reach(fit);
                std::array::from_fn(|i| self.candidate(fit, short * (width * (i as f64 + 0.5)).exp(), width))
            })
            .collect();
        let best = looks.iter().flatten().map(|c| c.weight).fold(f64::NEG_INFINITY, f64::max);
        let mut candidates = Vec::with_capacity(looks.len() * LIVES);
        for (fit, look) in fits.iter().zip(&looks) {
            for (i, c) in look.iter().enumerate() {
                let about = &look[i.saturating_sub(1)..(i + 2).min(LIVES)];
                if about.iter().any(|c| c.weight > best - NEAR) {
                    let part = |k: usize| (c.width * ((k as f64 + 0.5) / PARTS as f64 - 0.5)).exp();
                    let width = c.width / PARTS as f64;
                    candidates.extend((0..PARTS).map(|k| self.candidate(fit, c.life * part(k), width)));
                } else {
                    candidates.push(*c);
                }
            }
        }
        candidates
    }

    /// The shortest life that a fit reaches to, and the width of a cell in the logarithm.
    fn reach(&self, fit: &Fit) -> (f64, f64) {
        let (pace, deviation) = fit.pace;
        let (slowest, fastest) = (1.0 / fit.shape.at(LIFE.1), 1.0 / fit.shape.at(LIFE.0));
        let low = (pace - REACH * deviation).clamp(slowest, fastest);
        let high = (pace + REACH * deviation).clamp(slowest, fastest);
        let long = fit.shape.reaches(1.0 / low).min(LIFE.1);
        let short = fit.shape.reaches(1.0 / high).max(LIFE.0);
        (short, (long / short).ln().max(1e-9) / LIVES as f64)
    }

    /// The cell of a fit about a life; its weights are logarithms.
    fn candidate(&self, fit: &Fit, life: f64, width: f64) -> Candidate {
        let pace = 1.0 / fit.shape.at(life);
        let (log_likelihood, start, start_variance) = self.given(&fit.sums, pace);
        // A start at the threshold or beyond still grows, so that every history has a cell.
        let rate = pace * (1.0 - start).max(WAY_MIN);
        // The whole prior of the scatter in the walk's cell, so that the cells of any life share out all of it.
        let [below, above] = fit.walk_reach;
        let scatter = (fit.walk / rate).min(if below.is_finite() { f64::INFINITY } else { SCATTER.0 });
        let middle = (fit.walk / rate / SCATTER.0).ln();
        let share = heavy_cumulative((middle + above) / SCATTER.1) - heavy_cumulative((middle - below) / SCATTER.1);
        let mut likelihood = log_likelihood + fit.log_prior + share.max(f64::MIN_POSITIVE).ln();
        if let Shape::Exponential { rate, .. } = fit.shape {
            likelihood += rate_share(rate, life).max(f64::MIN_POSITIVE).ln();
        }
        let [wy, w1, wg] = fit.sums.walk;
        let by_start = 1.0 - pace * fit.now - w1 + pace * wg;
        Candidate {
            shape: fit.shape,
            now: fit.now,
            noise: fit.noise,
            weight: likelihood + width.ln() + self.setting.life.log_density(life),
            likelihood,
            width,
            start,
            rate,
            scatter,
            life,
            level: pace * fit.now + wy - pace * wg + start * by_start,
            variance: fit.sums.walk_variance + by_start * by_start * start_variance,
        }
    }
}

/// The share of the prior of the exponential's rate in the cell of one: the first and the last are open, so that the cells of any
/// life share out all of it.
fn rate_share(rate: f64, life: f64) -> f64 {
    let ((low, high), n) = RATES;
    let width = (high / low).ln() / n as f64;
    let middle = (rate * life / RATE.0).ln();
    if rate < low * width.exp() {
        return cumulative((middle + 0.5 * width) / RATE.1);
    }
    if rate > high * (-width).exp() {
        return cumulative((0.5 * width - middle) / RATE.1);
    }
    width * density(middle / RATE.1) / RATE.1
}

/// The midpoints of `n` cells of equal width in logarithm.
fn logarithmic((low, high): (f64, f64), n: usize) -> impl Iterator<Item = f64> {
    let step = (high / low).ln() / n as f64;
    (0..n).map(move |i| low * ((i as f64 + 0.5) * step).exp())
}

/// The probability of the gamma process among those of steady growth: equal before, then by the third moment of the
/// innovations, which is a gamma process's own, at the best steady cell (Gram and Charlier's first term).
fn monotone(points: &[Point], candidates: &[Candidate], setting: Setting<'_>) -> f64 {
    let steady = candidates.iter().filter(|c| c.shape == Shape::Linear);
    let Some(best) = steady.max_by(|a, b| a.weight.total_cmp(&b.weight)) else { return 0.5 };
    let (mut level, mut variance, mut before, mut log_odds) = (best.start, 0.0, 0.0, 0.0);
    for point in points.iter().filter(|p| p.usage <= setting.at) {
        let growth = best.rate * (point.usage - before).max(0.0);
        before = point.usage;
        let prior = variance + best.scatter * growth;
        let total = prior + point.variance + best.noise * best.noise;
        let error = point.value - level - growth;
        let skewness = 2.0 * best.scatter * best.scatter * growth / total.powf(1.5);
        let z = error / total.sqrt();
        log_odds += (1.0 + skewness / 6.0 * z * (z * z - 3.0)).max(0.1).ln();
        let gain = prior / total;
        level += growth + gain * error;
        variance = prior * (1.0 - gain);
    }
    1.0 / (1.0 + (-log_odds).exp())
}

/// Systematic selection, denser among short remaining lives, which small risks are made of; each path gets its level at an
/// evenly spread deviate.
fn paths(candidates: &[Candidate], at: f64, monotone: f64) -> Vec<Path> {
    let boost = |c: &Candidate| 1.0 + 1.0 / (0.02 + (c.life - at).max(0.0));
    let total: f64 = candidates.iter().map(|c| c.weight * boost(c)).sum();
    let step = total / PATHS as f64;
    let mut paths: Vec<Path> = Vec::with_capacity(PATHS);
    let (mut sum, mut weights) = (0.0, 0.0);
    let mut ordered: Vec<&Candidate> = candidates.iter().collect();
    ordered.sort_by(|a, b| a.life.total_cmp(&b.life));
    for c in ordered {
        let boost = boost(c);
        sum += c.weight * boost;
        while paths.len() < PATHS && (paths.len() as f64 + 0.5) * step <= sum {
            let i = paths.len();
            let law = match c.shape {
                Shape::Linear if spread(i, std::f64::consts::SQRT_2) < monotone => Law::Gamma,
                Shape::Linear => Law::Wiener,
                Shape::Exponential { .. } => Law::Exponential,
                Shape::Power { .. } => Law::Power,
            };
            let level = c.level + c.variance.sqrt() * deviate(spread(i, std::f64::consts::GOLDEN_RATIO));
            let weight = 1.0 / boost;
            weights += weight;
            paths.push(Path {
                law,
                shape: c.shape,
                level,
                rate: c.rate,
                start: at,
                now: c.now,
                scatter: c.scatter,
                weight,
            });
        }
    }
    paths.iter_mut().for_each(|path| path.weight /= weights);
    paths
}
