//! Actuators in SQLite.

use sqlx::sqlite::{SqlitePool, SqliteRow};

use super::begin;
use super::row::{Reader, micros};
use crate::store::records::{Actuator, ActuatorUpdate, Id, Thresholds};
use crate::store::{Page, Paged, StoreError};

const INSERT: &str = "INSERT INTO actuators
    (id, serial_number, tail_number, location, parameter_set, threshold_kgm, threshold_fdj_n, usage_unit, created_at,
    revision, parameter_set_hash) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)";
const ONE: &str = "SELECT id, serial_number, tail_number, location, parameter_set, parameter_set_hash,
    threshold_kgm, threshold_fdj_n, usage_unit, created_at, revision FROM actuators WHERE id = ?1";
const CHANGE: &str = "UPDATE actuators SET parameter_set = coalesce(?2, parameter_set),
    parameter_set_hash = coalesce(?3, parameter_set_hash),
    threshold_kgm = coalesce(?4, threshold_kgm), threshold_fdj_n = coalesce(?5, threshold_fdj_n),
    revision = revision + ((coalesce(?2, parameter_set), coalesce(?4, threshold_kgm), coalesce(?5, threshold_fdj_n))
    <> (parameter_set, threshold_kgm, threshold_fdj_n))
    WHERE id = ?1";
pub(super) const LIST: &str = "SELECT id, serial_number, tail_number, location, parameter_set, parameter_set_hash,
    threshold_kgm, threshold_fdj_n, usage_unit, created_at, revision FROM actuators WHERE id > ?1 ORDER BY id LIMIT ?2";

pub(super) async fn insert(writer: &SqlitePool, actuator: &Actuator) -> Result<(), StoreError> {
    let inserted = sqlx::query(INSERT)
        .bind(actuator.id.to_string())
        .bind(&actuator.serial_number)
        .bind(&actuator.tail_number)
        .bind(&actuator.location)
        .bind(&actuator.parameter_set)
        .bind(actuator.thresholds.kgm)
        .bind(actuator.thresholds.fdj_n)
        .bind(actuator.usage_unit.name())
        .bind(micros(actuator.created_at))
        .bind(actuator.revision)
        .bind(&actuator.parameter_set_hash)
        .execute(writer)
        .await;
    match inserted {
        Err(sqlx::Error::Database(error)) if error.is_unique_violation() => {
            Err(StoreError::Conflict { field: "serial_number", value: actuator.serial_number.clone() })
        }
        other => other.map(drop).map_err(StoreError::from),
    }
}

pub(super) async fn one(readers: &SqlitePool, id: Id) -> Result<Option<Actuator>, StoreError> {
    let row = sqlx::query(ONE).bind(id.to_string()).fetch_optional(readers).await?;
    row.as_ref().map(read).transpose()
}

pub(super) async fn change(
    writer: &SqlitePool,
    id: Id,
    update: &ActuatorUpdate,
) -> Result<Option<Actuator>, StoreError> {
    let ActuatorUpdate { parameter_set, threshold_kgm, threshold_fdj_n } = update;
    let (set, hash) = parameter_set.as_ref().map(|(set, hash)| (set.as_str(), hash.as_str())).unzip();
    let mut transaction = begin(writer).await?;
    let query = sqlx::query(CHANGE).bind(id.to_string()).bind(set).bind(hash);
    query.bind(threshold_kgm).bind(threshold_fdj_n).execute(&mut *transaction).await?;
    let row = sqlx::query(ONE).bind(id.to_string()).fetch_optional(&mut *transaction).await?;
    let actuator = row.as_ref().map(read).transpose()?;
    transaction.commit().await?;
    Ok(actuator)
}

pub(super) async fn list(readers: &SqlitePool, page: &Page) -> Result<Paged<Actuator>, StoreError> {
    let after = page.start::<Id>(&["actuators"])?.map(|id| id.to_string()).unwrap_or_default();
    let rows = sqlx::query(LIST).bind(after).bind(page.rows()).fetch_all(readers).await?;
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&["actuators"], items, |actuator: &Actuator| actuator.id))
}

/// Reads the columns of [`ONE`] from the start of a row.
pub(super) fn read(row: &SqliteRow) -> Result<Actuator, StoreError> {
    let mut row = Reader::new(row, "actuator", 0);
    Ok(Actuator {
        id: row.id()?,
        serial_number: row.value()?,
        tail_number: row.value()?,
        location: row.value()?,
        parameter_set: row.value()?,
        parameter_set_hash: row.value()?,
        thresholds: Thresholds { kgm: row.value()?, fdj_n: row.value()? },
        usage_unit: row.name()?,
        created_at: row.time()?,
        revision: row.value()?,
    })
}
