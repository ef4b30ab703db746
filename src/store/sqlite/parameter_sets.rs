//! Parameter sets in SQLite: versions by name and hash, never changed.

use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{Sqlite, Transaction};

use super::begin;
use super::row::{Reader, micros};
use crate::store::records::{Id, ParameterSetRecord};
use crate::store::{Page, Paged, StoreError};

/// A query for parameter sets: which, in which order.
macro_rules! select {
    ($rest:literal) => {
        concat!("SELECT id, name, hash, parameters, created_at FROM parameter_sets ", $rest)
    };
}

const INSERT: &str = "INSERT INTO parameter_sets (id, name, hash, parameters, created_at) VALUES (?1, ?2, ?3, ?4, ?5)
    ON CONFLICT (name, hash) DO NOTHING";
pub(super) const NEWEST: &str = select!("WHERE name = ?1 ORDER BY id DESC LIMIT 1");
/// A hash is made of hexadecimal digits, all of them before `g`.
pub(super) const BY_HASH: &str = select!("WHERE name = ?1 AND hash >= ?2 AND hash < ?2 || 'g' ORDER BY hash LIMIT 2");
pub(super) const LIST: &str = select!("WHERE id > ?1 ORDER BY id LIMIT ?2");
const PIN: &str = "UPDATE actuators SET parameter_set_hash = ?2 WHERE parameter_set = ?1 AND parameter_set_hash <> ?2";

pub(super) async fn insert(
    writer: &SqlitePool,
    set: &ParameterSetRecord,
) -> Result<(ParameterSetRecord, bool), StoreError> {
    let mut transaction = begin(writer).await?;
    let kept = insert_within(&mut transaction, set).await?;
    transaction.commit().await?;
    Ok(kept)
}

pub(super) async fn keep_built_in(writer: &SqlitePool, set: &ParameterSetRecord) -> Result<(), StoreError> {
    let mut transaction = begin(writer).await?;
    insert_within(&mut transaction, set).await?;
    sqlx::query(PIN).bind(&set.name).bind(&set.hash).execute(&mut *transaction).await?;
    Ok(transaction.commit().await?)
}

async fn insert_within(
    transaction: &mut Transaction<'_, Sqlite>,
    set: &ParameterSetRecord,
) -> Result<(ParameterSetRecord, bool), StoreError> {
    let inserted = sqlx::query(INSERT)
        .bind(set.id.to_string())
        .bind(&set.name)
        .bind(&set.hash)
        .bind(set.parameters.to_string())
        .bind(micros(set.created_at))
        .execute(&mut **transaction)
        .await?;
    if inserted.rows_affected() == 1 {
        return Ok((set.clone(), true));
    }
    let row = sqlx::query(BY_HASH).bind(&set.name).bind(&set.hash).fetch_one(&mut **transaction).await?;
    Ok((read(&row)?, false))
}

pub(super) async fn newest(readers: &SqlitePool, name: &str) -> Result<Option<ParameterSetRecord>, StoreError> {
    let row = sqlx::query(NEWEST).bind(name).fetch_optional(readers).await?;
    row.as_ref().map(read).transpose()
}

pub(super) async fn by_hash(
    readers: &SqlitePool,
    name: &str,
    prefix: &str,
) -> Result<Vec<ParameterSetRecord>, StoreError> {
    let rows = sqlx::query(BY_HASH).bind(name).bind(prefix).fetch_all(readers).await?;
    rows.iter().map(read).collect()
}

pub(super) async fn list(readers: &SqlitePool, page: &Page) -> Result<Paged<ParameterSetRecord>, StoreError> {
    let after = page.start::<Id>(&["parameter sets"])?.map(|id| id.to_string()).unwrap_or_default();
    let rows = sqlx::query(LIST).bind(after).bind(page.rows()).fetch_all(readers).await?;
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&["parameter sets"], items, |set: &ParameterSetRecord| set.id))
}

fn read(row: &SqliteRow) -> Result<ParameterSetRecord, StoreError> {
    let mut row = Reader::new(row, "parameter set", 0);
    Ok(ParameterSetRecord {
        id: row.id()?,
        name: row.value()?,
        hash: row.value()?,
        parameters: row.json()?,
        created_at: row.time()?,
    })
}
