//! Observations that do not belong, and steps of the level: told, not smoothed over.
//!
//! An outlier is given the variance of the whole way to the threshold, a step lets the level jump as far. Either is believed where
//! the evidence of a history of smooth growth gains more than a hundredfold for each place that it might have had.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::filter::{Sums, WALKS, filter};
use super::history::Point;
use super::law::Shape;
use super::metrics::median;

/// Fewer observations than this are taken as they are.
const POINTS_MIN: usize = 6;
/// The most changes that are looked for.
const CHANGES_MAX: usize = 6;
/// The gain in log-evidence that a change needs, beside the logarithm of the number of observations: a hundredfold.
const GAIN_MIN: f64 = 4.6;
/// A place is looked at where it stands out by this many robust standard deviations.
const STANDS_OUT: f64 = 3.5;
/// The variance that a change brings in, squared threshold distances.
pub(super) const FREE: f64 = 1.0;
/// The shapes that smooth growth is judged by.
const SHAPES: [f64; 2] = [1.0, 2.5];
/// The walk's variances over one scale, squared threshold distances.
const WALKS_TRIED: [f64; WALKS] = [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3];
/// The weak prior variances of the level and of the growth over one scale.
const LEVEL: f64 = 1.0;
const GROWTH: f64 = 100.0;
/// The least standard deviation of the noise, threshold distances.
const NOISE_MIN: f64 = 1e-4;
/// A step back by this part of the damage or more, and this far at least, begins a new life.
const RENEWED: f64 = 0.5;
const RENEWED_MIN: f64 = 0.05;

/// What a change is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ChangeKind {
    /// One observation that does not belong to the others; it counts next to nothing.
    Outlier,
    /// The level jumps, and growth goes on from there.
    Step,
    /// The level falls back towards healthy, as after maintenance that was not reported; the forecast rests on what comes after.
    Renewal,
}

/// A place where a history is not smooth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Change {
    /// What it is.
    pub kind: ChangeKind,
    /// The usage of the first observation after it, or of the outlier.
    pub usage: f64,
    /// How far the level jumps, or the outlier lies from its neighbours, in the unit of the value.
    pub size: f64,
}

/// A change in the units of the question.
pub(super) struct Found {
    pub kind: ChangeKind,
    pub index: usize,
    pub size: f64,
}

/// Finds the changes, marks the points with them (variance and jump), and returns them in order of usage. After a renewal the
/// points before it are still there.
pub(super) fn find(points: &mut [Point]) -> Vec<Found> {
    let mut found: Vec<Found> = Vec::new();
    if points.len() < POINTS_MIN {
        return found;
    }
    let needed = GAIN_MIN + (points.len() as f64).ln();
    while found.len() < CHANGES_MAX {
        let marked: Vec<usize> = found.iter().map(|f| f.index).collect();
        let (places, noise) = places(points, &marked);
        if places.is_empty() {
            break;
        }
        let smooth = evidence(points, noise);
        let mut best: Option<(f64, Found)> = None;
        for (kind, index, size) in places {
            let kept = points[index];
            mark(&mut points[index], kind);
            let gain = evidence(points, noise) - smooth;
            points[index] = kept;
            if gain > best.as_ref().map_or(needed, |b| b.0) {
                best = Some((gain, Found { kind, index, size }));
            }
        }
        let Some((_, change)) = best else { break };
        mark(&mut points[change.index], change.kind);
        found.push(change);
    }
    found.sort_by_key(|f| f.index);
    found.iter_mut().for_each(|f| f.kind = renewed(points, f));
    found
}

fn mark(point: &mut Point, kind: ChangeKind) {
    match kind {
        ChangeKind::Outlier => point.variance += FREE,
        ChangeKind::Step | ChangeKind::Renewal => point.jump = FREE,
    }
}

