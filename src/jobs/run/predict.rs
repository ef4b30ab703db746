//! Forecasts: from an actuator's history to the document that is served and to the figures that the fleet is ranked by.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use tokio::task::{JoinError, spawn_blocking};
use utoipa::ToSchema;

use super::asked::{AskedFault, usage};
use super::calendar::UseRate;
use super::fleet::{self, KnownLives, LearntFrom, Taken};
use super::{Compute, panic_text, trend};
use crate::jobs::alerts::{self, AlertSettings, Evidence};
use crate::jobs::{JobSettings, lives};
use crate::prognostics::{BandPoint, Change, FLEET_MODEL, Forecast, LifePrior, Prognosis, PrognosisError, competing};
use crate::store::records::{self, Actuator, FleetShare, ForecastRecord, Id, UsageUnit};
use crate::store::{LifeHistory, Records, StoreError, WithForecast};

/// How often an actuator is read again when its history changes meanwhile.
const TRIES: usize = 3;

/// What is asked of a forecast beside its quantiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RiskQuestion {
    /// The usage ahead that users plan for, above 0, in the actuator's usage unit: the priors rest on it.
    pub risk_window: f64,
    /// The usage ahead within which the probability of a failure is asked, above 0.
    pub within: f64,
    /// The probability of a failure at which to act, above 0 and below 1.
    pub act_at_risk: f64,
}

/// The remaining life of an actuator, as it is served.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct RemainingLife {
    /// The actuator.
    pub actuator_id: Id,
    /// When the newest trace of this life was recorded; null without one.
    pub as_of: Option<Timestamp>,
    /// The most usage that a trace of this life has, from which remaining life counts.
    pub usage: Option<f64>,
    /// What usage and remaining life count.
    pub unit: UsageUnit,
    /// The forecast of the life that ends with the first fault at its threshold; null without an observation.
    pub forecast: Option<TimedForecast>,
    /// Why there is no forecast, or what weakens it.
    pub reasons: Vec<String>,
    /// How probably that life ends soon.
    pub risk: Option<Risk>,
    /// When to act; null without a forecast.
    pub act_by: Option<ActBy>,
    /// How fast the actuator was used of late, on which every date rests.
    pub use_rate: UseRate,
    /// The forecast of each fault by itself.
    pub faults: FaultForecasts,
    /// The elevon version.
    pub version: String,
}

/// A forecast with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct TimedForecast {
    /// The forecast.
    #[serde(flatten)]
    pub forecast: Forecast,
    /// The dates of the quantiles at the recent rate of use, from the newest trace's `recorded_at`, in UTC; null where the
    /// quantile is, without a rate, and beyond the year 9999.
    #[schema(example = json!({"0.05": "2027-03-01T06:00:00Z", "0.5": "2028-11-12T18:30:00Z", "0.95": null}))]
    pub dates: BTreeMap<String, Option<Timestamp>>,
    /// What usage and remaining life count.
    pub unit: UsageUnit,
    /// Time that the forecast took, s.
    pub elapsed_s: f64,
}

/// The probability that a threshold is passed soon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct Risk {
    /// Usage from now on, in the forecast's unit.
    pub within: f64,
    /// The probability that it happens within that usage, 0 to 1.
    pub probability: f64,
}

/// When to act so that the probability of a failure before then is no more than a risk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ActBy {
    /// The probability of a failure before then, 0 to 1.
    pub risk: f64,
    /// The usage until then from the forecast's `at`; null beyond its horizon.
    pub remaining: Option<f64>,
    /// The usage then; null beyond the forecast's horizon.
    pub usage: Option<f64>,
    /// The date then at the recent rate of use, in UTC; null where the usage is, without a rate, and beyond the year 9999.
    pub date: Option<Timestamp>,
    /// Why something of it is null; null where nothing is.
    pub reason: Option<String>,
}

/// The forecasts of the faults.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct FaultForecasts {
    /// Torque-motor demagnetisation, 0 to 1.
    pub kgm: FaultForecast,
    /// Dynamic jack friction, N.
    pub fdj_n: FaultForecast,
}

