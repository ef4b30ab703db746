//! Alerts in SQLite. Whatever changes one writes what the webhooks are told of it, in the same transaction.

use jiff::Timestamp;
use sqlx::SqliteConnection;
use sqlx::sqlite::{SqlitePool, SqliteRow};

use super::row::{Reader, micros};
use super::{begin, webhooks};
use crate::store::alerts::{Alert, AlertChange, AlertKind, AlertState, Cause, ClearedBecause, NewAlert};
use crate::store::records::Id;
use crate::store::webhooks::Event;
use crate::store::{Page, Paged, StoreError};

/// A query for alerts with what is told of their actuators: which, in which order.
macro_rules! select {
    ($rest:literal) => {
        concat!(
            "SELECT l.id, l.actuator_id, a.serial_number, a.tail_number, l.kind, l.fault, l.state, l.raised_at,
            l.acknowledged_at, l.cleared_at, l.cleared_because, l.usage, a.usage_unit, l.value, l.value_std, l.threshold,
            l.risk, l.risk_limit, l.risk_within, l.trace_id, l.note, l.message
            FROM alerts l CROSS JOIN actuators a ON a.id = l.actuator_id ",
            $rest
        )
    };
}

/// The maintenance event that began the current life of actuator ?1, '' for the first life.
macro_rules! life {
    ($($around:literal),+; $after:literal) => {
        concat!(
            $($around,)+
            "coalesce((SELECT m.id FROM maintenance m WHERE m.actuator_id = ?1 AND m.kind IN ('replaced', 'overhauled')
            ORDER BY m.at DESC, m.id DESC LIMIT 1), '')",
            $after
        )
    };
}

const INSERT: &str = life!(
    "INSERT INTO alerts (actuator_id, id, kind, fault, raised_at, usage, value, value_std, threshold, risk, risk_limit,
    risk_within, trace_id, message, life) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ";
    ") ON CONFLICT (actuator_id, kind, fault) WHERE cleared_at IS NULL DO NOTHING"
);
const CLEAR: &str = "UPDATE alerts SET state = 'cleared', cleared_at = ?2, cleared_because = ?3
    WHERE id = ?1 AND cleared_at IS NULL";
const ACKNOWLEDGE: &str = "UPDATE alerts SET state = 'acknowledged', acknowledged_at = ?2, note = ?3
    WHERE id = ?1 AND state = 'open'";
const ONE: &str = select!("WHERE l.id = ?1");
pub(super) const OPEN: &str = select!("WHERE l.actuator_id = ?1 AND l.cleared_at IS NULL");
pub(super) const OF_FORMER_LIVES: &str =
    life!("SELECT l.id FROM alerts l WHERE l.actuator_id = ?1 AND l.cleared_at IS NULL AND l.life <> "; "");
pub(super) const LIST: &str = select!("WHERE l.id < ?1 ORDER BY l.id DESC LIMIT ?2");
pub(super) const LIST_IN_STATE: &str = select!("WHERE l.state = ?3 AND l.id < ?1 ORDER BY l.id DESC LIMIT ?2");
pub(super) const LIST_OF_ACTUATOR: &str = select!("WHERE l.actuator_id = ?3 AND l.id < ?1 ORDER BY l.id DESC LIMIT ?2");
pub(super) const LIST_OF_ACTUATOR_IN_STATE: &str =
    select!("WHERE l.actuator_id = ?3 AND l.id < ?1 AND +l.state = ?4 ORDER BY l.id DESC LIMIT ?2");

/// Later than every id: ids are made of hexadecimal digits.
const AFTER_ALL: &str = "~";

/// What happened to an alert, for the metrics.
pub(super) type Happened = (Event, AlertKind);

/// Changes the alerts of an actuator within the transaction that keeps its forecast. What is so already stays.
pub(super) async fn apply(
    connection: &mut SqliteConnection,
    actuator: Id,
    changes: &[AlertChange],
) -> Result<Vec<Happened>, StoreError> {
    let mut happened = Vec::new();
    for change in changes {
        happened.extend(match change {
            AlertChange::Raise(alert) => raise(connection, actuator, alert).await?,
            AlertChange::Clear { id, because, at } => clear(connection, *id, *because, *at).await?,
        });
    }
    Ok(happened)
}

/// Clears what is open of an actuator's former lives, within the transaction that keeps a maintenance event.
pub(super) async fn clear_former_lives(
    connection: &mut SqliteConnection,
    actuator: Id,
    at: Timestamp,
) -> Result<Vec<Happened>, StoreError> {
    let rows = sqlx::query(OF_FORMER_LIVES).bind(actuator.to_string()).fetch_all(&mut *connection).await?;
    let mut happened = Vec::new();
    for row in rows {
        let id = Reader::new(&row, "alert", 0).id()?;
        happened.extend(clear(connection, id, ClearedBecause::Maintenance, at).await?);
    }
    Ok(happened)
}

/// Counts what happened, once it is durable.
pub(super) fn count(happened: &[Happened]) {
    for (event, kind) in happened {
        metrics::counter!("elevon_alerts_total", "event" => event.name(), "kind" => kind.name()).increment(1);
    }
}

