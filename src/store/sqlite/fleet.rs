//! Forecasts in SQLite, and the fleet in the order of its risk.

use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{Row as _, ValueRef as _};

use super::row::{Reader, micros};
use super::{actuators, alerts, begin, cohorts, health, trend};
use crate::store::records::{ForecastRecord, HealthRecord, Id};
use crate::store::{FleetRow, Page, Paged, StoreError, WithForecast};

/// A page of the fleet: each actuator, its newest health record in this life, its forecast and its place in the order.
macro_rules! fleet {
    ($condition:literal) => {
        concat!(
            "SELECT a.id, a.serial_number, a.tail_number, a.location, a.parameter_set, a.parameter_set_hash,
            a.threshold_kgm, a.threshold_fdj_n, a.usage_unit, a.created_at, a.revision,
            h.trace_id, h.job_id, h.recorded_at, h.usage, h.kgm, h.kgm_std, h.fdj_n, h.fdj_n_std, h.faults,
            h.verdict,
            f.actuator_id, a.forecast_revision, a.risk, a.median_remaining, f.document, f.basis, f.created_at,
            a.risk_order, a.median_order,
            (SELECT count(*) FROM alerts l WHERE l.actuator_id = a.id AND l.cleared_at IS NULL)
            FROM actuators a
            LEFT JOIN forecasts f ON f.actuator_id = a.id
            LEFT JOIN health h ON h.actuator_id = a.id AND (h.recorded_at, h.trace_id) = (
                SELECT n.recorded_at, n.trace_id FROM health n
                WHERE n.actuator_id = a.id AND n.excluded = 0 AND n.recorded_at >= coalesce((
                    SELECT max(m.at) FROM maintenance m
                    WHERE m.actuator_id = a.id AND m.kind IN ('replaced', 'overhauled')), -9223372036854775808)
                ORDER BY n.recorded_at DESC, n.trace_id DESC LIMIT 1)
            WHERE ",
            $condition,
            " (a.risk_order, a.median_order, a.id) > (?1, ?2, ?3)
            ORDER BY a.risk_order, a.median_order, a.id LIMIT ?4"
        )
    };
}

pub(super) const FLEET: &str = fleet!("");
pub(super) const FLEET_OF_TAIL: &str = fleet!("a.tail_number = ?5 AND");
const FORECAST: &str =
    "SELECT f.actuator_id, a.forecast_revision, a.risk, a.median_remaining, f.document, f.basis, f.created_at
    FROM forecasts f JOIN actuators a ON a.id = f.actuator_id WHERE f.actuator_id = ?1";
const RANK: &str = "UPDATE actuators SET forecast_revision = ?2, risk = ?3, median_remaining = ?4
    WHERE id = ?1 AND revision = ?2";
const KEEP: &str = "INSERT INTO forecasts (actuator_id, created_at, document, basis) VALUES (?1, ?2, ?3, ?4)
    ON CONFLICT (actuator_id) DO UPDATE
    SET created_at = excluded.created_at, document = excluded.document, basis = excluded.basis";
const EXPIRE: &str = "UPDATE actuators SET forecast_revision = -1
    WHERE id IN (SELECT actuator_id FROM forecasts WHERE basis <> ?1)";
pub(super) const STALE: &str = "SELECT id FROM actuators WHERE forecast_revision <> revision ORDER BY id LIMIT ?1";

pub(super) async fn forecast(readers: &SqlitePool, actuator: Id) -> Result<Option<ForecastRecord>, StoreError> {
    let row = sqlx::query(FORECAST).bind(actuator.to_string()).fetch_optional(readers).await?;
    row.as_ref().map(|row| read(row, 0)).transpose()
}