/// A step back by much of the damage is a renewal.
fn renewed(points: &[Point], found: &Found) -> ChangeKind {
    let before = middle(points[found.index.saturating_sub(3)..found.index].iter().map(|p| p.value).collect());
    match found.kind {
        ChangeKind::Step if -found.size > (RENEWED * before).max(RENEWED_MIN) => ChangeKind::Renewal,
        kind => kind,
    }
}

/// The places that stand out from their neighbours, with the size of each change, and a robust estimate of the noise.
fn places(points: &[Point], marked: &[usize]) -> (Vec<(ChangeKind, usize, f64)>, f64) {
    let usable: Vec<usize> = (0..points.len()).filter(|&i| points[i].variance < FREE).collect();
    if usable.len() < POINTS_MIN {
        return (Vec::new(), NOISE_MIN);
    }
    let value = |k: usize| points[usable[k]].value;
    // From the mean of the neighbours; independent noise makes this larger by the root of 3/2.
    let aside = |k: usize| match k {
        0 => value(0) - 2.0 * value(1) + value(2),
        k if k + 1 == usable.len() => value(k) - 2.0 * value(k - 1) + value(k - 2),
        k => value(k) - 0.5 * (value(k - 1) + value(k + 1)),
    };
    let ends = |k: usize| k == 0 || k + 1 == usable.len();
    let inner: Vec<f64> = (1..usable.len().saturating_sub(1)).map(|k| aside(k).abs()).collect();
    let noise = (1.4826 * middle(inner) / 1.5_f64.sqrt()).max(NOISE_MIN);
    let step = |k: usize| {
        let after = middle((k..usable.len().min(k + 3)).map(value).collect());
        after - middle((k.saturating_sub(3)..k).map(value).collect())
    };
    let usual = middle((1..usable.len()).map(step).collect());
    let mut places = Vec::new();
    for k in 0..usable.len() {
        let index = usable[k];
        if marked.contains(&index) {
            continue;
        }
        // The second difference at an end is twice as noisy.
        let scale = if ends(k) { 2.0 } else { 1.25 };
        if aside(k).abs() > STANDS_OUT * scale * noise {
            places.push((ChangeKind::Outlier, index, aside(k)));
        }
        // What one last observation is, only the next one tells.
        if k > 0 && k + 1 < usable.len() && (step(k) - usual).abs() > STANDS_OUT * noise {
            places.push((ChangeKind::Step, index, step(k) - usual));
        }
    }
    (places, noise)
}

/// The logarithm of the evidence of smooth growth: over the shapes, walks and a few noises about the robust one.
fn evidence(points: &[Point], noise: f64) -> f64 {
    let end = points.last().map_or(1.0, |p| p.usage).max(f64::MIN_POSITIVE);
    let mut terms = Vec::with_capacity(SHAPES.len() * 3 * WALKS);
    for exponent in SHAPES {
        let shape = Shape::Power { exponent };
        let growth: Vec<f64> = points.iter().map(|p| shape.at(p.usage / end)).chain(std::iter::once(1.0)).collect();
        for factor in [0.7, 1.0, 1.4] {
            let noise = factor * noise;
            terms.extend(filter(points, &growth, noise * noise, &WALKS_TRIED).iter().map(integrated));
        }
    }
    let best = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    best + terms.iter().map(|t| (t - best).exp()).sum::<f64>().ln()
}

/// The log-likelihood with level and growth integrated out under their weak priors.
fn integrated(s: &Sums) -> f64 {
    let (one, gg) = (s.one + 1.0 / LEVEL, s.gg + 1.0 / GROWTH);
    let determinant = one * gg - s.og * s.og;
    let explained = (gg * s.y1 * s.y1 - 2.0 * s.og * s.y1 * s.yg + one * s.yg * s.yg) / determinant;
    -0.5 * (s.yy - explained + s.log_determinant + determinant.ln())
}

/// The median; 0 without a value.
fn middle(values: Vec<f64>) -> f64 {
    median(values).unwrap_or(0.0)
}
