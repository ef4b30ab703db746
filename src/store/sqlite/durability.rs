//! What a loss of power must not undo, which of SQLite's errors are worth another try, and what comes after them.

use std::io;
use std::time::Duration;

use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};

use super::{FILE, SqliteRecords};
use crate::store::records::{Id, JobKind, NewJob, now};
use crate::store::{Records as _, StoreError};

#[tokio::test]
async fn every_commit_is_synced_and_goes_through_the_log() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let synchronous: i64 = sqlx::query_scalar("PRAGMA synchronous").fetch_one(&records.writer).await.unwrap();
    let journal: String = sqlx::query_scalar("PRAGMA journal_mode").fetch_one(&records.writer).await.unwrap();
    assert_eq!((synchronous, journal.as_str()), (2, "wal"), "2 is FULL");
}

#[tokio::test]
async fn a_locked_database_may_pass_and_a_refused_value_or_column_does_not() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let impatient = SqliteConnectOptions::new().filename(dir.path().join(FILE)).busy_timeout(Duration::ZERO);
    let other = SqlitePool::connect_with(impatient).await.unwrap();
    let lock = super::begin(&records.writer).await.unwrap();
    let locked = super::begin(&other).await.unwrap_err();
    assert!(locked.may_pass(), "{locked:?}");
    lock.rollback().await.unwrap();
    let refused = sqlx::query("INSERT INTO maintenance (id) VALUES ('a')").execute(&other).await;
    let unreadable = sqlx::query_scalar::<_, i64>("SELECT 'text'").fetch_one(&other).await;
    for error in [refused.unwrap_err(), unreadable.unwrap_err()].map(StoreError::from) {
        assert!(!error.may_pass(), "{error:?}");
    }
}

#[test]
fn only_what_somebody_else_can_end_may_pass() {
    let full = || io::Error::from(io::ErrorKind::StorageFull);
    let file = |source| StoreError::File { path: "00".into(), source };
    for error in [sqlx::Error::PoolTimedOut.into(), sqlx::Error::Io(full()).into(), file(full())] {
        assert!(StoreError::may_pass(&error), "{error:?}");
    }
    let denied = file(io::ErrorKind::PermissionDenied.into());
    for error in [sqlx::Error::PoolClosed.into(), sqlx::Error::RowNotFound.into(), denied] {
        assert!(!StoreError::may_pass(&error), "{error:?}");
    }
}

#[tokio::test]
async fn writes_succeed_again_once_a_full_disk_has_room() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let spec = serde_json::json!({"text": "x".repeat(100_000)});
    let job = NewJob { id: Id::now(), kind: JobKind::Simulation, spec, created_at: now() };
    let pages_max = async |pages: u32| {
        let pragma = format!("PRAGMA max_page_count = {pages}");
        sqlx::query(sqlx::AssertSqlSafe(pragma)).execute(&records.writer).await.unwrap();
    };
    pages_max(1).await;
    let full = records.insert_job(&job, 10).await.unwrap_err();
    assert!(full.may_pass(), "{full:?}");
    pages_max(u32::MAX / 2).await;
    records.insert_job(&job, 10).await.unwrap();
    records.ping().await.unwrap();
    assert!(records.job(job.id).await.unwrap().is_some());
}

#[tokio::test]
async fn records_that_cannot_be_written_are_not_ready() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    records.ping().await.unwrap();
    records.writer.close().await;
    records.ping().await.unwrap_err();
}
