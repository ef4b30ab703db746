//! Uploads in SQLite: a trace with the job that estimates from it, both or neither.

use sqlx::sqlite::SqlitePool;

use super::{begin, jobs, traces};
use crate::store::StoreError;
use crate::store::records::{NewJob, TraceRecord};

pub(super) async fn insert(
    writer: &SqlitePool,
    trace: &TraceRecord,
    job: &NewJob,
    queue_limit: u64,
) -> Result<(), StoreError> {
    let mut transaction = begin(writer).await?;
    jobs::insert_within(&mut transaction, job, queue_limit).await?;
    traces::insert(&mut transaction, trace).await?;
    Ok(transaction.commit().await?)
}