/// The forecast of one fault.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct FaultForecast {
    /// The level at which the actuator counts as failed, in the fault's unit.
    pub threshold: f64,
    /// The forecast; null without an observation of this fault.
    pub forecast: Option<TimedForecast>,
    /// Why there is no forecast, or what weakens it.
    pub reasons: Vec<String>,
    /// How probably the threshold is passed soon.
    pub risk: Option<Risk>,
    /// When to act; null without a forecast.
    pub act_by: Option<ActBy>,
    /// The 90 % band of the fault's level ahead.
    pub band: Vec<BandPoint>,
    /// Where the history is not smooth: outliers, steps, and falls as after maintenance that was not reported.
    pub changes: Vec<Change>,
    /// The other lives that this one is expected to be like.
    pub learnt_from: LearntFrom,
}

/// The stored forecast if it is of the actuator's revision or a later one, else a new one, which is then stored with the
/// alerts that it raises and clears.
pub(in crate::jobs) async fn forecast(
    records: &dyn Records,
    compute: Arc<dyn Compute>,
    actuator: &Actuator,
    settings: &JobSettings,
) -> Result<ForecastRecord, StoreError> {
    if let Some(stored) = records.forecast(actuator.id).await?
        && stored.revision >= actuator.revision
    {
        return Ok(stored);
    }
    let asked = settings.asked();
    let (actuator, history) = as_they_are(records, actuator).await?;
    let known = fleet::known(records, &actuator, &history, &asked).await?;
    let (Predicted { life, shares }, history) = computed(compute, &actuator, history, known, &asked).await;
    let forecast = ForecastRecord {
        actuator_id: actuator.id,
        revision: history.revision,
        risk: life.risk.map(|risk| risk.probability),
        median_remaining: life.forecast.as_ref().and_then(|timed| timed.forecast.quantiles.q50),
        document: document(&life),
        basis: basis(settings),
        created_at: records::now(),
    };
    let step = trend::step(forecast.created_at, settings, &life, &history);
    let open = records.open_alerts(actuator.id).await?;
    let evidence = Evidence::of(&history);
    let alerts = alerts::changes(&actuator, &life, &evidence, &open, &settings.alerts, forecast.created_at);
    // When the history moved on meanwhile this one is still right for who asked, and whoever moved it makes the next.
    let with = WithForecast { step: step.as_ref(), alerts: &alerts, shares: &shares };
    records.store_forecast_with(&forecast, &with).await?;
    Ok(forecast)
}

/// The answer to another question than the kept forecast's, which it does not move: from the same history, and from what that
/// forecast took from other lives.
pub(in crate::jobs) async fn answer(
    records: &dyn Records,
    compute: Arc<dyn Compute>,
    actuator: &Actuator,
    kept: &ForecastRecord,
    asked: &RiskQuestion,
) -> Result<RemainingLife, StoreError> {
    let (actuator, history) = as_they_are(records, actuator).await?;
    let known = if history.revision == kept.revision {
        fleet::taken(records, &actuator, kept, asked).await?
    } else {
        fleet::known(records, &actuator, &history, asked).await?
    };
    Ok(computed(compute, &actuator, history, known, asked).await.0.life)
}

/// An actuator and the history of its life, both of one revision. If it goes on changing they bear the older one's, so that
/// what is made from them is not kept.
async fn as_they_are(records: &dyn Records, known: &Actuator) -> Result<(Actuator, LifeHistory), StoreError> {
    let mut actuator = known.clone();
    let mut history = LifeHistory { revision: actuator.revision, ..LifeHistory::default() };
    for _ in 0..TRIES {
        let Some(read) = records.life_history(actuator.id).await? else { break };
        history = read;
        if history.revision == actuator.revision {
            break;
        }
        let Some(changed) = records.actuator(actuator.id).await? else { break };
        actuator = changed;
    }
    history.revision = history.revision.min(actuator.revision);
    Ok((actuator, history))
}

