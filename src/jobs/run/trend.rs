//! The trend: what stays of each forecast when the next is made.

use jiff::{SignedDuration, Timestamp};

use super::predict::{RemainingLife, Risk, TimedForecast, basis};
use crate::jobs::baselines::Life;
use crate::jobs::{JobSettings, baselines};
use crate::store::records::{Id, TrendFaults, TrendFigures, TrendRecord};
use crate::store::{LifeHistory, Page, Paged, Records, StoreError};

/// Records that are read at once.
const AT_ONCE: u32 = 500;

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

/// The history of the life in which something was recorded at a time, up to that time: a life that may be over.
pub(super) async fn life_up_to(records: &dyn Records, actuator: Id, at: Timestamp) -> Result<LifeHistory, StoreError> {
    let Some(life) = baselines::lives(records, actuator).await?.into_iter().find(|life| life.has(at)) else {
        return Ok(LifeHistory::default());
    };
    // The end of a span is not part of it.
    let end = at.checked_add(SignedDuration::from_micros(1)).unwrap_or(at);
    life_records(records, actuator, &life, Some(end)).await
}

/// The history of a life up to a time, which is not part of it.
pub(super) async fn life_records(
    records: &dyn Records,
    actuator: Id,
    life: &Life,
    end: Option<Timestamp>,
) -> Result<LifeHistory, StoreError> {
    let mut history = LifeHistory {
        life_started_at: life.since(),
        life_start_usage: life.start.as_ref().map(|event| event.usage),
        ..LifeHistory::default()
    };
    let mut page = Page { after: None, limit: AT_ONCE };
    loop {
        let Paged { items, next_cursor } = records.health(actuator, history.life_started_at, end, &page).await?;
        history.records.extend(items);
        page.after = next_cursor;
        if page.after.is_none() {
            return Ok(history);
        }
    }
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
