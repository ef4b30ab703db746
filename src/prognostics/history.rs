//! What is asked of a history, and the history in the units of the question.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::change::{self, Change, ChangeKind};
use super::metrics::median;
use super::prior::LifePrior;

/// Horizon of a forecast in scales, where the question names none.
const HORIZON_SCALES: f64 = 20.0;
/// The least age that the priors take a part for, in risk windows: a part is expected to outlast the time that its users
/// plan for.
const AGE_MIN_WINDOWS: f64 = 10.0;
/// More observations than this are averaged in groups of neighbours.
const POINTS_MAX: usize = 300;
/// The level that a history begins with is the median of this many values.
const FIRST: usize = 3;
/// A standard deviation beyond this many threshold distances says nothing more: it is taken as this one.
const STD_MAX: f64 = 1e3;
/// Values further from healthy than this many threshold distances are refused: there the arithmetic loses its digits.
const VALUE_MAX: f64 = 1e6;
/// The horizon is refused beyond this many ages, for the same reason.
const HORIZON_MAX: f64 = 1e6;
/// Problems after this many are not collected.
const PROBLEMS_MAX: usize = 100;

/// One estimate of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Usage at which it was observed, in the unit of the whole history (flight hours or cycles).
    pub usage: f64,
    /// The fault's value, in any unit.
    pub value: f64,
    /// The estimate's own standard deviation, in the unit of the value; none counts as 0.
    pub std: Option<f64>,
}

/// The way a fault's value moves as the damage grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Larger is worse.
    Rising,
    /// Smaller is worse.
    Falling,
}

/// What is asked of a history.
#[derive(Debug, Clone)]
pub struct Question {
    /// The value at which life ends.
    pub threshold: f64,
    /// The way from healthy to the threshold.
    pub direction: Direction,
    /// The value when new; none: it is learnt from the history, whose first values set the scale of the priors instead.
    pub healthy: Option<f64>,
    /// The usage from which remaining life counts; later observations are not used.
    pub at: f64,
    /// The usage at which this life began; earlier observations are not used. None: the first usage of the history.
    pub life_start: Option<f64>,
    /// How far the forecast reaches, in usage from `at`. None: 20 times the age, but no less than 200 risk windows.
    pub horizon: Option<f64>,
    /// The usage from `at` within which the risk is asked, 0 or more.
    pub risk_window: f64,
    /// What is known of the life beforehand.
    pub prior: LifePrior,
}

/// One thing wrong with a history or a question.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place} is {found}, expected {expected}")]
pub struct Problem {
    /// The field, with the index of its observation: `history[3].value`.
    pub place: String,
    /// What was found.
    pub found: f64,
    /// What was expected.
    pub expected: String,
}

/// All that is wrong with a history and its question: the first 100 problems.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", .problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("; "))]
pub struct PrognosisError {
    /// The problems, at least one.
    pub problems: Vec<Problem>,
}

/// Collects problems.
#[derive(Default)]
pub(super) struct Check {
    problems: Vec<Problem>,
}

impl Check {
    pub(super) fn that(&mut self, holds: bool, place: impl FnOnce() -> String, found: f64, expected: &str) {
        if !holds && self.problems.len() < PROBLEMS_MAX {
            self.problems.push(Problem { place: place(), found, expected: expected.to_owned() });
        }
    }

    pub(super) fn finish(self) -> Result<(), PrognosisError> {
        if self.problems.is_empty() { Ok(()) } else { Err(PrognosisError { problems: self.problems }) }
    }
}

/// An observation in the units of the question.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Usage in scales from the start of the life.
    pub usage: f64,
    /// 0 healthy, 1 at the threshold.
    pub value: f64,
    /// The variance that the observation states of itself.
    pub variance: f64,
    /// The variance of a jump of the level just before it; 0 without one.
    pub jump: f64,
}

/// A valid history, in the units of its question.
#[derive(Clone)]
pub(super) struct History {
    /// In order of usage, those of this life up to `at`.
    pub points: Vec<Point>,
    /// The unit of usage: the age, but no less than the risk window; 1 where both are 0.
    pub scale: f64,
    /// The usage of the question, in scales from the start of the life.
    pub at: f64,
    /// The horizon in usage.
    pub horizon: f64,
    /// The value that counts as healthy, and the way from there to the threshold.
    pub healthy: f64,
    pub distance: f64,
}

impl History {
    /// Checks a history and its question, and puts the history in the question's units.
    pub fn new(observations: &[Observation], question: &Question) -> Result<Self, PrognosisError> {
        check_question(question)?;
        let start = start(observations, question);
        let age = question.at - start;
        let scale = match age.max(AGE_MIN_WINDOWS * question.risk_window) {
            0.0 => 1.0,
            scale => scale,
        };
        let horizon = question.horizon.unwrap_or(HORIZON_SCALES * scale);
        let used = |o: &&Observation| (start..=question.at).contains(&o.usage);
        let healthy = question.healthy.unwrap_or_else(|| first_level(observations.iter().filter(used), question));
        let distance = question.threshold - healthy;
        let mut check = Check::default();
        check_observations(&mut check, observations, question, healthy);
        check.that(
            horizon / scale <= HORIZON_MAX,
            || "horizon".to_owned(),
            horizon,
            "at most a million times the age (or ten risk windows, if that is longer)",
        );
        check.finish()?;
        let point = |o: &Observation| Point {
            usage: (o.usage - start) / scale,
            value: (o.value - healthy) / distance,
            variance: (o.std.unwrap_or(0.0) / distance).abs().min(STD_MAX).powi(2),
            jump: 0.0,
        };
        let points: Vec<Point> = observations.iter().filter(used).map(point).collect();
        Ok(Self { points: averaged(points), scale, at: age / scale, horizon, healthy, distance })
    }
}

