//! What a prognosis says, and how it is read off a survival function.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::change::Change;
use super::fleet::{FleetPrior, LifeEvidence};
use super::life::{self, Life};

/// Nodes of the survival function, denser near now.
const NODES: usize = 32;
/// Where the survival leaves 1 and comes to 0, for the mean of a narrow forecast.
const ENDS: [f64; 2] = [0.001, 0.999];

/// How near a quantile that is asked for comes, as a share of it.
const QUANTILE_TOLERANCE: f64 = 1e-6;
/// The most halvings that it may take.
const QUANTILE_STEPS_MAX: usize = 100;

/// The probabilities of the quantiles.
const PROBABILITIES: [f64; 7] = [0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95];

/// Quantiles of the remaining life, in usage from `at`; null beyond the horizon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Quantiles {
    /// Life is shorter than this with probability 0.05.
    #[serde(rename = "0.05")]
    pub q05: Option<f64>,
    /// Life is shorter than this with probability 0.1.
    #[serde(rename = "0.1")]
    pub q10: Option<f64>,
    /// Life is shorter than this with probability 0.25.
    #[serde(rename = "0.25")]
    pub q25: Option<f64>,
    /// The median.
    #[serde(rename = "0.5")]
    pub q50: Option<f64>,
    /// Life is shorter than this with probability 0.75.
    #[serde(rename = "0.75")]
    pub q75: Option<f64>,
    /// Life is shorter than this with probability 0.9.
    #[serde(rename = "0.9")]
    pub q90: Option<f64>,
    /// Life is shorter than this with probability 0.95.
    #[serde(rename = "0.95")]
    pub q95: Option<f64>,
}

impl Quantiles {
    /// The probabilities and their quantiles, in rising order.
    #[must_use]
    pub fn pairs(&self) -> [(f64, Option<f64>); 7] {
        let values = [self.q05, self.q10, self.q25, self.q50, self.q75, self.q90, self.q95];
        std::array::from_fn(|i| (PROBABILITIES[i], values[i]))
    }
}

/// The forecast of the remaining life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Forecast {
    /// The usage from which remaining life counts.
    pub at: f64,
    /// Quantiles of the remaining life, in usage from `at`; null beyond the horizon.
    pub quantiles: Quantiles,
    /// Mean of the remaining life up to the horizon (a longer life counts as the horizon), in usage.
    pub mean: Option<f64>,
    /// Whether the threshold has been passed already, more probably than not, and not on the word of one observation.
    pub reached: bool,
    /// The probability that life lasts beyond the horizon, 0 to 1.
    pub probability_beyond_horizon: f64,
    /// How far the forecast reaches, in usage from `at`.
    pub horizon: f64,
    /// The degradation laws it rests on.
    pub models: Vec<String>,
}

/// A point of the 90 % band of the fault's value; the future observations' own noise is not part of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BandPoint {
    /// The usage.
    pub usage: f64,
    /// The lower bound of the value, in its own unit.
    pub low: f64,
    /// The median of the value, in its own unit.
    pub median: f64,
    /// The upper bound of the value, in its own unit.
    pub high: f64,
}

/// All that is said of a fault, or of an actuator, at one usage.
#[derive(Debug, Clone, Default)]
pub struct Prognosis {
    /// The forecast; none without an observation.
    pub forecast: Option<Forecast>,
    /// Why there is no forecast, or what weakens it: sentences.
    pub reasons: Vec<String>,
    /// The probability that the threshold is passed within the risk window from `at`, 0 to 1; none without a forecast.
    pub risk: Option<f64>,
    /// The usage from `at` that the risk is about.
    pub risk_window: f64,
    /// The band from `at` to where its median crosses the threshold, or to the horizon; empty without a forecast, and
    /// for competing faults.
    pub band: Vec<BandPoint>,
    /// The degradation laws and how probable each is, 0 to 1; empty without a forecast, and for competing faults.
    pub laws: Vec<(String, f64)>,
    /// Outliers and steps of the history, in order of usage.
    pub changes: Vec<Change>,
    /// What the history says of the length of its life, prior apart, for a fleet to learn from.
    pub evidence: Option<LifeEvidence>,
    /// The prior that the forecast had from a fleet.
    pub prior: Option<FleetPrior>,
    pub(super) lives: Vec<Life>,
}

impl Prognosis {
    /// The probability that nothing has reached its threshold `elapsed` (0 or more, in usage) after `at`; none without
    /// a forecast.
    #[must_use]
    pub fn survival(&self, elapsed: f64) -> Option<f64> {
        (!self.lives.is_empty()).then(|| survival(&self.lives, elapsed.max(0.0)))
    }

    /// The remaining life, in usage from `at`, by which a threshold is passed with probability `p` (above 0, below 1); none
    /// without a forecast, and beyond the horizon.
    #[must_use]
    pub fn quantile(&self, p: f64) -> Option<f64> {
        let Forecast { quantiles, horizon, .. } = self.forecast.as_ref()?;
        let pairs = quantiles.pairs();
        if let Some((_, known)) = pairs.iter().find(|(known, _)| *known == p) {
            return *known;
        }
        let passed = |elapsed: f64| self.survival(elapsed).map_or(0.0, |survival| 1.0 - survival);
        if passed(0.0) >= p {
            return Some(0.0);
        }
        if passed(*horizon) < p {
            return None;
        }
        let within = |known: &(f64, Option<f64>)| Some((known.0, known.1?));
        let below = pairs.iter().filter_map(within).rfind(|known| known.0 < p);
        let above = pairs.iter().filter_map(within).find(|known| known.0 > p);
        let (mut low, mut high) = (below.map_or(0.0, |known| known.1), above.map_or(*horizon, |known| known.1));
        for _ in 0..QUANTILE_STEPS_MAX {
            if high - low <= QUANTILE_TOLERANCE * high {
                break;
            }
            let middle = 0.5 * (low + high);
            *if passed(middle) < p { &mut low } else { &mut high } = middle;
        }
        Some(high)
    }
}

