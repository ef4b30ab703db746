//! The trend of the forecasts in SQLite: what stays of each when the next is made.

use jiff::Timestamp;
use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{SqliteConnection, SqliteExecutor};

use super::row::{Reader, micros};
use crate::store::records::{Id, TrendFigures, TrendRecord};
use crate::store::{Page, Paged, StoreError};

/// The start of a first life, which began with the actuator.
const FIRST_LIFE: i64 = i64::MIN;

/// An insertion of a step; what to do about one of the same life and trace.
macro_rules! insert {
    ($or:literal) => {
        concat!(
            "INSERT OR ",
            $or,
            " INTO forecast_trend (actuator_id, trace_id, life_started_at, life_start_usage, recorded_at, usage, made_at,
            risk_window, q05, q50, q95, mean, reached, risk, faults, basis, version)
            VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17)"
        )
    };
}

const KEEP: &str = insert!("REPLACE");
const FILL: &str = insert!("IGNORE");
pub(super) const LIST: &str =
    "SELECT actuator_id, trace_id, life_started_at, life_start_usage, recorded_at, usage, made_at,
    risk_window, q05, q50, q95, mean, reached, risk, faults, basis, version FROM forecast_trend
    WHERE actuator_id = ?1 AND (life_started_at, usage, made_at, trace_id) > (?2, ?3, ?4, ?5)
    AND recorded_at >= ?6 AND recorded_at < ?7 AND (SELECT excluded FROM traces WHERE id = trace_id) = 0
    ORDER BY life_started_at, usage, made_at, trace_id LIMIT ?8";

/// The place of a step in its actuator's trend.
type Place = (i64, (f64, (i64, Id)));

/// Keeps a step in the place of an earlier one of the same life and trace, within the transaction that keeps its forecast.
pub(super) async fn keep(connection: &mut SqliteConnection, step: &TrendRecord) -> Result<(), StoreError> {
    insert(connection, KEEP, step).await.map(drop)
}

/// Keeps a step unless one of the same life and trace is kept already.
pub(super) async fn fill(writer: &SqlitePool, step: &TrendRecord) -> Result<bool, StoreError> {
    Ok(insert(writer, FILL, step).await? > 0)
}

async fn insert(executor: impl SqliteExecutor<'_>, sql: &'static str, step: &TrendRecord) -> Result<u64, StoreError> {
    let figures = step.actuator;
    let inserted = sqlx::query(sql)
        .bind(step.actuator_id.to_string())
        .bind(step.trace_id.to_string())
        .bind(life(step))
        .bind(step.life_start_usage)
        .bind(micros(step.recorded_at))
        .bind(step.usage)
        .bind(micros(step.made_at))
        .bind(step.risk_window)
        .bind(figures.and_then(|figures| figures.q05))
        .bind(figures.and_then(|figures| figures.q50))
        .bind(figures.and_then(|figures| figures.q95))
        .bind(figures.and_then(|figures| figures.mean))
        .bind(figures.map(|figures| figures.reached))
        .bind(figures.and_then(|figures| figures.risk))
        .bind(serde_json::to_string(&step.faults).expect("figures have names"))
        .bind(&step.basis)
        .bind(&step.version)
        .execute(executor)
        .await?;
    Ok(inserted.rows_affected())
}

pub(super) async fn list(
    readers: &SqlitePool,
    actuator: Id,
    from: Option<Timestamp>,
    to: Option<Timestamp>,
    page: &Page,
) -> Result<Paged<TrendRecord>, StoreError> {
    let [first, last] = [from, to].map(|at| at.map(|at| at.to_string()).unwrap_or_default());
    let actuator = actuator.to_string();
    let of = ["trend", &actuator, &first, &last];
    let after = page.start::<Place>(&of)?.map(|(life, (usage, (made, trace)))| (life, usage, made, trace.to_string()));
    let (life, usage, made, trace) = after.unwrap_or((FIRST_LIFE, f64::NEG_INFINITY, i64::MIN, String::new()));
    let rows = sqlx::query(LIST)
        .bind(&actuator)
        .bind(life)
        .bind(usage)
        .bind(made)
        .bind(trace)
        .bind(from.map_or(i64::MIN, micros))
        .bind(to.map_or(i64::MAX, micros))
        .bind(page.rows())
        .fetch_all(readers)
        .await?;
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, place))
}

fn life(step: &TrendRecord) -> i64 {
    step.life_started_at.map_or(FIRST_LIFE, micros)
}

fn place(step: &TrendRecord) -> Place {
    (life(step), (step.usage, (micros(step.made_at), step.trace_id)))
}

/// Reads the columns of [`LIST`].
fn read(row: &SqliteRow) -> Result<TrendRecord, StoreError> {
    let mut row = Reader::new(row, "step of a trend", 0);
    Ok(TrendRecord {
        actuator_id: row.id()?,
        trace_id: row.id()?,
        life_started_at: row.time_unless(FIRST_LIFE)?,
        life_start_usage: row.value()?,
        recorded_at: row.time()?,
        usage: row.value()?,
        made_at: row.time()?,
        risk_window: row.value()?,
        actuator: figures(&mut row)?,
        faults: row.document()?,
        basis: row.value()?,
        version: row.value()?,
    })
}

fn figures(row: &mut Reader<'_>) -> Result<Option<TrendFigures>, StoreError> {
    let (q05, q50, q95, mean) = (row.value()?, row.value()?, row.value()?, row.value()?);
    let (reached, risk): (Option<bool>, _) = (row.value()?, row.value()?);
    Ok(reached.map(|reached| TrendFigures { q05, q50, q95, mean, reached, risk }))
}
