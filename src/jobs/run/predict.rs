//! Forecasts: from an actuator's history to the document that is served and to the figures that the fleet is ranked by.

use std::sync::Arc;
use std::time::Instant;

use jiff::Timestamp;
use serde::Serialize;
use tokio::task::{JoinError, spawn_blocking};
use utoipa::ToSchema;

use super::{Compute, panic_text};
use crate::jobs::JobSettings;
use crate::jobs::alerts::{self, AlertSettings, Evidence};
use crate::models::fault::FDJ_NOMINAL_N;
use crate::prognostics::{
    BandPoint, Direction, Forecast, Observation, Prognosis, PrognosisError, Question, competing, remaining_life,
};
use crate::store::records::{self, Actuator, ForecastRecord, HealthRecord, Id, UsageUnit};
use crate::store::{LifeHistory, Records, StoreError};

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
    /// The 90 % band of the fault's level ahead.
    pub band: Vec<BandPoint>,
}

/// The stored forecast if it is of the actuator's revision or a later one, else a new one, which is then stored with the
/// alerts that it raises and clears.
pub(in crate::jobs) async fn forecast(
    records: &dyn Records,
    compute: Arc<dyn Compute>,
    actuator: &Actuator,
    settings: &JobSettings,
) -> Result<ForecastRecord, StoreError> {
    let risk_window = settings.risk_window;
    if let Some(stored) = records.forecast(actuator.id).await?
        && stored.revision >= actuator.revision
    {
        return Ok(stored);
    }
    let unknown = LifeHistory { revision: actuator.revision, ..LifeHistory::default() };
    let history = records.life_history(actuator.id).await?.unwrap_or(unknown);
    let (revision, evidence) = (history.revision, Evidence::of(&history));
    let known = actuator.clone();
    let life = match spawn_blocking(move || compute.predict(&known, &history, risk_window)).await {
        Ok(life) => life,
        Err(ended) => failed(actuator, risk_window, ended),
    };
    let forecast = ForecastRecord {
        actuator_id: actuator.id,
        revision,
        risk: life.risk.map(|risk| risk.probability),
        median_remaining: life.forecast.as_ref().and_then(|timed| timed.forecast.quantiles.q50),
        document: serde_json::to_value(&life).expect("a forecast's fields have names"),
        basis: basis(settings),
        created_at: records::now(),
    };
    // When the history moved on meanwhile this one is still right for who asked, and whoever moved it makes the next.
    let open = records.open_alerts(actuator.id).await?;
    let changes = alerts::changes(actuator, &life, &evidence, &open, &settings.alerts, forecast.created_at);
    records.store_forecast_and_alerts(&forecast, &changes).await?;
    Ok(forecast)
}

/// What a forecast rests on besides the history: when it changes, stored forecasts are made again.
pub(in crate::jobs) fn basis(settings: &JobSettings) -> String {
    let AlertSettings { risk_raise, risk_clear, threshold_clear } = settings.alerts;
    let alerts = format!("alerts from {risk_raise} to {risk_clear} and {threshold_clear}");
    format!("elevon {}, risk within {}, {alerts}", crate::VERSION, settings.risk_window)
}

/// What is served of an actuator whose forecast panicked, so that the rest of the fleet is not lost with it.
fn failed(actuator: &Actuator, risk_window: f64, ended: JoinError) -> RemainingLife {
    let reason = format!("the forecast failed: {}", panic_text(ended));
    tracing::error!(actuator_id = %actuator.id, reason, "forecast failed");
    let mut life = predict(actuator, &LifeHistory::default(), risk_window);
    life.reasons = vec![reason];
    life
}

/// Forecasts from the history of a life, ascending by time of recording.
#[must_use]
pub fn predict(actuator: &Actuator, history: &LifeHistory, risk_window: f64) -> RemainingLife {
    let started = Instant::now();
    let unit = actuator.usage_unit;
    let LifeHistory { life_start_usage, records: history, .. } = history;
    let newest = history.last();
    // Usage never falls: a newer trace with less usage is in doubt, not all those before it.
    let at = history.iter().map(|record| record.usage).reduce(f64::max).or(*life_start_usage).unwrap_or(0.0);
    let life_start = life_start_usage.filter(|&start| start <= at);
    let ask = |threshold, healthy, figure: fn(&HealthRecord) -> (Option<f64>, Option<f64>)| {
        let direction = Direction::Rising;
        let question = Question { threshold, direction, healthy, at, life_start, horizon: None, risk_window };
        remaining_life(&observations(history, figure), &question)
    };
    let kgm = ask(actuator.thresholds.kgm, 0.0, |record| (record.kgm, record.kgm_std));
    let kgm_s = started.elapsed().as_secs_f64();
    let fdj = ask(actuator.thresholds.fdj_n, FDJ_NOMINAL_N, |record| (record.fdj_n, record.fdj_n_std));
    let elapsed_s = started.elapsed().as_secs_f64();
    let (mut parts, mut refused) = (Vec::new(), Vec::new());
    for (name, prognosis) in [("kgm", &kgm), ("fdj_n", &fdj)] {
        match prognosis {
            Ok(prognosis) => parts.push((name, prognosis)),
            Err(error) => refused.push(format!("{name} cannot be forecast: {error}")),
        }
    }
    let mut first_to_fail = competing(&parts).expect("both faults were asked of one usage and one window");
    first_to_fail.reasons.extend(refused);
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
    RemainingLife {
        actuator_id: actuator.id,
        as_of: newest.map(|record| record.recorded_at),
        usage: newest.map(|_| at),
        unit,
        forecast: timed(&first_to_fail, unit, elapsed_s),
        risk: risk(&first_to_fail),
        reasons: first_to_fail.reasons,
        faults: FaultForecasts {
            kgm: shown(kgm, actuator.thresholds.kgm, unit, kgm_s),
            fdj_n: shown(fdj, actuator.thresholds.fdj_n, unit, elapsed_s - kgm_s),
        },
        version: crate::VERSION.into(),
    }
}

