//! Baselines from the records: what each life of an actuator was like when it began, and what has grown since.
//!
//! They are derived whenever they are read (docs/decisions/0008).

use jiff::Timestamp;

use super::lives::{Life, lives};
use crate::estimation::Verdict;
use crate::estimation::request::Fault;
use crate::models::fault::FDJ_NOMINAL_N;
use crate::prognostics::baseline::{self, Baseline, Figure, Gathering, Healthy, PassedOver, Reading};
use crate::store::records::{Actuator, HealthRecord, Id, Thresholds};
use crate::store::{Page, Paged, Records, StoreError};

/// The most records of a life that are looked at: an actuator that was not healthy in as many was not when it was new.
pub const LOOKED_AT_MAX: usize = 500;
/// Records that are read at once; a life that begins as it should needs no more.
const AT_ONCE: u32 = 50;
/// How often a history is read again when it changes meanwhile.
const TRIES: usize = 3;

/// The beginning of a life, and the baseline that it makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// The life.
    pub life: Life,
    /// The traces that are taken, ascending by time of recording.
    pub taken: Vec<HealthRecord>,
    /// Conclusive traces that are not, and why.
    pub passed_over: Vec<(HealthRecord, PassedOver)>,
    /// The baseline, once it is complete.
    pub baseline: Option<Baseline>,
    /// Whether [`LOOKED_AT_MAX`] records did not complete it: then nothing will but a change to them.
    pub given_up: bool,
}

/// A record of a history with the growth since the baseline of its life; null for the traces of the baseline itself, for
/// those before its last one, and until it is complete.
#[derive(Debug, Clone, PartialEq)]
pub struct Grown {
    /// The record.
    pub record: HealthRecord,
    /// Growth of KGM, and its standard deviation.
    pub kgm: (Option<f64>, Option<f64>),
    /// Growth of FDJ, N, and its standard deviation.
    pub fdj_n: (Option<f64>, Option<f64>),
}

/// Below half of the way from a new actuator to its thresholds: KGM from 0, FDJ from 200 N.
#[must_use]
pub fn healthy(thresholds: &Thresholds) -> Healthy {
    let half = |new: f64, threshold: f64| new + 0.5 * (threshold - new);
    Healthy { kgm_below: half(0.0, thresholds.kgm), fdj_n_below: half(FDJ_NOMINAL_N, thresholds.fdj_n) }
}

/// The beginning of the current life.
///
/// # Errors
/// The store fails.
pub async fn current(records: &dyn Records, actuator: &Actuator, wanted: usize) -> Result<Opening, StoreError> {
    for _ in 1..TRIES {
        let revision = revision(records, actuator.id).await?;
        let opening = current_once(records, actuator, wanted).await?;
        if self::revision(records, actuator.id).await? == revision {
            return Ok(opening);
        }
    }
    current_once(records, actuator, wanted).await
}

async fn current_once(records: &dyn Records, actuator: &Actuator, wanted: usize) -> Result<Opening, StoreError> {
    let newest = lives(records, actuator.id).await?.pop().expect("there is a first life");
    opening(records, actuator, newest, wanted).await
}

/// A page of a history with the growth in each life.
///
/// # Errors
/// The store fails; a cursor that the history did not make.
pub async fn history(
    records: &dyn Records,
    actuator: &Actuator,
    span: (Option<Timestamp>, Option<Timestamp>),
    page: &Page,
    wanted: usize,
) -> Result<Paged<Grown>, StoreError> {
    for _ in 1..TRIES {
        let revision = revision(records, actuator.id).await?;
        let found = history_once(records, actuator, span, page, wanted).await?;
        if self::revision(records, actuator.id).await? == revision {
            return Ok(found);
        }
    }
    history_once(records, actuator, span, page, wanted).await
}

async fn history_once(
    records: &dyn Records,
    actuator: &Actuator,
    (from, to): (Option<Timestamp>, Option<Timestamp>),
    page: &Page,
    wanted: usize,
) -> Result<Paged<Grown>, StoreError> {
    let Paged { items, next_cursor } = records.health(actuator.id, from, to, page).await?;
    let mut found = Vec::with_capacity(items.len());
    let mut items = items.into_iter().peekable();
    for life in lives(records, actuator.id).await? {
        if !items.peek().is_some_and(|record| life.has(record.recorded_at)) {
            continue;
        }
        let opening = opening(records, actuator, life, wanted).await?;
        while let Some(record) = items.next_if(|record| opening.life.has(record.recorded_at)) {
            found.push(grown(record, &opening));
        }
    }
    Ok(Paged { items: found, next_cursor })
}

fn grown(record: HealthRecord, opening: &Opening) -> Grown {
    let key = |record: &HealthRecord| (record.recorded_at, record.trace_id);
    let after = opening.taken.last().is_some_and(|last| key(last) < key(&record));
    let Some(baseline) = opening.baseline.filter(|_| after) else {
        return Grown { record, kgm: (None, None), fdj_n: (None, None) };
    };
    let since = |value: Option<f64>, std, mean| match value.map(|value| baseline::growth(value, std, mean)) {
        Some((growth, std)) => (Some(growth), std),
        None => (None, None),
    };
    let kgm = since(record.kgm, record.kgm_std, &baseline.kgm);
    let fdj_n = since(record.fdj_n, record.fdj_n_std, &baseline.fdj_n);
    Grown { record, kgm, fdj_n }
}

async fn revision(records: &dyn Records, actuator: Id) -> Result<Option<i64>, StoreError> {
    Ok(records.actuator(actuator).await?.map(|actuator| actuator.revision))
}

/// The beginning of a life: its records are read until its baseline is complete.
async fn opening(records: &dyn Records, actuator: &Actuator, life: Life, wanted: usize) -> Result<Opening, StoreError> {
    let healthy = healthy(&actuator.thresholds);
    let mut conclusive: Vec<HealthRecord> = Vec::new();
    let mut page = Page { after: None, limit: AT_ONCE };
    let mut looked_at = 0;
    loop {
        let read = records.health(actuator.id, life.since(), life.end, &page).await?;
        looked_at += read.items.len();
        conclusive.extend(read.items.into_iter().filter(|record| record.verdict == Verdict::Conclusive));
        page.after = read.next_cursor;
        let readings: Vec<_> = conclusive.iter().map(reading).collect();
        let gathering = baseline::gather(&readings, &healthy, wanted);
        let given_up = gathering.baseline.is_none() && looked_at >= LOOKED_AT_MAX;
        if gathering.baseline.is_some() || given_up || page.after.is_none() {
            let Gathering { taken, passed_over, baseline } = gathering;
            let taken = taken.into_iter().map(|place| conclusive[place].clone()).collect();
            let passed_over = passed_over.into_iter().map(|(place, why)| (conclusive[place].clone(), why)).collect();
            return Ok(Opening { life, taken, passed_over, baseline, given_up });
        }
    }
}

fn reading(record: &HealthRecord) -> Reading {
    let name = Fault::CurrentOffset.key();
    let other = |name: &str| record.faults.get(name).copied().flatten();
    Reading {
        kgm: Figure::of(record.kgm, record.kgm_std),
        fdj_n: Figure::of(record.fdj_n, record.fdj_n_std),
        current_offset_a: Figure::of(other(name), other(&format!("{name}_std"))),
    }
}