/// Computes a forecast where that may take its time.
async fn computed(
    compute: Arc<dyn Compute>,
    actuator: &Actuator,
    history: LifeHistory,
    known: KnownLives,
    asked: &RiskQuestion,
) -> (Predicted, LifeHistory) {
    let history = Arc::new(history);
    let (of, asked, given) = (actuator.clone(), *asked, history.clone());
    let predicted = match spawn_blocking(move || compute.predict(&of, &given, &known, &asked)).await {
        Ok(predicted) => predicted,
        Err(ended) => Predicted { life: failed(actuator, &asked, ended), shares: Vec::new() },
    };
    (predicted, Arc::unwrap_or_clone(history))
}

/// Gives a trace that is not the newest of its actuator its step of the trend, made from its life's history up to it, unless
/// it has one: its upload came late, or other estimates ended before the forecast was made.
pub(in crate::jobs) async fn fill_trend(
    records: &dyn Records,
    compute: Arc<dyn Compute>,
    actuator: &Actuator,
    (trace, recorded_at): (Id, Timestamp),
    settings: &JobSettings,
) -> Result<(), StoreError> {
    let Some(mut history) = records.life_history(actuator.id).await? else { return Ok(()) };
    if history.records.last().is_some_and(|newest| newest.trace_id == trace) {
        return Ok(());
    }
    if !history.records.iter().any(|record| record.trace_id == trace) {
        history = lives::up_to(records, actuator.id, recorded_at).await?;
    }
    let Some(place) = history.records.iter().position(|record| record.trace_id == trace) else { return Ok(()) };
    history.records.truncate(place + 1);
    let asked = settings.asked();
    let known = fleet::known(records, actuator, &history, &asked).await?;
    let (Predicted { life, .. }, history) = computed(compute, actuator, history, known, &asked).await;
    match trend::step(records::now(), settings, &life, &history) {
        Some(step) => records.fill_trend(&step).await.map(drop),
        None => Ok(()),
    }
}

/// A forecast as JSON.
pub(in crate::jobs) fn document(life: &RemainingLife) -> serde_json::Value {
    serde_json::to_value(life).expect("a forecast's fields have names")
}

/// What a forecast rests on besides the history: when it changes, stored forecasts are made again.
pub(in crate::jobs) fn basis(settings: &JobSettings) -> String {
    let RiskQuestion { risk_window, within, act_at_risk } = settings.asked();
    let AlertSettings { risk_raise, risk_clear, threshold_clear } = settings.alerts;
    format!(
        "elevon {}, lives of model {FLEET_MODEL}, risk within {within} of window {risk_window}, act at risk {act_at_risk}, \
         alerts from {risk_raise} to {risk_clear} and {threshold_clear}",
        crate::VERSION
    )
}

/// What is served of an actuator whose forecast panicked, so that the rest of the fleet is not lost with it.
fn failed(actuator: &Actuator, asked: &RiskQuestion, ended: JoinError) -> RemainingLife {
    let reason = format!("the forecast failed: {}", panic_text(ended));
    tracing::error!(actuator_id = %actuator.id, reason, "forecast failed");
    let mut life = predict(actuator, &LifeHistory::default(), &KnownLives::default(), asked).life;
    life.reasons = vec![reason];
    life
}

/// What was forecast, and what it tells others.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// The forecast as it is served.
    pub life: RemainingLife,
    /// What the actuator's lives say of those of its cohorts.
    pub shares: Vec<FleetShare>,
}

/// The forecast of one fault, and what it was made from and for.
struct Told {
    fault: AskedFault,
    prognosis: Result<Prognosis, PrognosisError>,
    learnt_from: LearntFrom,
    elapsed_s: f64,
}