impl History {
    /// The history with its outliers and steps marked, and from its last renewal on; and these changes.
    pub fn without_changes(
        &self,
        observations: &[Observation],
        question: &Question,
    ) -> Result<(Self, Vec<Change>), PrognosisError> {
        let mut history = self.clone();
        let found = change::find(&mut history.points);
        let start = start(observations, question);
        // The usage of an observation, to the bit, also where some were averaged.
        let observed = |usage: f64| {
            let nearest = |a: &f64, b: &f64| (a - usage).abs().total_cmp(&(b - usage).abs());
            observations.iter().map(|o| o.usage).min_by(nearest).unwrap_or(usage)
        };
        let mut changes: Vec<Change> = found
            .iter()
            .map(|found| Change {
                kind: found.kind,
                usage: observed(start + history.points[found.index].usage * self.scale),
                size: found.size * self.distance,
            })
            .collect();
        let Some(renewal) = found.iter().rposition(|found| found.kind == ChangeKind::Renewal) else {
            return Ok((history, changes));
        };
        let since = Question { life_start: Some(changes[renewal].usage), ..question.clone() };
        let (renewed, later) = Self::new(observations, &since)?.without_changes(observations, &since)?;
        changes.truncate(renewal + 1);
        changes.extend(later);
        Ok((renewed, changes))
    }
}

/// The usage at which the life began.
pub(super) fn start(observations: &[Observation], question: &Question) -> f64 {
    let first = observations.first().map_or(question.at, |o| o.usage);
    question.life_start.unwrap_or(first.min(question.at))
}

fn check_question(question: &Question) -> Result<(), PrognosisError> {
    let mut check = Check::default();
    let fields = [
        ("threshold", Some(question.threshold)),
        ("healthy", question.healthy),
        ("at", Some(question.at)),
        ("life_start", question.life_start),
    ];
    for (name, value) in fields.into_iter().filter_map(|(name, value)| Some((name, value?))) {
        check.that(value.is_finite(), || name.to_owned(), value, "a finite number");
    }
    if let Some(healthy) = question.healthy {
        let (expected, distance) = match question.direction {
            Direction::Rising => ("above healthy, as the direction is rising", question.threshold - healthy),
            Direction::Falling => ("below healthy, as the direction is falling", healthy - question.threshold),
        };
        let sided = distance.is_nan() || (distance > 0.0 && distance.is_finite());
        check.that(sided, || "threshold".to_owned(), question.threshold, expected);
    }
    if let Some(start) = question.life_start {
        let age = question.at - start;
        let in_order = age.is_nan() || (age >= 0.0 && age.is_finite());
        check.that(in_order, || "life_start".to_owned(), start, "at most `at`");
    }
    if let Some(horizon) = question.horizon {
        check.that(horizon.is_finite() && horizon > 0.0, || "horizon".to_owned(), horizon, "a finite number above 0");
    }
    let window = question.risk_window;
    check.that(window.is_finite() && window >= 0.0, || "risk_window".to_owned(), window, "a finite number, 0 or more");
    check.finish()
}

/// The level that the history begins with: the median of its first values, or, where they are past the threshold already, as
/// far on the healthy side of it as the history is wide.
fn first_level<'a>(used: impl Iterator<Item = &'a Observation> + Clone, question: &Question) -> f64 {
    let healthier = match question.direction {
        Direction::Rising => -1.0,
        Direction::Falling => 1.0,
    };
    let finite = used.map(|o| o.value).filter(|value| value.is_finite());
    let first = median(finite.clone().take(FIRST).collect()).unwrap_or(question.threshold);
    if (first - question.threshold) * healthier > 0.0 {
        return first;
    }
    let farthest = finite.map(|value| (value - question.threshold).abs()).fold(0.0, f64::max);
    let width = if farthest > 0.0 { farthest } else { question.threshold.abs().max(f64::MIN_POSITIVE) };
    question.threshold + healthier * width
}

fn check_observations(check: &mut Check, observations: &[Observation], question: &Question, healthy: f64) {
    let distance = (question.threshold - healthy).abs();
    let mut previous = f64::NEG_INFINITY;
    for (i, o) in observations.iter().enumerate() {
        let place = |field: &'static str| move || format!("history[{i}].{field}");
        check.that((o.usage - question.at).is_finite(), place("usage"), o.usage, "a finite number");
        check.that(
            o.usage.is_nan() || o.usage >= previous,
            place("usage"),
            o.usage,
            "no less than the usage before it",
        );
        previous = previous.max(o.usage);
        check.that(o.value.is_finite(), place("value"), o.value, "a finite number");
        let near = !o.value.is_finite() || ((o.value - healthy) / distance).abs() <= VALUE_MAX;
        check.that(near, place("value"), o.value, "within a million times the threshold's distance from healthy");
        if let Some(std) = o.std {
            check.that(std.is_finite() && std >= 0.0, place("std"), std, "a finite number, 0 or more");
        }
    }
}

/// At most `POINTS_MAX` points: the means of equal runs of neighbours.
fn averaged(points: Vec<Point>) -> Vec<Point> {
    if points.len() <= POINTS_MAX {
        return points;
    }
    let run = points.len().div_ceil(POINTS_MAX);
    let mean = |run: &[Point]| {
        let n = run.len() as f64;
        Point {
            usage: run.iter().map(|p| p.usage).sum::<f64>() / n,
            value: run.iter().map(|p| p.value).sum::<f64>() / n,
            variance: run.iter().map(|p| p.variance).sum::<f64>() / (n * n),
            jump: 0.0,
        }
    };
    points.chunks(run).map(mean).collect()
}
