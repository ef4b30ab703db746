//! A database of an older schema is brought up to date with what is in it.

use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};

use super::{FILE, MIGRATIONS, SqliteRecords};
use crate::store::records::{Id, ParameterSetRecord, now};
use crate::store::{Page, Records as _};

#[tokio::test]
async fn an_actuator_from_before_there_were_parameter_sets_is_pinned_to_the_built_in_one_at_the_start() {
    let dir = tempfile::tempdir().unwrap();
    let options = SqliteConnectOptions::new().filename(dir.path().join(FILE)).create_if_missing(true);
    let old = SqlitePool::connect_with(options).await.unwrap();
    MIGRATIONS.run_to(1, &old).await.unwrap();
    let id = Id::now();
    sqlx::query(
        "INSERT INTO actuators (id, serial_number, tail_number, location, parameter_set, threshold_kgm, threshold_fdj_n,
        usage_unit, created_at) VALUES (?1, 'A', 'B', 'C', 'reference', 0.4, 1000.0, 'flight_hours', 0)",
    )
    .bind(id.to_string())
    .execute(&old)
    .await
    .unwrap();
    old.close().await;
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    assert_eq!(records.actuator(id).await.unwrap().unwrap().parameter_set_hash, "");
    let (name, hash, parameters) = ("reference".into(), "0a".into(), serde_json::json!({}));
    let built_in = ParameterSetRecord { id: Id::now(), name, hash, parameters, created_at: now() };
    records.keep_built_in_set(&built_in).await.unwrap();
    assert_eq!(records.actuator(id).await.unwrap().unwrap().parameter_set_hash, "0a");
    let rows = records.fleet(None, &Page { after: None, limit: 1 }).await.unwrap().items;
    assert_eq!(rows[0].actuator.parameter_set_hash, "0a");
}
