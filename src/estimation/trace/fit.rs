//! The fit of the corrected monitoring model to a trace: weighted least squares by Gauss and Newton, within the faults' ranges.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::observed::{Observations, Observed};
use super::runs::{Runs, Shown};
use super::surface::{Surface, spacing};
use crate::estimation::request::Fault;
use crate::models::fault::Faults;

/// The part of a channel's scale that the corrected model is not trusted in, bin by bin.
const TRUST: f64 = 0.002;
/// Rounds of the least-squares fit on one surface.
const ROUNDS_MAX: usize = 12;
/// A step of this part of the levels' spacing ends the rounds.
const STEP_MIN: f64 = 1e-4;
/// The part of the spacing over which the monitoring model's slopes are taken.
const SLOPE_PART: f64 = 0.25;
/// Residuals of so many standard deviations count half.
const CAUCHY: f64 = 3.0;
/// The time over which residuals are taken to be correlated, s.
const BLOCK_S: f64 = 0.25;

/// A fitted candidate with what is left of the trace.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The candidate.
    pub faults: Faults,
    /// Whether each fault that varies stays where it is on a surface that is learnt around it.
    pub settled: Vec<bool>,
    /// The covariance of the faults that vary, in their order.
    pub covariance: DMatrix<f64>,
    /// Observed minus modelled, by channel of the observations, bin by bin.
    pub residuals: Vec<Vec<f64>>,
    /// The variance that the residuals were expected to have, as they are; zero where they tell nothing.
    pub expected: Vec<Vec<f64>>,
    /// The weighted mean of the squared residuals.
    pub cost: f64,
}

/// Weights of the squared residuals, by channel of the observations, bin by bin.
#[must_use]
pub fn weights(channels: &[Observed], surface: Option<&Surface>, trust: f64) -> Vec<Vec<f64>> {
    channels
        .iter()
        .map(|channel| {
            let known = channel.noise.hypot(trust * channel.scale);
            let spread = |bin: usize| surface.map_or(0.0, |surface| surface.spread[channel.place][bin]);
            let variance = |bin: usize| known * known + spread(bin).powi(2) + channel.moved[bin].powi(2);
            (0..channel.values.len())
                .map(|bin| if channel.informative[bin] { variance(bin).recip() } else { 0.0 })
                .collect()
        })
        .collect()
}

/// Fits the faults that vary, from a start.
#[must_use]
pub fn fit(
    start: &Faults,
    faults: &[Fault],
    runs: &Runs<'_>,
    observations: &Observations,
    surface: &Surface,
) -> Option<Fitted> {
    let known = weights(&observations.channels, Some(surface), TRUST);
    let mut at = *start;
    for _ in 0..ROUNDS_MAX {
        let local = Local::at(&at, faults, runs, observations, surface);
        let (normal, gradient) = local.normal(&robust(&local.residuals, &known));
        let step = solve_within(&normal, &gradient, &at, faults)?;
        let mut largest: f64 = 0.0;
        for (fault, step) in faults.iter().zip(step.iter()) {
            let width = spacing(*fault, fault.of(&at));
            // The surface holds near its levels only.
            let step = step.clamp(-4.0 * width, 4.0 * width);
            let (low, high) = fault.range();
            let value = (fault.of(&at) + step).clamp(low, high);
            largest = largest.max((value - fault.of(&at)).abs() / width);
            *fault.of_mut(&mut at) = value;
        }
        if largest < STEP_MIN {
            break;
        }
    }
    let local = Local::at(&at, faults, runs, observations, surface);
    let covariance = local.covariance(&robust(&local.residuals, &known), observations, surface)?;
    let cost = local.cost(&known);
    let expected = known.iter().map(|channel| channel.iter().map(|w| if *w > 0.0 { w.recip() } else { 0.0 }).collect());
    cost.is_finite().then_some(Fitted {
        faults: at,
        settled: vec![false; faults.len()],
        covariance,
        expected: expected.collect(),
        residuals: local.residuals,
        cost,
    })
}

