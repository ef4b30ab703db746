//! Traces' records in SQLite.

use sqlx::SqliteConnection;
use sqlx::sqlite::SqlitePool;

use super::begin;
use super::row::{Reader, micros, signed};
use crate::store::StoreError;
use crate::store::records::{Id, TraceRecord};

const INSERT: &str = "INSERT INTO traces
    (id, actuator_id, recorded_at, usage, media_type, columns, sample_rate_hz, size_bytes, sha256, samples, duration_s,
    created_at) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)";
const ONE: &str = "SELECT id, actuator_id, recorded_at, usage, media_type, columns, sample_rate_hz, size_bytes, sha256,
    samples, duration_s, excluded, reason, created_at FROM traces WHERE id = ?1";
const EXCLUDE: &str = "UPDATE traces SET excluded = ?2, reason = ?3 WHERE id = ?1";
const HIDE: &str =
    "UPDATE health SET excluded = ?2 WHERE excluded <> ?2 AND trace_id = ?1 AND (actuator_id, recorded_at) =
    (SELECT actuator_id, recorded_at FROM traces WHERE id = ?1)";
const GROW: &str =
    "UPDATE actuators SET revision = revision + 1 WHERE id = (SELECT actuator_id FROM traces WHERE id = ?1)";

const UNRECORDED: &str =
    "SELECT given.value FROM json_each(?1) AS given WHERE NOT EXISTS (SELECT 1 FROM traces WHERE id = given.value)";

pub(super) async fn insert(connection: &mut SqliteConnection, trace: &TraceRecord) -> Result<(), StoreError> {
    sqlx::query(INSERT)
        .bind(trace.id.to_string())
        .bind(trace.actuator_id.map(|id| id.to_string()))
        .bind(trace.recorded_at.map(micros))
        .bind(trace.usage)
        .bind(&trace.media_type)
        .bind(&trace.columns)
        .bind(trace.sample_rate_hz)
        .bind(signed(trace.size_bytes))
        .bind(&trace.sha256)
        .bind(signed(trace.samples))
        .bind(trace.duration_s)
        .bind(micros(trace.created_at))
        .execute(connection)
        .await?;
    Ok(())
}

pub(super) async fn unrecorded(readers: &SqlitePool, ids: &[Id]) -> Result<Vec<Id>, StoreError> {
    let given = serde_json::to_string(ids).expect("ids are strings");
    let rows = sqlx::query(UNRECORDED).bind(given).fetch_all(readers).await?;
    rows.iter().map(|row| Reader::new(row, "trace", 0).id()).collect()
}

/// Excludes a trace or takes it back, and lets its actuator's history follow.
pub(super) async fn exclude(
    writer: &SqlitePool,
    id: Id,
    excluded: bool,
    reason: &str,
) -> Result<Option<TraceRecord>, StoreError> {
    let mut transaction = begin(writer).await?;
    let text = id.to_string();
    sqlx::query(EXCLUDE).bind(&text).bind(excluded).bind(reason).execute(&mut *transaction).await?;
    let changed = sqlx::query(HIDE).bind(&text).bind(excluded).execute(&mut *transaction).await?;
    if changed.rows_affected() > 0 {
        sqlx::query(GROW).bind(&text).execute(&mut *transaction).await?;
    }
    let trace = one(&mut *transaction, id).await?;
    transaction.commit().await?;
    Ok(trace)
}

pub(super) async fn one(executor: impl sqlx::SqliteExecutor<'_>, id: Id) -> Result<Option<TraceRecord>, StoreError> {
    let Some(row) = sqlx::query(ONE).bind(id.to_string()).fetch_optional(executor).await? else {
        return Ok(None);
    };
    let mut row = Reader::new(&row, "trace", 0);
    Ok(Some(TraceRecord {
        id: row.id()?,
        actuator_id: row.id_or_null()?,
        recorded_at: row.time_or_null()?,
        usage: row.value()?,
        media_type: row.value()?,
        columns: row.value()?,
        sample_rate_hz: row.value()?,
        size_bytes: row.count()?,
        sha256: row.value()?,
        samples: row.count()?,
        duration_s: row.value()?,
        excluded: row.value()?,
        reason: row.value()?,
        created_at: row.time()?,
    }))
}
