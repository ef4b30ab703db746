//! Jobs in SQLite: queued, claimed, finished.

use jiff::Timestamp;
use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{Row as _, SqliteConnection};

use super::row::{Reader, micros};
use super::{begin, health, traces};
use crate::store::records::{Id, Job, JobState, NewJob, Outcome};
use crate::store::{Page, Paged, StoreError};

/// A query for jobs: what to keep, in which order.
macro_rules! select {
    ($rest:literal) => {
        concat!(
            "SELECT id, kind, state, progress, attempt, created_at, started_at, finished_at, result, error, spec
            FROM jobs ",
            $rest
        )
    };
}

const INSERT: &str = "INSERT INTO jobs (id, kind, state, created_at, spec) VALUES (?1, ?2, 'queued', ?3, ?4)";
const ONE: &str = select!("WHERE id = ?1");
pub(super) const LIST: &str = select!("WHERE id < ?1 ORDER BY id DESC LIMIT ?2");
pub(super) const LIST_IN_STATE: &str = select!("WHERE state = ?3 AND id < ?1 ORDER BY id DESC LIMIT ?2");
pub(super) const COUNT_QUEUED: &str = "SELECT count(*) FROM jobs WHERE state = 'queued'";
pub(super) const CLAIM: &str = "UPDATE jobs SET state = 'running', attempt = attempt + 1, progress = 0, started_at = ?2
    WHERE id = ?1 AND state = 'queued'";
const PROGRESS: &str = "UPDATE jobs SET progress = ?3 WHERE id = ?1 AND attempt = ?2 AND state = 'running'";
const FINISH: &str = "UPDATE jobs SET state = ?3, finished_at = ?4, result = ?5, error = ?6,
    progress = CASE ?3 WHEN 'succeeded' THEN 1.0 ELSE progress END
    WHERE id = ?1 AND attempt = ?2 AND state = 'running'";
const RELEASE: &str = "UPDATE jobs SET state = 'queued', attempt = attempt - 1, progress = 0, started_at = NULL
    WHERE id = ?1 AND attempt = ?2 AND state = 'running'";
pub(super) const GIVE_UP: &str = "UPDATE jobs SET state = 'failed', finished_at = ?2,
    error = 'the service ended during every one of the job''s ' || attempt || ' attempts'
    WHERE state = 'running' AND attempt >= ?1";
const REQUEUE: &str = "UPDATE jobs SET state = 'queued', progress = 0, started_at = NULL WHERE state = 'running'";
pub(super) const QUEUED: &str = "SELECT id FROM jobs WHERE state = 'queued' ORDER BY id";

/// Later than every id: ids are made of hexadecimal digits.
const AFTER_ALL: &str = "~";

pub(super) async fn insert(writer: &SqlitePool, job: &NewJob, queue_limit: u64) -> Result<(), StoreError> {
    let mut transaction = begin(writer).await?;
    insert_within(&mut transaction, job, queue_limit).await?;
    Ok(transaction.commit().await?)
}

/// Queues a job within a transaction of the writer, so that no other job can take the last place.
pub(super) async fn insert_within(
    connection: &mut SqliteConnection,
    job: &NewJob,
    queue_limit: u64,
) -> Result<(), StoreError> {
    let queued = sqlx::query(COUNT_QUEUED).fetch_one(&mut *connection).await?.try_get::<i64, _>(0)?.unsigned_abs();
    if queued >= queue_limit {
        return Err(StoreError::QueueFull { queued, limit: queue_limit });
    }
    sqlx::query(INSERT)
        .bind(job.id.to_string())
        .bind(job.kind.name())
        .bind(micros(job.created_at))
        .bind(job.spec.to_string())
        .execute(connection)
        .await?;
    Ok(())
}

pub(super) async fn one(executor: impl sqlx::SqliteExecutor<'_>, id: Id) -> Result<Option<Job>, StoreError> {
    let row = sqlx::query(ONE).bind(id.to_string()).fetch_optional(executor).await?;
    row.as_ref().map(read).transpose()
}

pub(super) async fn list(readers: &SqlitePool, state: Option<JobState>, page: &Page) -> Result<Paged<Job>, StoreError> {
    let of = ["jobs", state.map_or("", JobState::name)];
    let before = page.start::<Id>(&of)?.map_or_else(|| AFTER_ALL.into(), |id| id.to_string());
    let query = sqlx::query(if state.is_some() { LIST_IN_STATE } else { LIST }).bind(before).bind(page.rows());
    let rows = match state {
        Some(state) => query.bind(state.name()).fetch_all(readers).await?,
        None => query.fetch_all(readers).await?,
    };
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, |job: &Job| job.id))
}

