//! Histories in SQLite: estimates and maintenance, and the life that they make up.

use jiff::Timestamp;
use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{Row as _, SqliteConnection};

use super::row::{Reader, micros};
use super::{alerts, begin};
use crate::estimation::Estimate;
use crate::store::records::{HealthRecord, Id, Maintenance};
use crate::store::{LifeHistory, Page, Paged, StoreError};

const KEEP: &str = "INSERT INTO health
    (actuator_id, recorded_at, trace_id, job_id, usage, kgm, kgm_std, fdj_n, fdj_n_std, faults, verdict,
    excluded) SELECT actuator_id, recorded_at, id, ?2, usage, ?3, ?4, ?5, ?6, ?7, ?8, excluded FROM traces
    WHERE id = ?1 AND actuator_id IS NOT NULL AND recorded_at IS NOT NULL AND usage IS NOT NULL
    ON CONFLICT (actuator_id, recorded_at, trace_id) DO UPDATE SET job_id = excluded.job_id,
    kgm = excluded.kgm, kgm_std = excluded.kgm_std, fdj_n = excluded.fdj_n, fdj_n_std = excluded.fdj_n_std,
    faults = excluded.faults, verdict = excluded.verdict WHERE excluded.job_id >= health.job_id";
pub(super) const LIST: &str = "SELECT trace_id, job_id, recorded_at, usage, kgm, kgm_std, fdj_n, fdj_n_std, faults,
    verdict FROM health WHERE actuator_id = ?1 AND (recorded_at, trace_id) > (?2, ?3) AND recorded_at < ?4 AND excluded = 0
    ORDER BY recorded_at, trace_id LIMIT ?5";
pub(super) const LIFE: &str = "SELECT trace_id, job_id, recorded_at, usage, kgm, kgm_std, fdj_n, fdj_n_std, faults,
    verdict FROM health WHERE actuator_id = ?1 AND recorded_at >= ?2 AND excluded = 0 ORDER BY recorded_at, trace_id";
pub(super) const LIFE_START: &str = "SELECT at, usage FROM maintenance
    WHERE actuator_id = ?1 AND kind IN ('replaced', 'overhauled') ORDER BY at DESC, id DESC LIMIT 1";
pub(super) const MAINTENANCE: &str = "SELECT id, actuator_id, kind, at, usage, note, created_at
    FROM maintenance WHERE actuator_id = ?1 AND (at, id) > (?2, ?3) ORDER BY at, id LIMIT ?4";

/// Keeps what a job found in a trace, if the trace is of an actuator, within the transaction that ends the job. Of two
/// estimates of a trace the newer is that of the job that was asked for later, whichever ends first.
pub(super) async fn keep_estimate(
    connection: &mut SqliteConnection,
    trace: Id,
    job: Id,
    estimate: &Estimate,
) -> Result<(), StoreError> {
    let kept = sqlx::query(KEEP)
        .bind(trace.to_string())
        .bind(job.to_string())
        .bind(estimate.kgm)
        .bind(estimate.kgm_std)
        .bind(estimate.fdj_n)
        .bind(estimate.fdj_n_std)
        .bind(serde_json::to_string(&estimate.faults).expect("faults have names"))
        .bind(estimate.verdict.name())
        .execute(&mut *connection)
        .await?;
    if kept.rows_affected() == 0 {
        return Ok(());
    }
    sqlx::query(
        "UPDATE actuators SET revision = revision + 1 WHERE id = (SELECT actuator_id FROM traces WHERE id = ?1)",
    )
    .bind(trace.to_string())
    .execute(connection)
    .await?;
    Ok(())
}

pub(super) async fn list(
    readers: &SqlitePool,
    actuator: Id,
    from: Option<Timestamp>,
    to: Option<Timestamp>,
    page: &Page,
) -> Result<Paged<HealthRecord>, StoreError> {
    let (first, last) =
        (from.map(|at| at.to_string()).unwrap_or_default(), to.map(|at| at.to_string()).unwrap_or_default());
    let actuator = actuator.to_string();
    let of = ["health", &actuator, &first, &last];
    let after = page.start::<(i64, Id)>(&of)?.map(|(at, trace)| (at, trace.to_string()));
    let from = from.map(|at| (micros(at), String::new()));
    let (at, trace) = from.max(after).unwrap_or((i64::MIN, String::new()));
    let rows = sqlx::query(LIST)
        .bind(&actuator)
        .bind(at)
        .bind(trace)
        .bind(to.map_or(i64::MAX, micros))
        .bind(page.rows())
        .fetch_all(readers)
        .await?;
    let items = rows.iter().map(|row| read(row, 0)).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, |record: &HealthRecord| (micros(record.recorded_at), record.trace_id)))
}