/// The survival of independent lives, of which the first to end counts.
pub(super) fn survival(lives: &[Life], elapsed: f64) -> f64 {
    lives.iter().map(|life| 1.0 - life.passed(elapsed)).product()
}

/// Reads a forecast off the survival of `lives`, at least one.
pub(super) fn forecast(lives: &[Life], at: f64, horizon: f64, reached: bool, models: Vec<String>) -> Forecast {
    let survives = |elapsed: f64| survival(lives, elapsed);
    let mut nodes: Vec<(f64, f64)> = (0..=NODES)
        .map(|i| {
            let elapsed = horizon * (i as f64 / NODES as f64).powi(3);
            (elapsed, survives(elapsed))
        })
        .collect();
    let quantile = |p: f64| {
        let next = nodes.iter().position(|node| 1.0 - node.1 >= p)?;
        let previous = nodes[next.saturating_sub(1)].0;
        Some(life::quantile(previous, nodes[next].0, p, |elapsed| 1.0 - survives(elapsed)))
    };
    let quantiles = PROBABILITIES.map(quantile);
    let known = quantiles.into_iter().zip(PROBABILITIES).chain(ENDS.map(|p| (quantile(p), p)));
    let between: Vec<_> = known.filter_map(|(q, p)| Some((q?, 1.0 - p))).filter(|node| node.0 > 0.0).collect();
    let beyond = nodes[NODES].1;
    nodes.extend(between);
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean: f64 = nodes.windows(2).map(|pair| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1)).sum();
    let [q05, q10, q25, q50, q75, q90, q95] = quantiles;
    Forecast {
        at,
        quantiles: Quantiles { q05, q10, q25, q50, q75, q90, q95 },
        mean: Some(mean.clamp(0.0, horizon)),
        reached,
        probability_beyond_horizon: beyond,
        horizon,
        models,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prognostics::{Direction, Observation, Question, competing, remaining_life};

    /// Of straight growth up to usage 100 and this share of the threshold.
    fn prognosis(level: f64) -> Prognosis {
        let observation =
            |i: u32| Observation { usage: 10.0 * f64::from(i), value: 0.1 * level * f64::from(i), std: Some(0.01) };
        let history: Vec<_> = (0..=10).map(observation).collect();
        let direction = Direction::Rising;
        let question = Question {
            threshold: 1.0,
            direction,
            healthy: Some(0.0),
            at: 100.0,
            life_start: None,
            horizon: None,
            risk_window: 10.0,
            prior: crate::prognostics::LifePrior::Watched,
        };
        remaining_life(&history, &question).unwrap()
    }

    #[test]
    fn a_quantile_is_where_the_survival_has_fallen_by_its_probability() {
        let prognosis = prognosis(0.5);
        let both = competing(&[("a", &prognosis), ("b", &prognosis)]).unwrap();
        for prognosis in [&prognosis, &both] {
            let mut before = 0.0;
            for p in [1e-3, 0.01, 0.05, 0.2, 0.3, 0.5, 0.6, 0.8] {
                let quantile = prognosis.quantile(p).unwrap();
                let passed = 1.0 - prognosis.survival(quantile).unwrap();
                assert!(
                    (passed - p).abs() < 2e-4 * p.max(0.01).sqrt() && quantile >= before,
                    "{p}: {passed} at {quantile}"
                );
                before = quantile;
            }
        }
    }

    #[test]
    fn the_quantiles_of_the_forecast_are_its_own() {
        let prognosis = prognosis(0.5);
        for (p, quantile) in prognosis.forecast.as_ref().unwrap().quantiles.pairs() {
            assert_eq!(prognosis.quantile(p), quantile);
        }
    }

    #[test]
    fn a_quantile_beyond_the_horizon_is_none_and_one_that_is_there_already_is_now() {
        let mut prognosis = prognosis(0.5);
        let horizon = prognosis.quantile(0.3).unwrap();
        prognosis.forecast.as_mut().unwrap().horizon = horizon;
        prognosis.forecast.as_mut().unwrap().quantiles =
            Quantiles { q05: None, q10: None, q25: None, q50: None, q75: None, q90: None, q95: None };
        assert_eq!(prognosis.quantile(0.31), None);
        let near = prognosis.quantile(0.29).unwrap();
        assert!(near < horizon && near > 0.5 * horizon, "{near} {horizon}");
        let passed = self::prognosis(1.0);
        assert!(passed.survival(0.0).unwrap() < 0.7, "{:?}", passed.survival(0.0));
        assert_eq!(passed.quantile(0.2), Some(0.0));
        prognosis.lives.clear();
        prognosis.forecast = None;
        assert_eq!(prognosis.quantile(0.5), None);
    }
}