pub(super) async fn counts(readers: &SqlitePool) -> Result<Vec<(JobState, u64)>, StoreError> {
    let rows = sqlx::query("SELECT state, count(*) FROM jobs GROUP BY state").fetch_all(readers).await?;
    let mut counts = JobState::ALL.map(|state| (state, 0));
    for row in &rows {
        let name: &str = row.try_get(0)?;
        if let Some(entry) = counts.iter_mut().find(|(state, _)| state.name() == name) {
            entry.1 = row.try_get::<i64, _>(1)?.unsigned_abs();
        }
    }
    Ok(counts.into())
}

pub(super) async fn claim(writer: &SqlitePool, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError> {
    let mut transaction = begin(writer).await?;
    let claimed = sqlx::query(CLAIM).bind(id.to_string()).bind(micros(now)).execute(&mut *transaction).await?;
    if claimed.rows_affected() == 0 {
        return Ok(None);
    }
    let job = one(&mut *transaction, id).await?;
    transaction.commit().await?;
    Ok(job)
}

pub(super) async fn report_progress(
    writer: &SqlitePool,
    id: Id,
    attempt: u32,
    progress: f64,
) -> Result<bool, StoreError> {
    let reported = sqlx::query(PROGRESS).bind(id.to_string()).bind(attempt).bind(progress).execute(writer).await?;
    Ok(reported.rows_affected() == 1)
}

pub(super) async fn finish(
    writer: &SqlitePool,
    id: Id,
    attempt: u32,
    outcome: &Outcome,
    now: Timestamp,
) -> Result<bool, StoreError> {
    let (state, result, error) = match outcome {
        Outcome::Estimated { result, .. } | Outcome::Simulated { result, .. } => {
            (JobState::Succeeded, Some(result.to_string()), None)
        }
        Outcome::Failed { error } => (JobState::Failed, None, Some(error)),
    };
    let mut transaction = begin(writer).await?;
    let finished = sqlx::query(FINISH)
        .bind(id.to_string())
        .bind(attempt)
        .bind(state.name())
        .bind(micros(now))
        .bind(result)
        .bind(error)
        .execute(&mut *transaction)
        .await?;
    if finished.rows_affected() == 0 {
        return Ok(false);
    }
    match outcome {
        Outcome::Estimated { trace_id, estimate, .. } => {
            health::keep_estimate(&mut transaction, *trace_id, id, estimate).await?;
        }
        Outcome::Simulated { trace, .. } => traces::insert(&mut transaction, trace).await?,
        Outcome::Failed { .. } => {}
    }
    transaction.commit().await?;
    Ok(true)
}

pub(super) async fn release(writer: &SqlitePool, id: Id, attempt: u32) -> Result<bool, StoreError> {
    let released = sqlx::query(RELEASE).bind(id.to_string()).bind(attempt).execute(writer).await?;
    Ok(released.rows_affected() == 1)
}

pub(super) async fn cancel(writer: &SqlitePool, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError> {
    let mut transaction = begin(writer).await?;
    sqlx::query(
        "UPDATE jobs SET state = 'cancelled', finished_at = ?2 WHERE id = ?1 AND state IN ('queued', 'running')",
    )
    .bind(id.to_string())
    .bind(micros(now))
    .execute(&mut *transaction)
    .await?;
    let job = one(&mut *transaction, id).await?;
    transaction.commit().await?;
    Ok(job)
}

pub(super) async fn recover(writer: &SqlitePool, attempts_max: u32, now: Timestamp) -> Result<Vec<Id>, StoreError> {
    let mut transaction = begin(writer).await?;
    sqlx::query(GIVE_UP).bind(attempts_max).bind(micros(now)).execute(&mut *transaction).await?;
    sqlx::query(REQUEUE).execute(&mut *transaction).await?;
    let rows = sqlx::query(QUEUED).fetch_all(&mut *transaction).await?;
    transaction.commit().await?;
    rows.iter().map(|row| Reader::new(row, "job", 0).id()).collect()
}

fn read(row: &SqliteRow) -> Result<Job, StoreError> {
    let mut row = Reader::new(row, "job", 0);
    Ok(Job {
        id: row.id()?,
        kind: row.name()?,
        state: row.name()?,
        progress: row.value()?,
        attempt: row.count()?,
        created_at: row.time()?,
        started_at: row.time_or_null()?,
        finished_at: row.time_or_null()?,
        result: row.json_or_null()?,
        error: row.value()?,
        spec: row.json()?,
    })
}