pub(super) async fn life(readers: &SqlitePool, actuator: Id) -> Result<Option<LifeHistory>, StoreError> {
    let id = actuator.to_string();
    let mut snapshot = readers.begin().await?;
    let Some(row) =
        sqlx::query("SELECT revision FROM actuators WHERE id = ?1").bind(&id).fetch_optional(&mut *snapshot).await?
    else {
        return Ok(None);
    };
    let revision = row.try_get(0)?;
    let start = sqlx::query(LIFE_START).bind(&id).fetch_optional(&mut *snapshot).await?;
    let (life_started_at, life_start_usage) = match &start {
        Some(row) => {
            let mut row = Reader::new(row, "maintenance event", 0);
            (Some(row.time()?), Some(row.value()?))
        }
        None => (None, None),
    };
    let since = life_started_at.map_or(i64::MIN, micros);
    let rows = sqlx::query(LIFE).bind(&id).bind(since).fetch_all(&mut *snapshot).await?;
    let records = rows.iter().map(|row| read(row, 0)).collect::<Result<_, _>>()?;
    Ok(Some(LifeHistory { revision, life_started_at, life_start_usage, records }))
}

pub(super) async fn insert_maintenance(writer: &SqlitePool, event: &Maintenance) -> Result<(), StoreError> {
    let mut transaction = begin(writer).await?;
    sqlx::query(
        "INSERT INTO maintenance (id, actuator_id, kind, at, usage, note, created_at) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    )
    .bind(event.id.to_string())
    .bind(event.actuator_id.to_string())
    .bind(event.kind.name())
    .bind(micros(event.at))
    .bind(event.usage)
    .bind(&event.note)
    .bind(micros(event.created_at))
    .execute(&mut *transaction)
    .await?;
    sqlx::query("UPDATE actuators SET revision = revision + 1 WHERE id = ?1")
        .bind(event.actuator_id.to_string())
        .execute(&mut *transaction)
        .await?;
    let happened = alerts::clear_former_lives(&mut transaction, event.actuator_id, event.created_at).await?;
    transaction.commit().await?;
    alerts::count(&happened);
    Ok(())
}

pub(super) async fn maintenance(
    readers: &SqlitePool,
    actuator: Id,
    page: &Page,
) -> Result<Paged<Maintenance>, StoreError> {
    let actuator = actuator.to_string();
    let of = ["maintenance", &actuator];
    let after = page.start::<(i64, Id)>(&of)?.map(|(at, id)| (at, id.to_string()));
    let (at, id) = after.unwrap_or((i64::MIN, String::new()));
    let rows = sqlx::query(MAINTENANCE).bind(&actuator).bind(at).bind(id).bind(page.rows()).fetch_all(readers).await?;
    let items = rows.iter().map(read_maintenance).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, |event: &Maintenance| (micros(event.at), event.id)))
}

/// Reads the columns of [`LIST`] from column `first` on.
pub(super) fn read(row: &SqliteRow, first: usize) -> Result<HealthRecord, StoreError> {
    let mut row = Reader::new(row, "health record", first);
    Ok(HealthRecord {
        trace_id: row.id()?,
        job_id: row.id()?,
        recorded_at: row.time()?,
        usage: row.value()?,
        kgm: row.value()?,
        kgm_std: row.value()?,
        fdj_n: row.value()?,
        fdj_n_std: row.value()?,
        faults: row.document()?,
        verdict: row.name()?,
    })
}

fn read_maintenance(row: &SqliteRow) -> Result<Maintenance, StoreError> {
    let mut row = Reader::new(row, "maintenance event", 0);
    Ok(Maintenance {
        id: row.id()?,
        actuator_id: row.id()?,
        kind: row.name()?,
        at: row.time()?,
        usage: row.value()?,
        note: row.value()?,
        created_at: row.time()?,
    })
}