/// What was observed of one fault, in the order of usage.
fn observations(history: &[HealthRecord], figure: fn(&HealthRecord) -> (Option<f64>, Option<f64>)) -> Vec<Observation> {
    let observe = |record: &HealthRecord| {
        let (value, std) = figure(record);
        Some(Observation { usage: record.usage, value: value?, std })
    };
    let mut observations: Vec<_> = history.iter().filter_map(observe).collect();
    observations.sort_by(|a, b| a.usage.total_cmp(&b.usage));
    observations
}

fn shown(
    prognosis: Result<Prognosis, PrognosisError>,
    threshold: f64,
    unit: UsageUnit,
    elapsed_s: f64,
) -> FaultForecast {
    match prognosis {
        Ok(prognosis) => FaultForecast {
            threshold,
            forecast: timed(&prognosis, unit, elapsed_s),
            risk: risk(&prognosis),
            reasons: prognosis.reasons,
            band: prognosis.band,
        },
        Err(error) => {
            FaultForecast { threshold, forecast: None, reasons: vec![error.to_string()], risk: None, band: Vec::new() }
        }
    }
}

fn timed(prognosis: &Prognosis, unit: UsageUnit, elapsed_s: f64) -> Option<TimedForecast> {
    prognosis.forecast.clone().map(|forecast| TimedForecast { forecast, unit, elapsed_s })
}

fn risk(prognosis: &Prognosis) -> Option<Risk> {
    prognosis.risk.map(|probability| Risk { within: prognosis.risk_window, probability })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::estimation::Verdict;
    use crate::store::records::Thresholds;

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
        LifeHistory { revision: 0, life_start_usage, records: (0..=10).map(record).collect() }
    }

    fn median(forecast: Option<&TimedForecast>) -> f64 {
        forecast.unwrap().forecast.quantiles.q50.unwrap()
    }

    #[test]
    fn the_actuator_fails_with_its_first_fault_and_remaining_life_counts_from_the_newest_trace() {
        let life = predict(&actuator(Thresholds::default()), &history(0.03, 5.0, None), 100.0);
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
            let life = predict(&actuator(Thresholds::default()), &history, 100.0);
            assert_eq!((life.as_of, life.usage, life.risk), (None, None, None));
            assert!(life.forecast.is_none() && life.faults.kgm.forecast.is_none());
            assert!(life.reasons.iter().any(|reason| reason.contains("no observation")), "{:?}", life.reasons);
            assert!(!life.faults.fdj_n.reasons.is_empty());
        }
    }

    #[test]
    fn a_life_that_began_after_its_newest_usage_is_forecast_with_a_reason() {
        let life = predict(&actuator(Thresholds::default()), &history(0.03, 5.0, Some(5000.0)), 100.0);
        assert!(life.forecast.is_some());
        assert!(life.reasons.iter().any(|reason| reason.contains("5000")), "{:?}", life.reasons);
    }

    #[test]
    fn a_newer_trace_with_less_usage_is_named_and_does_not_wipe_out_the_history() {
        let sound = history(0.03, 5.0, None);
        let mut mistyped = sound.clone();
        mistyped.records[10].usage = 45.0;
        let life = predict(&actuator(Thresholds::default()), &mistyped, 100.0);
        assert_eq!(life.usage, Some(900.0));
        assert!(life.reasons.iter().any(|reason| reason.contains("usage fell from 900")), "{:?}", life.reasons);
        let expected = median(predict(&actuator(Thresholds::default()), &sound, 100.0).forecast.as_ref());
        assert!((median(life.forecast.as_ref()) - expected - 100.0).abs() < 0.2 * expected, "{life:?}");
    }

    #[test]
    fn a_fault_that_cannot_be_forecast_leaves_the_other() {
        let thresholds = Thresholds { kgm: 1e-9, fdj_n: 1000.0 };
        let life = predict(&actuator(thresholds), &history(0.03, 40.0, None), 100.0);
        assert!(life.faults.kgm.forecast.is_none() && life.faults.kgm.reasons[0].contains("history["));
        assert!(life.reasons.iter().any(|reason| reason.starts_with("kgm cannot")), "{:?}", life.reasons);
        assert_eq!(median(life.forecast.as_ref()), median(life.faults.fdj_n.forecast.as_ref()));
    }
}