/// Keeps a forecast with all that follows from it, or nothing.
pub(super) async fn store_forecast(
    writer: &SqlitePool,
    forecast: &ForecastRecord,
    with: &WithForecast<'_>,
) -> Result<bool, StoreError> {
    let mut transaction = begin(writer).await?;
    let ranked = sqlx::query(RANK)
        .bind(forecast.actuator_id.to_string())
        .bind(forecast.revision)
        .bind(forecast.risk)
        .bind(forecast.median_remaining)
        .execute(&mut *transaction)
        .await?;
    if ranked.rows_affected() == 0 {
        return Ok(false);
    }
    sqlx::query(KEEP)
        .bind(forecast.actuator_id.to_string())
        .bind(micros(forecast.created_at))
        .bind(forecast.document.to_string())
        .bind(&forecast.basis)
        .execute(&mut *transaction)
        .await?;
    if let Some(step) = with.step {
        trend::keep(&mut transaction, step).await?;
    }
    for share in with.shares {
        cohorts::keep(&mut transaction, forecast.actuator_id, share).await?;
    }
    let happened = alerts::apply(&mut transaction, forecast.actuator_id, with.alerts).await?;
    transaction.commit().await?;
    alerts::count(&happened);
    Ok(true)
}

pub(super) async fn expire(writer: &SqlitePool, basis: &str) -> Result<(), StoreError> {
    sqlx::query(EXPIRE).bind(basis).execute(writer).await?;
    Ok(())
}

pub(super) async fn stale(readers: &SqlitePool, limit: u32) -> Result<Vec<Id>, StoreError> {
    let rows = sqlx::query(STALE).bind(limit).fetch_all(readers).await?;
    rows.iter().map(|row| Reader::new(row, "actuator", 0).id()).collect()
}

pub(super) async fn list(
    readers: &SqlitePool,
    tail_number: Option<&str>,
    page: &Page,
) -> Result<Paged<FleetRow>, StoreError> {
    let of: &[&str] = match tail_number {
        Some(tail_number) => &["fleet", tail_number],
        None => &["fleet"],
    };
    let after = page.start::<(f64, (f64, Id))>(of)?.map(|(risk, (median, id))| (risk, median, id.to_string()));
    let (risk, median, id) = after.unwrap_or((f64::NEG_INFINITY, f64::NEG_INFINITY, String::new()));
    let query = sqlx::query(if tail_number.is_some() { FLEET_OF_TAIL } else { FLEET })
        .bind(risk)
        .bind(median)
        .bind(id)
        .bind(page.rows());
    let rows = match tail_number {
        Some(tail_number) => query.bind(tail_number).fetch_all(readers).await?,
        None => query.fetch_all(readers).await?,
    };
    let items: Vec<_> = rows.iter().map(read_row).collect::<Result<_, _>>()?;
    let Paged { items, next_cursor } =
        page.cut(of, items, |(row, order): &(FleetRow, (f64, f64))| (order.0, (order.1, row.actuator.id)));
    Ok(Paged { items: items.into_iter().map(|(row, _)| row).collect(), next_cursor })
}

/// Reads the columns of [`FORECAST`] from column `first` on.
fn read(row: &SqliteRow, first: usize) -> Result<ForecastRecord, StoreError> {
    let mut row = Reader::new(row, "forecast", first);
    Ok(ForecastRecord {
        actuator_id: row.id()?,
        revision: row.value()?,
        risk: row.value()?,
        median_remaining: row.value()?,
        document: row.json()?,
        basis: row.value()?,
        created_at: row.time()?,
    })
}

/// Reads a row of the fleet and its place in the order.
fn read_row(row: &SqliteRow) -> Result<(FleetRow, (f64, f64)), StoreError> {
    let newest: Option<HealthRecord> = if row.try_get_raw(11)?.is_null() { None } else { Some(health::read(row, 11)?) };
    let forecast = if row.try_get_raw(21)?.is_null() { None } else { Some(read(row, 21)?) };
    let order = (row.try_get(28)?, row.try_get(29)?);
    let alerts_open = row.try_get::<i64, _>(30)?.unsigned_abs();
    Ok((FleetRow { actuator: actuators::read(row)?, newest, forecast, alerts_open }, order))
}
