//! The trend: what stays of each forecast when the next is made.

use jiff::Timestamp;

use super::predict::{RemainingLife, Risk, TimedForecast, basis};
use crate::jobs::JobSettings;
use crate::store::LifeHistory;
use crate::store::records::{TrendFaults, TrendFigures, TrendRecord};

/// The step that a forecast makes in its actuator's trend; none before the first trace of the life, and of a forecast that
/// failed.
pub(super) fn step(
    made_at: Timestamp,
    settings: &JobSettings,
    life: &RemainingLife,
    history: &LifeHistory,
) -> Option<TrendRecord> {
    let newest = history.records.last()?;
    let (kgm, fdj_n) = (&life.faults.kgm, &life.faults.fdj_n);
    Some(TrendRecord {
        actuator_id: life.actuator_id,
        life_started_at: history.life_started_at,
        life_start_usage: history.life_start_usage,
        trace_id: newest.trace_id,
        recorded_at: newest.recorded_at,
        usage: life.usage?,
        made_at,
        risk_window: settings.risk_window,
        actuator: figures(life.forecast.as_ref(), life.risk),
        faults: TrendFaults {
            kgm: figures(kgm.forecast.as_ref(), kgm.risk),
            fdj_n: figures(fdj_n.forecast.as_ref(), fdj_n.risk),
        },
        basis: basis(settings),
        version: life.version.clone(),
    })
}

fn figures(forecast: Option<&TimedForecast>, risk: Option<Risk>) -> Option<TrendFigures> {
    let forecast = &forecast?.forecast;
    let quantiles = &forecast.quantiles;
    Some(TrendFigures {
        q05: quantiles.q05,
        q50: quantiles.q50,
        q95: quantiles.q95,
        mean: forecast.mean,
        reached: forecast.reached,
        risk: risk.map(|risk| risk.probability),
    })
}
