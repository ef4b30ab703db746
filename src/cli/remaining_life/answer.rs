//! What is answered of one usage.

use std::collections::BTreeMap;
use std::time::Instant;

use serde::Serialize;

use super::RemainingLifeArgs;
use super::ask::Case;
use crate::cli::Failure;
use crate::formats::history::UsageUnit;
use crate::prognostics::{Change, Direction, Prognosis, Quantiles};

/// Horizon of a forecast in ages, where none is asked for: as in the prognosis.
const HORIZON_AGES: f64 = 20.0;

const NONE: Quantiles = Quantiles { q05: None, q10: None, q25: None, q50: None, q75: None, q90: None, q95: None };

/// A forecast, or why there is none.
#[derive(Debug, Serialize)]
pub(super) struct Answer {
    pub(super) at: f64,
    pub(super) unit: UsageUnit,
    pub(super) quantiles: Quantiles,
    pub(super) mean: Option<f64>,
    pub(super) reached: bool,
    pub(super) probability_beyond_horizon: Option<f64>,
    pub(super) horizon: Option<f64>,
    pub(super) models: Vec<String>,
    /// How probable each law is, 0 to 1.
    pub(super) laws: BTreeMap<String, f64>,
    /// Outliers and steps of the history.
    pub(super) changes: Vec<Change>,
    pub(super) elapsed_s: f64,
    /// The probability of failure within some usage, where that was asked.
    pub(super) risk: Option<Risk>,
    pub(super) act_by: ActBy,
    pub(super) reasons: Vec<String>,
}

/// The probability of failure within some usage.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Risk {
    pub(super) within: f64,
    pub(super) probability: f64,
}

/// The usage by which to act.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct ActBy {
    /// The probability of failure before it.
    pub(super) risk: f64,
    /// The usage; none beyond the horizon.
    pub(super) usage: Option<f64>,
}

/// Answers what is asked of a history at one usage.
pub(super) fn answer(args: &RemainingLifeArgs, case: &Case<'_>, at: f64) -> Result<Answer, Failure> {
    let started = Instant::now();
    let prognosis = case.prognosis(args, at)?;
    let mut answer = match &prognosis {
        Some(prognosis) => told(args, prognosis, at),
        None => without_observation(args, case, at),
    };
    answer.unit = case.unit;
    if case.inferred {
        let (direction, side) = match case.direction {
            Direction::Rising => ("rising", "below"),
            Direction::Falling => ("falling", "above"),
        };
        answer
            .reasons
            .push(format!("the direction is taken to be {direction}: the first values are {side} the threshold"));
    }
    answer.elapsed_s = started.elapsed().as_secs_f64();
    Ok(answer)
}

fn told(args: &RemainingLifeArgs, prognosis: &Prognosis, at: f64) -> Answer {
    let forecast = prognosis.forecast.as_ref();
    let risk = |within| Some(Risk { within, probability: 1.0 - prognosis.survival(within)? });
    let act_by = prognosis.quantile(args.risk);
    Answer {
        quantiles: forecast.map_or(NONE, |forecast| forecast.quantiles),
        mean: forecast.and_then(|forecast| forecast.mean),
        reached: forecast.is_some_and(|forecast| forecast.reached),
        probability_beyond_horizon: forecast.map(|forecast| forecast.probability_beyond_horizon),
        horizon: forecast.map(|forecast| forecast.horizon),
        models: forecast.map(|forecast| forecast.models.clone()).unwrap_or_default(),
        laws: prognosis.laws.iter().cloned().collect(),
        changes: prognosis.changes.clone(),
        risk: args.within.and_then(risk),
        act_by: ActBy { risk: args.risk, usage: act_by.map(|remaining| at + remaining) },
        reasons: prognosis.reasons.clone(),
        ..nothing(args, at)
    }
}

fn without_observation(args: &RemainingLifeArgs, case: &Case<'_>, at: f64) -> Answer {
    let age = case.start().map(|start| at - start).filter(|age| *age > 0.0);
    Answer {
        horizon: args.horizon.or(age.map(|age| HORIZON_AGES * age)),
        reasons: vec![format!("no observation of this life up to usage {at}")],
        ..nothing(args, at)
    }
}

fn nothing(args: &RemainingLifeArgs, at: f64) -> Answer {
    Answer {
        at,
        unit: UsageUnit::FlightHours,
        quantiles: NONE,
        mean: None,
        reached: false,
        probability_beyond_horizon: None,
        horizon: None,
        models: Vec::new(),
        laws: BTreeMap::new(),
        changes: Vec::new(),
        elapsed_s: 0.0,
        risk: None,
        act_by: ActBy { risk: args.risk, usage: None },
        reasons: Vec::new(),
    }
}