/// The step of least squares; a fault on its bound that would leave its range is held there.
fn solve_within(normal: &DMatrix<f64>, gradient: &DVector<f64>, at: &Faults, faults: &[Fault]) -> Option<DVector<f64>> {
    let mut free: Vec<usize> = (0..faults.len()).collect();
    loop {
        let part = normal.select_rows(&free).select_columns(&free);
        let solved = part.lu().solve(&gradient.select_rows(&free))?;
        let leaves = |place: usize| {
            let (low, high) = faults[free[place]].range();
            let value = faults[free[place]].of(at);
            (value <= low && solved[place] < 0.0) || (value >= high && solved[place] > 0.0)
        };
        match (0..free.len()).find(|place| leaves(*place)) {
            Some(place) => {
                free.remove(place);
                if free.is_empty() {
                    return Some(DVector::zeros(faults.len()));
                }
            }
            None => {
                let mut step = DVector::zeros(faults.len());
                for (place, fault) in free.iter().enumerate() {
                    step[*fault] = solved[place];
                }
                return Some(step);
            }
        }
    }
}

/// The corrected model about a candidate.
struct Local {
    /// By channel of the observations, bin by bin.
    residuals: Vec<Vec<f64>>,
    /// By fault, then as the residuals: what the model shows more per unit of the fault.
    slopes: Vec<Vec<Vec<f64>>>,
}

