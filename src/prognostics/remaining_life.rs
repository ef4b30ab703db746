//! The remaining life of one fault.

use super::forecast::{self, BandPoint, Prognosis};
use super::history::{History, Observation, Point, PrognosisError, Question};
use super::life::Life;
use super::line;

/// Points of the band.
const BAND_POINTS: usize = 24;

/// The remaining life that a fault's history promises.
///
/// `history` is in order of usage (equal usages are fine). Of it, what lies between the start of the life and `at` is
/// used. With one observation the answer is the prior's, wide; with none there is no forecast, and a reason.
///
/// # Errors
/// All fields of the history and the question that are not finite, out of range or out of order, up to 100.
pub fn remaining_life(history: &[Observation], question: &Question) -> Result<Prognosis, PrognosisError> {
    let history = History::new(history, question)?;
    let mut prognosis = Prognosis {
        forecast: None,
        reasons: Vec::new(),
        risk: None,
        risk_window: question.risk_window,
        band: Vec::new(),
        lives: Vec::new(),
    };
    let lines = line::posterior(&history.points);
    if lines.is_empty() {
        prognosis.reasons.push(format!("no observation of this life up to usage {}", question.at));
        return Ok(prognosis);
    }
    prognosis.reasons.extend(weakness(&history.points));
    let life = Life::new(lines, history.scale);
    let passed = life.passed(0.0) > 0.5;
    let reached = passed && confirmed(&history);
    if passed && !reached {
        prognosis
            .reasons
            .push("one observation alone says that the threshold is passed; another has to confirm it".into());
    }
    let lives = vec![life];
    let forecast = forecast::forecast(&lives, question.at, history.horizon, reached, vec!["line".to_owned()]);
    prognosis.risk = Some(1.0 - forecast::survival(&lives, question.risk_window));
    prognosis.band = band(&lives[0], question, forecast.quantiles.q50.unwrap_or(history.horizon));
    prognosis.forecast = Some(forecast);
    prognosis.lives = lives;
    Ok(prognosis)
}

/// Why the history says nothing about the rate of growth, if so.
fn weakness(points: &[Point]) -> Option<String> {
    let (first, last) = (points.first()?, points.last()?);
    if points.len() == 1 {
        Some("only one observation: the rate of growth, and with it the forecast, is the prior's".to_owned())
    } else if first.usage == last.usage {
        Some(
            "all observations are at one usage: the rate of growth, and with it the forecast, is the prior's"
                .to_owned(),
        )
    } else {
        None
    }
}

/// Whether the threshold counts as passed without the only observation past it, where there is only one. The others
/// have to tell of a rate of growth themselves: the prior's confirms nothing.
fn confirmed(history: &History) -> bool {
    let past = |point: &Point| point.value >= 1.0;
    if history.points.iter().filter(|p| past(p)).count() != 1 {
        return true;
    }
    let others: Vec<Point> = history.points.iter().filter(|p| !past(p)).copied().collect();
    let lines = line::posterior(&others);
    !lines.is_empty() && weakness(&others).is_none() && Life::new(lines, history.scale).passed(0.0) > 0.5
}

/// The 90 % band of the value from `at` over `length` of usage.
fn band(life: &Life, question: &Question, length: f64) -> Vec<BandPoint> {
    let points = if length > 0.0 { BAND_POINTS } else { 1 };
    let elapsed: Vec<f64> = (0..points).map(|i| length * i as f64 / (BAND_POINTS - 1) as f64).collect();
    let value = |level: f64| question.healthy + level * (question.threshold - question.healthy);
    let point = |(elapsed, levels): (&f64, [f64; 3])| {
        let [best, median, worst] = levels.map(value);
        BandPoint { usage: question.at + elapsed, low: best.min(worst), median, high: best.max(worst) }
    };
    elapsed.iter().zip(life.levels(&elapsed)).map(point).collect()
}
