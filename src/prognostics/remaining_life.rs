//! The remaining life of one fault.

use super::change::{self, Change, ChangeKind};
use super::fleet::LifeEvidence;
use super::forecast::{self, BandPoint, Prognosis};
use super::history::{History, Observation, Point, PrognosisError, Question};
use super::life::Life;
use super::posterior::{self, Posterior, Setting};
use super::prior::ScaledPrior;

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
    let whole = History::new(history, question)?;
    let (history, changes) = whole.without_changes(history, question)?;
    let mut prognosis = Prognosis { risk_window: question.risk_window, ..Prognosis::default() };
    if history.points.is_empty() {
        prognosis.reasons.push(format!("no observation of this life up to usage {}", question.at));
        return Ok(prognosis);
    }
    prognosis.reasons.extend(weakness(&history.points));
    prognosis.reasons.extend(changes.iter().map(told));
    prognosis.changes = changes;
    let prior = question.prior.at(history.scale);
    let mut posterior = posterior(&history, &history.points, question, &prior);
    let sound: Vec<&Point> = history.points.iter().filter(|point| point.variance < change::FREE).collect();
    if sound.len() > 1 && sound.iter().all(|point| point.value >= 1.0) {
        prognosis.reasons.push("every observation of this life, outliers apart, is past the threshold".to_owned());
        posterior.paths.iter_mut().for_each(|path| path.level = path.level.max(1.0));
    }
    let life = Life::new(posterior.paths, history.scale);
    let passed = life.passed(0.0) > 0.5;
    let reached = passed && confirmed(&history, question, &prior);
    if passed && !reached {
        prognosis
            .reasons
            .push("one observation alone says that the threshold is passed; another has to confirm it".into());
    }
    let lives = vec![life];
    let laws = posterior.laws.iter().map(|(law, _)| law.name().to_owned()).collect();
    let forecast = forecast::forecast(&lives, question.at, whole.horizon, reached, laws);
    prognosis.laws = posterior.laws.iter().map(|(law, probability)| (law.name().to_owned(), *probability)).collect();
    prognosis.risk = Some(1.0 - forecast::survival(&lives, question.risk_window));
    prognosis.band = band(&lives[0], question.at, &history, forecast.quantiles.q50.unwrap_or(whole.horizon));
    prognosis.forecast = Some(forecast);
    prognosis.evidence = posterior.evidence;
    prognosis.prior = prior.into_fleet();
    prognosis.lives = lives;
    Ok(prognosis)
}

/// What a fault's history says of the length of its life, prior apart; none without an observation.
///
/// # Errors
/// As of [`remaining_life`].
pub fn life_evidence(history: &[Observation], question: &Question) -> Result<Option<LifeEvidence>, PrognosisError> {
    let (whole, _) = History::new(history, question)?.without_changes(history, question)?;
    let (known, prior) = (!whole.points.is_empty(), question.prior.at(whole.scale));
    Ok(known.then(|| posterior(&whole, &whole.points, question, &prior).evidence).flatten())
}

fn posterior(history: &History, points: &[Point], question: &Question, life: &ScaledPrior) -> Posterior {
    let setting = Setting { at: history.at, scale: history.scale, life, healthy_known: question.healthy.is_some() };
    posterior::posterior(points, setting)
}

/// A change as a sentence.
fn told(change: &Change) -> String {
    let Change { kind, usage, size } = change;
    match kind {
        ChangeKind::Outlier => {
            format!("the observation at usage {usage} lies {size:.3} from its neighbours: it counts next to nothing")
        }
        ChangeKind::Step => {
            format!("the level steps by {size:.3} at usage {usage}: growth is taken to go on from there")
        }
        ChangeKind::Renewal => format!(
            "the level falls back by {:.3} at usage {usage}, as after maintenance: only what comes after it is used",
            size.abs()
        ),
    }
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
fn confirmed(history: &History, question: &Question, prior: &ScaledPrior) -> bool {
    let past = |point: &Point| point.value >= 1.0;
    if history.points.iter().filter(|p| past(p)).count() != 1 {
        return true;
    }
    let others: Vec<Point> = history.points.iter().filter(|p| !past(p)).copied().collect();
    if others.is_empty() || weakness(&others).is_some() {
        return false;
    }
    Life::new(posterior(history, &others, question, prior).paths, history.scale).passed(0.0) > 0.5
}

/// The 90 % band of the value from `at` over `length` of usage.
fn band(life: &Life, at: f64, history: &History, length: f64) -> Vec<BandPoint> {
    let points = if length > 0.0 { BAND_POINTS } else { 1 };
    let elapsed: Vec<f64> = (0..points).map(|i| length * i as f64 / (BAND_POINTS - 1) as f64).collect();
    let value = |level: f64| history.healthy + level * history.distance;
    let point = |(elapsed, levels): (&f64, [f64; 3])| {
        let [best, median, worst] = levels.map(value);
        BandPoint { usage: at + elapsed, low: best.min(worst), median, high: best.max(worst) }
    };
    elapsed.iter().zip(life.levels(&elapsed)).map(point).collect()
}