impl Local {
    fn at(at: &Faults, faults: &[Fault], runs: &Runs<'_>, observations: &Observations, surface: &Surface) -> Self {
        let mut levels = vec![*at];
        for fault in faults {
            let (low, high) = fault.range();
            let width = SLOPE_PART * spacing(*fault, fault.of(at));
            for side in [-1.0, 1.0] {
                let mut level = *at;
                *fault.of_mut(&mut level) = (fault.of(at) + side * width).clamp(low, high);
                levels.push(level);
            }
        }
        let mut shown: Vec<Shown> = runs.shown(&levels);
        for (level, shown) in levels.iter().zip(&mut shown) {
            *shown = std::array::from_fn(|place| observations.means(&shown[place]));
            surface.correct(level, shown);
        }
        let by_channel = |of: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            let places = observations.channels.iter().map(|channel| channel.place);
            places.map(|place| (0..observations.blocks()).map(|bin| of(place, bin)).collect()).collect()
        };
        let residuals = observations
            .channels
            .iter()
            .map(|channel| channel.values.iter().zip(&shown[0][channel.place]).map(|(y, m)| y - m).collect())
            .collect();
        let slopes = faults.iter().enumerate().map(|(i, fault)| {
            let (low, high) = (&shown[1 + 2 * i], &shown[2 + 2 * i]);
            let apart = fault.of(&levels[2 + 2 * i]) - fault.of(&levels[1 + 2 * i]);
            by_channel(&|place, bin| (high[place][bin] - low[place][bin]) / apart)
        });
        Self { residuals, slopes: slopes.collect() }
    }

    fn cost(&self, weights: &[Vec<f64>]) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (residuals, weights) in self.residuals.iter().zip(weights) {
            for (r, w) in residuals.iter().zip(weights) {
                sum += w * r * r;
                count += f64::from(u8::from(*w > 0.0));
            }
        }
        sum / count
    }

    /// The normal equations' matrix and right side.
    fn normal(&self, weights: &[Vec<f64>]) -> (DMatrix<f64>, DVector<f64>) {
        let n = self.slopes.len();
        let mut normal = DMatrix::zeros(n, n);
        for (i, one) in self.slopes.iter().enumerate() {
            for (j, other) in self.slopes.iter().enumerate().take(i + 1) {
                let products = one.iter().zip(other).zip(weights).flat_map(|((one, other), weights)| {
                    one.iter().zip(other).zip(weights).map(|((one, other), w)| w * one * other)
                });
                normal[(i, j)] = products.sum();
                normal[(j, i)] = normal[(i, j)];
            }
        }
        (normal, self.score(&self.residuals, weights, 0..usize::MAX))
    }

    /// What a difference, by channel and bin, adds to the right side of the normal equations in some bins.
    fn score(&self, off: &[Vec<f64>], weights: &[Vec<f64>], bins: Range<usize>) -> DVector<f64> {
        let mut score = DVector::zeros(self.slopes.len());
        for (channel, (off, weights)) in off.iter().zip(weights).enumerate() {
            for (bin, (off, w)) in off.iter().zip(weights).enumerate().take(bins.end).skip(bins.start) {
                for (i, slopes) in self.slopes.iter().enumerate() {
                    score[i] += off * w * slopes[channel][bin];
                }
            }
        }
        score
    }

    /// What a difference moves the faults by, its outliers lowered as those of the residuals are.
    fn moved(&self, inverse: &DMatrix<f64>, off: &[Vec<f64>], weights: &[Vec<f64>]) -> DVector<f64> {
        inverse * self.score(off, &robust(off, weights), 0..usize::MAX)
    }

    /// The covariance of the faults, from the curvature and from the residuals as they are: correlated within blocks of time, and across
    /// channels; then what noise inside the loop and the surface's own error do to the faults.
    fn covariance(&self, weights: &[Vec<f64>], observations: &Observations, surface: &Surface) -> Option<DMatrix<f64>> {
        let n = self.slopes.len();
        let inverse = self.normal(weights).0.try_inverse()?;
        let block = (BLOCK_S / observations.block_s()).ceil() as usize;
        let mut scatter = DMatrix::<f64>::zeros(n, n);
        let mut blocks = 0.0;
        for from in (0..observations.blocks()).step_by(block) {
            let score = self.score(&self.residuals, weights, from..from + block);
            let told = weights.iter().any(|weights| weights.iter().take(from + block).skip(from).any(|w| *w > 0.0));
            blocks += f64::from(u8::from(told));
            scatter += &score * score.transpose();
        }
        // As many residuals as faults were fitted away.
        let free = (blocks / (blocks - n as f64).max(1.0)).max(1.0);
        let mut covariance = &inverse * scatter * &inverse * free;
        self.widen(&mut covariance, &inverse, weights, observations);
        for error in &surface.errors {
            let off: Vec<Vec<f64>> = observations.channels.iter().map(|channel| error[channel.place].clone()).collect();
            let moved = self.moved(&inverse, &off, weights);
            covariance += &moved * moved.transpose() / surface.errors.len() as f64;
        }
        Some(covariance)
    }

    /// Widens a covariance halfway to what noise inside the loop does to the faults in a few runs, where that is more: the slowest of it
    /// looks like a fault and is not left in the residuals.
    fn widen(
        &self,
        covariance: &mut DMatrix<f64>,
        inverse: &DMatrix<f64>,
        weights: &[Vec<f64>],
        observations: &Observations,
    ) {
        let n = self.slopes.len();
        let draws = observations.channels.iter().map(|channel| channel.draws.len()).min().unwrap_or(0);
        let mut squares = vec![0.0; n];
        for draw in 0..draws {
            let off: Vec<Vec<f64>> = observations.channels.iter().map(|channel| channel.draws[draw].clone()).collect();
            for (square, moved) in squares.iter_mut().zip(self.moved(inverse, &off, weights).iter()) {
                *square += moved * moved / draws as f64;
            }
        }
        let wider: Vec<f64> = (0..n).map(|i| (0.5 + 0.5 * squares[i] / covariance[(i, i)]).sqrt().max(1.0)).collect();
        for i in 0..n {
            for j in 0..n {
                covariance[(i, j)] *= wider[i] * wider[j];
            }
        }
    }
}

/// The weights with those of differences far beyond the expected lowered (Cauchy's): a jack that sticks a moment earlier or later
/// leaves much in a few bins.
fn robust(off: &[Vec<f64>], weights: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let lowered = |(off, w): (&f64, &f64)| w / (1.0 + off * off * w / (CAUCHY * CAUCHY));
    off.iter().zip(weights).map(|(off, w)| off.iter().zip(w).map(lowered).collect()).collect()
}