/// Forecasts from the history of a life, ascending by time of recording, and from what is known of other lives.
#[must_use]
pub fn predict(actuator: &Actuator, history: &LifeHistory, known: &KnownLives, asked: &RiskQuestion) -> Predicted {
    let started = Instant::now();
    let unit = actuator.usage_unit;
    let faults = AskedFault::all(actuator, asked.risk_window);
    let mut shares = Vec::new();
    let [kgm, fdj_n] = [0, 1].map(|i| {
        let (fault, started) = (faults[i], Instant::now());
        let mut lives = fleet::evidence(&known.earlier, &fault);
        let comparable = fault.is_seen_from_new(history);
        let (prior, learnt_from) = match &known.taken {
            Some(taken) => {
                let Taken { prior, learnt_from } = taken[i].clone();
                (prior.map_or(LifePrior::Watched, LifePrior::Kept), learnt_from)
            }
            None if comparable => fleet::prior(&known.others[i], &lives),
            None => (LifePrior::Watched, LearntFrom::default()),
        };
        let prognosis = fault.remaining(history, prior);
        let found = prognosis.as_ref().ok();
        let own = found.and_then(|prognosis| prognosis.evidence.clone());
        lives.extend(own.filter(|_| comparable));
        let prior = found.and_then(|prognosis| prognosis.prior.as_ref());
        shares.push(fleet::share(actuator, &fault, &lives, prior));
        Told { fault, prognosis, learnt_from, elapsed_s: started.elapsed().as_secs_f64() }
    });
    let (mut parts, mut refused) = (Vec::new(), Vec::new());
    for Told { fault, prognosis, .. } in [&kgm, &fdj_n] {
        match prognosis {
            Ok(prognosis) => parts.push((fault.name, prognosis)),
            Err(error) => refused.push(format!("{} cannot be forecast: {error}", fault.name)),
        }
    }
    let mut first_to_fail = competing(&parts).expect("both faults were asked of one usage and one window");
    first_to_fail.reasons.extend(refused);
    let elapsed_s = started.elapsed().as_secs_f64();
    let at = usage(history);
    let LifeHistory { life_start_usage, records: history, .. } = history;
    let newest = history.last();
    if let Some(fallen) = history.windows(2).find(|pair| pair[1].usage < pair[0].usage) {
        let [before, after] = [0, 1].map(|i| (fallen[i].usage, fallen[i].trace_id));
        first_to_fail.reasons.push(format!(
            "usage fell from {} (trace {}) to {} (trace {}): one of them is wrong",
            before.0, before.1, after.0, after.1
        ));
    }
    if let Some(start) = life_start_usage.filter(|&start| start > at) {
        first_to_fail
            .reasons
            .push(format!("this life began at usage {start}, its newest trace has {at}: its age is unknown"));
    }
    let use_rate = UseRate::of(history);
    let answers = Answers { asked, unit, use_rate: &use_rate };
    let life = RemainingLife {
        actuator_id: actuator.id,
        as_of: newest.map(|record| record.recorded_at),
        usage: newest.map(|_| at),
        unit,
        forecast: answers.timed(&first_to_fail, elapsed_s),
        risk: answers.risk(&first_to_fail),
        act_by: answers.act_by(&first_to_fail),
        reasons: first_to_fail.reasons,
        faults: FaultForecasts { kgm: answers.fault(kgm), fdj_n: answers.fault(fdj_n) },
        use_rate,
        version: crate::VERSION.into(),
    };
    Predicted { life, shares }
}

/// What every answer of one document shares.
struct Answers<'a> {
    asked: &'a RiskQuestion,
    unit: UsageUnit,
    use_rate: &'a UseRate,
}