async fn raise(
    connection: &mut SqliteConnection,
    actuator: Id,
    alert: &NewAlert,
) -> Result<Option<Happened>, StoreError> {
    let (mut value, mut value_std, mut threshold) = (None, None, None);
    let (mut risk, mut limit, mut within) = (None, None, None);
    let trace_id = match alert.cause {
        Cause::Threshold { value: found, value_std: std, threshold: level, trace_id, .. } => {
            (value, value_std, threshold) = (Some(found), std, Some(level));
            Some(trace_id)
        }
        Cause::Risk { risk: found, limit: bound, within: window, trace_id } => {
            (risk, limit, within) = (Some(found), Some(bound), Some(window));
            trace_id
        }
    };
    let inserted = sqlx::query(INSERT)
        .bind(actuator.to_string())
        .bind(alert.id.to_string())
        .bind(alert.cause.kind().name())
        .bind(alert.cause.fault().map_or("", |fault| fault.name()))
        .bind(micros(alert.raised_at))
        .bind(alert.usage)
        .bind(value)
        .bind(value_std)
        .bind(threshold)
        .bind(risk)
        .bind(limit)
        .bind(within)
        .bind(trace_id.map(|id| id.to_string()))
        .bind(&alert.message)
        .execute(&mut *connection)
        .await?;
    if inserted.rows_affected() == 0 {
        return Ok(None);
    }
    tell(connection, Event::Raised, alert.id, alert.raised_at).await
}

async fn clear(
    connection: &mut SqliteConnection,
    id: Id,
    because: ClearedBecause,
    at: Timestamp,
) -> Result<Option<Happened>, StoreError> {
    let query = sqlx::query(CLEAR).bind(id.to_string()).bind(micros(at)).bind(because.name());
    if query.execute(&mut *connection).await?.rows_affected() == 0 {
        return Ok(None);
    }
    tell(connection, Event::Cleared, id, at).await
}

/// Writes what the webhooks are told of an alert that has just changed.
async fn tell(
    connection: &mut SqliteConnection,
    event: Event,
    id: Id,
    at: Timestamp,
) -> Result<Option<Happened>, StoreError> {
    let Some(alert) = one(&mut *connection, id).await? else { return Ok(None) };
    webhooks::tell(connection, event, &alert, at).await?;
    Ok(Some((event, alert.kind)))
}

/// Acknowledges an open alert: the alert as it is now, and whether this changed it.
pub(super) async fn acknowledge(
    writer: &SqlitePool,
    id: Id,
    note: &str,
    now: Timestamp,
) -> Result<Option<(Alert, bool)>, StoreError> {
    let mut transaction = begin(writer).await?;
    let query = sqlx::query(ACKNOWLEDGE).bind(id.to_string()).bind(micros(now)).bind(note);
    let changed = query.execute(&mut *transaction).await?.rows_affected() > 0;
    let happened = if changed { tell(&mut transaction, Event::Acknowledged, id, now).await? } else { None };
    let alert = one(&mut *transaction, id).await?;
    transaction.commit().await?;
    count(happened.as_slice());
    Ok(alert.map(|alert| (alert, changed)))
}

pub(super) async fn open(readers: &SqlitePool, actuator: Id) -> Result<Vec<Alert>, StoreError> {
    let rows = sqlx::query(OPEN).bind(actuator.to_string()).fetch_all(readers).await?;
    rows.iter().map(read).collect()
}

pub(super) async fn one(executor: impl sqlx::SqliteExecutor<'_>, id: Id) -> Result<Option<Alert>, StoreError> {
    let row = sqlx::query(ONE).bind(id.to_string()).fetch_optional(executor).await?;
    row.as_ref().map(read).transpose()
}

pub(super) async fn list(
    readers: &SqlitePool,
    state: Option<AlertState>,
    actuator: Option<Id>,
    page: &Page,
) -> Result<Paged<Alert>, StoreError> {
    let (state, actuator) = (state.map(AlertState::name), actuator.map(|id| id.to_string()));
    let of = ["alerts", state.unwrap_or_default(), actuator.as_deref().unwrap_or_default()];
    let before = page.start::<Id>(&of)?.map_or_else(|| AFTER_ALL.into(), |id| id.to_string());
    let sql = match (&actuator, state) {
        (None, None) => LIST,
        (None, Some(_)) => LIST_IN_STATE,
        (Some(_), None) => LIST_OF_ACTUATOR,
        (Some(_), Some(_)) => LIST_OF_ACTUATOR_IN_STATE,
    };
    let chosen = actuator.as_deref().into_iter().chain(state);
    let query = sqlx::query(sql).bind(before).bind(page.rows());
    let rows = chosen.fold(query, |query, value| query.bind(value)).fetch_all(readers).await?;
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, |alert: &Alert| alert.id))
}

fn read(row: &SqliteRow) -> Result<Alert, StoreError> {
    let mut row = Reader::new(row, "alert", 0);
    Ok(Alert {
        id: row.id()?,
        actuator_id: row.id()?,
        serial_number: row.value()?,
        tail_number: row.value()?,
        kind: row.name()?,
        fault: row.name_or_empty()?,
        state: row.name()?,
        raised_at: row.time()?,
        acknowledged_at: row.time_or_null()?,
        cleared_at: row.time_or_null()?,
        cleared_because: row.name_or_null()?,
        usage: row.value()?,
        usage_unit: row.name()?,
        value: row.value()?,
        value_std: row.value()?,
        threshold: row.value()?,
        risk: row.value()?,
        limit: row.value()?,
        within: row.value()?,
        trace_id: row.id_or_null()?,
        note: row.value()?,
        message: row.value()?,
    })
}