impl Answers<'_> {
    fn fault(&self, told: Told) -> FaultForecast {
        let Told { fault: AskedFault { threshold, .. }, prognosis, learnt_from, elapsed_s } = told;
        match prognosis {
            Ok(prognosis) => FaultForecast {
                threshold,
                forecast: self.timed(&prognosis, elapsed_s),
                risk: self.risk(&prognosis),
                act_by: self.act_by(&prognosis),
                reasons: prognosis.reasons,
                band: prognosis.band,
                changes: prognosis.changes,
                learnt_from,
            },
            Err(error) => {
                let (reasons, band, changes) = (vec![error.to_string()], Vec::new(), Vec::new());
                FaultForecast {
                    threshold,
                    forecast: None,
                    reasons,
                    risk: None,
                    act_by: None,
                    band,
                    changes,
                    learnt_from,
                }
            }
        }
    }

    fn timed(&self, prognosis: &Prognosis, elapsed_s: f64) -> Option<TimedForecast> {
        let forecast = prognosis.forecast.clone()?;
        let dates = self.use_rate.dates(&forecast.quantiles);
        Some(TimedForecast { forecast, dates, unit: self.unit, elapsed_s })
    }

    /// The risk within another span is read off the same forecast: a window of its own would change its priors.
    fn risk(&self, prognosis: &Prognosis) -> Option<Risk> {
        let within = self.asked.within;
        let probability = match prognosis.risk {
            Some(risk) if within == prognosis.risk_window => risk,
            _ => 1.0 - prognosis.survival(within)?,
        };
        Some(Risk { within, probability })
    }

    fn act_by(&self, prognosis: &Prognosis) -> Option<ActBy> {
        let forecast = prognosis.forecast.as_ref()?;
        let risk = self.asked.act_at_risk;
        let remaining = prognosis.quantile(risk);
        let date = remaining.and_then(|remaining| self.use_rate.date(remaining));
        let reason = match (remaining, date) {
            (None, _) => {
                let (horizon, unit) = (forecast.horizon, self.unit.name().replace('_', " "));
                Some(format!("the risk stays below {risk} up to the horizon, {horizon} {unit} ahead"))
            }
            (_, None) => Some(match &self.use_rate.reason {
                Some(reason) => format!("no date: {reason}"),
                None => "no date: it lies beyond the year 9999".to_owned(),
            }),
            _ => None,
        };
        Some(ActBy { risk, remaining, usage: remaining.map(|remaining| forecast.at + remaining), date, reason })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::estimation::Verdict;
    use crate::models::fault::FDJ_NOMINAL_N;
    use crate::store::records::{HealthRecord, Thresholds};

    const ASKED: RiskQuestion = RiskQuestion { risk_window: 100.0, within: 100.0, act_at_risk: 0.05 };

    fn actuator(thresholds: Thresholds) -> Actuator {
        Actuator {
            id: Id::now(),
            serial_number: "A".into(),
            tail_number: "B".into(),
            location: String::new(),
            parameter_set: "reference".into(),
            parameter_set_hash: "00".into(),
            thresholds,
            usage_unit: UsageUnit::FlightCycles,
            created_at: records::now(),
            revision: 0,
        }
    }

    /// KGM and FDJ that grow by as much every 100 cycles; the last trace determined nothing.
    fn history(kgm_step: f64, fdj_step_n: f64, life_start_usage: Option<f64>) -> LifeHistory {
        let record = |i: i32| HealthRecord {
            trace_id: Id::now(),
            job_id: Id::now(),
            recorded_at: Timestamp::from_second(i64::from(i)).unwrap(),
            usage: 100.0 * f64::from(i),
            kgm: (i < 10).then(|| kgm_step * f64::from(i)),
            kgm_std: (i < 10).then_some(0.005),
            fdj_n: (i < 10).then(|| FDJ_NOMINAL_N + fdj_step_n * f64::from(i)),
            fdj_n_std: (i < 10).then_some(5.0),
            faults: BTreeMap::new(),
            verdict: if i < 10 { Verdict::Conclusive } else { Verdict::Inconclusive },
        };
        LifeHistory { life_start_usage, records: (0..=10).map(record).collect(), ..LifeHistory::default() }
    }

    /// The forecast of a fleet's first actuator.
    fn forecast_of(actuator: &Actuator, history: &LifeHistory, asked: &RiskQuestion) -> RemainingLife {
        predict(actuator, history, &KnownLives::default(), asked).life
    }

    fn median(forecast: Option<&TimedForecast>) -> f64 {
        forecast.unwrap().forecast.quantiles.q50.unwrap()
    }

    #[test]
    fn the_actuator_fails_with_its_first_fault_and_remaining_life_counts_from_the_newest_trace() {
        let life = forecast_of(&actuator(Thresholds::default()), &history(0.03, 5.0, None), &ASKED);
        assert_eq!((life.usage, life.unit), (Some(1000.0), UsageUnit::FlightCycles));
        assert_eq!(life.as_of, Some(Timestamp::from_second(10).unwrap()));
        let (all, kgm) = (median(life.forecast.as_ref()), median(life.faults.kgm.forecast.as_ref()));
        assert!((250.0..420.0).contains(&kgm), "0.3 of 0.4 in 1000 cycles: {kgm}");
        assert!(all <= kgm && all > 0.9 * kgm, "{all} {kgm}");
        let risks = [life.risk, life.faults.kgm.risk, life.faults.fdj_n.risk].map(Option::unwrap);
        assert!(risks.iter().all(|risk| risk.within == 100.0 && (0.0..=1.0).contains(&risk.probability)), "{risks:?}");
        assert!(risks[0].probability >= risks[1].probability.max(risks[2].probability), "{risks:?}");
        assert!(!life.faults.kgm.band.is_empty() && life.faults.fdj_n.threshold == 1000.0);
    }

    #[test]
    fn without_an_observation_there_is_no_forecast_but_a_reason() {
        for life_start_usage in [None, Some(500.0)] {
            let history = LifeHistory { life_start_usage, ..LifeHistory::default() };
            let life = forecast_of(&actuator(Thresholds::default()), &history, &ASKED);
            assert_eq!((life.as_of, life.usage, life.risk, &life.act_by), (None, None, None, &None));
            assert_eq!((life.use_rate.per_day, life.use_rate.traces), (None, 0));
            assert!(life.forecast.is_none() && life.faults.kgm.forecast.is_none());
            assert!(life.reasons.iter().any(|reason| reason.contains("no observation")), "{:?}", life.reasons);
            assert!(!life.faults.fdj_n.reasons.is_empty());
        }
    }

    #[test]
    fn a_life_that_began_after_its_newest_usage_is_forecast_with_a_reason() {
        let life = forecast_of(&actuator(Thresholds::default()), &history(0.03, 5.0, Some(5000.0)), &ASKED);
        assert!(life.forecast.is_some());
        assert!(life.reasons.iter().any(|reason| reason.contains("5000")), "{:?}", life.reasons);
    }

    #[test]
    fn a_newer_trace_with_less_usage_is_named_and_does_not_wipe_out_the_history() {
        let sound = history(0.03, 5.0, None);
        let mut mistyped = sound.clone();
        mistyped.records[10].usage = 45.0;
        let life = forecast_of(&actuator(Thresholds::default()), &mistyped, &ASKED);
        assert_eq!(life.usage, Some(900.0));
        assert!(life.reasons.iter().any(|reason| reason.contains("usage fell from 900")), "{:?}", life.reasons);
        let expected = median(forecast_of(&actuator(Thresholds::default()), &sound, &ASKED).forecast.as_ref());
        assert!((median(life.forecast.as_ref()) - expected - 100.0).abs() < 0.2 * expected, "{life:?}");
    }

    #[test]
    fn a_fault_that_cannot_be_forecast_leaves_the_other() {
        let thresholds = Thresholds { kgm: 1e-9, fdj_n: 1000.0 };
        let life = forecast_of(&actuator(thresholds), &history(0.03, 40.0, None), &ASKED);
        assert!(life.faults.kgm.forecast.is_none() && life.faults.kgm.reasons[0].contains("history["));
        assert!(life.reasons.iter().any(|reason| reason.starts_with("kgm cannot")), "{:?}", life.reasons);
        assert_eq!(median(life.forecast.as_ref()), median(life.faults.fdj_n.forecast.as_ref()));
    }

    #[test]
    fn every_quantile_has_its_date_at_the_rate_of_use() {
        // One trace a second, each with 100 cycles more.
        let life = forecast_of(&actuator(Thresholds::default()), &history(0.03, 5.0, None), &ASKED);
        assert!((life.use_rate.per_day.unwrap() - 100.0 * 86_400.0).abs() < 1.0, "{:?}", life.use_rate);
        for timed in [&life.forecast, &life.faults.kgm.forecast, &life.faults.fdj_n.forecast].map(Option::as_ref) {
            let TimedForecast { forecast, dates, .. } = timed.unwrap();
            for (p, quantile) in forecast.quantiles.pairs() {
                let expected = quantile.map(|cycles| 10.0 + cycles / 100.0);
                let date = dates[&p.to_string()].map(|date| date.as_second() as f64);
                assert_eq!(date.is_some(), expected.is_some());
                assert!(
                    date.zip(expected).is_none_or(|(date, expected)| (date - expected).abs() <= 1.0),
                    "{p}: {dates:?}"
                );
            }
        }
    }

    #[test]
    fn to_act_by_is_the_quantile_of_the_risk_with_its_usage_and_date() {
        let worn = history(0.03, 5.0, None);
        let life = forecast_of(&actuator(Thresholds::default()), &worn, &ASKED);
        let act_by = life.act_by.unwrap();
        let forecast = life.forecast.unwrap();
        assert_eq!((act_by.risk, act_by.remaining), (0.05, forecast.forecast.quantiles.q05));
        assert_eq!(act_by.usage, act_by.remaining.map(|remaining| 1000.0 + remaining));
        assert_eq!((act_by.date, act_by.reason), (forecast.dates["0.05"], None));
        let kgm = life.faults.kgm.act_by.unwrap();
        assert!(kgm.remaining >= act_by.remaining, "the actuator acts no later than its faults");

        let other = RiskQuestion { within: 250.0, act_at_risk: 0.3, ..ASKED };
        let asked = forecast_of(&actuator(Thresholds::default()), &worn, &other);
        let later = asked.act_by.unwrap();
        assert!(later.remaining > act_by.remaining && later.remaining < forecast.forecast.quantiles.q50);
        let risk = asked.risk.unwrap();
        assert!(risk.within == 250.0 && risk.probability > life.risk.unwrap().probability, "{risk:?}");
        assert_eq!(asked.forecast.unwrap().forecast, forecast.forecast, "the question does not move the forecast");
        let same = RiskQuestion { within: later.remaining.unwrap(), ..ASKED };
        let risk = forecast_of(&actuator(Thresholds::default()), &worn, &same).risk.unwrap();
        assert!((risk.probability - 0.3).abs() < 1e-3, "{risk:?}");
    }

    #[test]
    fn a_risk_that_is_not_reached_within_the_horizon_has_a_reason_and_no_date() {
        let never = RiskQuestion { act_at_risk: 1.0 - 1e-9, ..ASKED };
        let life = forecast_of(&actuator(Thresholds::default()), &history(0.0005, 0.0, None), &never);
        let act_by = life.act_by.unwrap();
        assert_eq!((act_by.remaining, act_by.usage, act_by.date), (None, None, None));
        let reason = act_by.reason.unwrap();
        assert!(reason.contains("up to the horizon, 20000 flight cycles ahead"), "{reason}");
        let mut at_once = history(0.03, 5.0, None);
        at_once.records.iter_mut().for_each(|record| record.recorded_at = Timestamp::UNIX_EPOCH);
        let life = forecast_of(&actuator(Thresholds::default()), &at_once, &ASKED);
        let act_by = life.act_by.unwrap();
        assert!(act_by.usage.is_some() && act_by.date.is_none(), "{act_by:?}");
        assert!(act_by.reason.as_ref().unwrap().starts_with("no date: time does not advance"), "{act_by:?}");
        assert!(life.forecast.unwrap().dates.values().all(Option::is_none));
    }
}
