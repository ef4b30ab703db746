//! A database of an older schema is brought up to date with what is in it.

use std::collections::BTreeMap;
use std::path::Path;

use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};

use super::{FILE, MIGRATIONS, SqliteRecords};
use crate::store::alerts::{AlertChange, Cause, NewAlert};
use crate::store::records::{
    FleetShare, FleetTally, ForecastRecord, Id, ParameterSetRecord, TrendFaults, TrendRecord, now,
};
use crate::store::{Page, Records as _, WithForecast};

/// A database of an older schema.
async fn older(dir: &Path, version: i64) -> SqlitePool {
    let options = SqliteConnectOptions::new().filename(dir.join(FILE)).create_if_missing(true);
    let old = SqlitePool::connect_with(options).await.unwrap();
    MIGRATIONS.run_to(version, &old).await.unwrap();
    old
}

/// The forecast of an actuator whose history never changed.
fn forecast(actuator_id: Id) -> ForecastRecord {
    let (document, basis) = (serde_json::json!({}), "new".to_owned());
    let (risk, median_remaining, created_at) = (Some(0.2), None, now());
    ForecastRecord { actuator_id, revision: 0, risk, median_remaining, document, basis, created_at }
}

async fn insert_actuator(old: &SqlitePool, id: Id) {
    sqlx::query(
        "INSERT INTO actuators (id, serial_number, tail_number, location, parameter_set, threshold_kgm, threshold_fdj_n,
        usage_unit, created_at) VALUES (?1, 'A', 'B', 'C', 'reference', 0.4, 1000.0, 'flight_hours', 0)",
    )
    .bind(id.to_string())
    .execute(old)
    .await
    .unwrap();
}

/// Inserts a trace of an actuator and its estimate, whose job has a result.
async fn insert_estimate(old: &SqlitePool, actuator: Id, recorded_at: i64, result: &str) {
    let (trace, job) = (Id::now().to_string(), Id::now().to_string());
    let statements = [
        "INSERT INTO traces (id, actuator_id, recorded_at, usage, media_type, columns, size_bytes, sha256, samples, duration_s,
        created_at) VALUES (?2, ?1, ?4, 1.0, 'text/csv', '', 1, '', 1, 1.0, 0)",
        "INSERT INTO jobs (id, kind, state, created_at, spec, result) VALUES (?3, 'estimation', 'succeeded', 0, '{}', ?5)",
        "INSERT INTO health (actuator_id, recorded_at, trace_id, job_id, usage, verdict)
        VALUES (?1, ?4, ?2, ?3, 1.0, 'conclusive')",
    ];
    for statement in statements {
        let query = sqlx::query(statement).bind(actuator.to_string()).bind(&trace).bind(&job);
        query.bind(recorded_at).bind(result).execute(old).await.unwrap();
    }
}

#[tokio::test]
async fn estimates_from_before_the_history_had_their_other_faults_bring_them_from_their_jobs() {
    let dir = tempfile::tempdir().unwrap();
    let old = older(dir.path(), 2).await;
    let id = Id::now();
    insert_actuator(&old, id).await;
    for (at, result) in
        [r#"{"faults": {"clearance_m": 2e-6, "clogging": null}}"#, r#"{"kgm": 0.1}"#, "{}"].iter().enumerate()
    {
        insert_estimate(&old, id, at as i64, result).await;
    }
    old.close().await;
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let page = records.health(id, None, None, &Page { after: None, limit: 10 }).await.unwrap();
    let faults: Vec<_> = page.items.into_iter().map(|record| record.faults).collect();
    let first = BTreeMap::from([("clearance_m".to_owned(), Some(2e-6)), ("clogging".to_owned(), None)]);
    assert_eq!(faults, [first, BTreeMap::new(), BTreeMap::new()]);
}

#[tokio::test]
async fn a_database_from_before_there_were_alerts_has_none_and_takes_them() {
    let dir = tempfile::tempdir().unwrap();
    let old = older(dir.path(), 4).await;
    let id = Id::now();
    insert_actuator(&old, id).await;
    insert_estimate(&old, id, 7, "{}").await;
    old.close().await;
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let rows = records.fleet(None, &Page { after: None, limit: 1 }).await.unwrap().items;
    assert_eq!((rows[0].alerts_open, rows[0].newest.is_some()), (0, true));
    let cause = Cause::Risk { risk: 0.2, limit: 0.1, within: 100.0, trace_id: None };
    let alert = NewAlert { id: Id::now(), cause, usage: 1.0, message: "soon".into(), raised_at: now() };
    let changes = [AlertChange::Raise(Box::new(alert))];
    let with = WithForecast { alerts: &changes, ..WithForecast::default() };
    assert!(records.store_forecast_with(&forecast(id), &with).await.unwrap());
    assert_eq!(records.open_alerts(id).await.unwrap().len(), 1);
}

#[tokio::test]
async fn an_actuator_from_before_there_were_parameter_sets_is_pinned_to_the_built_in_one_at_the_start() {
    let dir = tempfile::tempdir().unwrap();
    let old = older(dir.path(), 1).await;
    let id = Id::now();
    insert_actuator(&old, id).await;
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

#[tokio::test]
async fn a_forecast_from_before_there_was_a_trend_stays_and_the_trend_begins_with_the_next() {
    let dir = tempfile::tempdir().unwrap();
    let old = older(dir.path(), 4).await;
    let id = Id::now();
    insert_actuator(&old, id).await;
    insert_estimate(&old, id, 0, "{}").await;
    let kept =
        "INSERT INTO forecasts (actuator_id, created_at, document, basis) VALUES (?1, 0, '{\"old\": true}', 'old')";
    sqlx::query(kept).bind(id.to_string()).execute(&old).await.unwrap();
    old.close().await;
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    assert_eq!(records.forecast(id).await.unwrap().unwrap().document, serde_json::json!({"old": true}));
    let page = Page { after: None, limit: 10 };
    assert!(records.trend(id, None, None, &page).await.unwrap().items.is_empty());
    let newest = records.life_history(id).await.unwrap().unwrap().records.remove(0);
    let forecast = forecast(id);
    let step = TrendRecord {
        actuator_id: id,
        life_started_at: None,
        life_start_usage: None,
        trace_id: newest.trace_id,
        recorded_at: newest.recorded_at,
        usage: newest.usage,
        made_at: forecast.created_at,
        risk_window: 100.0,
        actuator: None,
        faults: TrendFaults { kgm: None, fdj_n: None },
        basis: forecast.basis.clone(),
        version: "new".into(),
    };
    assert!(records.store_forecast(&forecast, Some(&step)).await.unwrap());
    assert_eq!(records.trend(id, None, None, &page).await.unwrap().items, [step]);
}

#[tokio::test]
async fn a_database_from_before_fleets_learnt_begins_with_no_lives_and_takes_them() {
    let dir = tempfile::tempdir().unwrap();
    let old = older(dir.path(), 6).await;
    let id = Id::now();
    insert_actuator(&old, id).await;
    old.close().await;
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    assert_eq!(records.fleet_tally("x", Id::now()).await.unwrap(), FleetTally::default());
    let shares = [FleetShare { fault: "kgm".into(), cohort: "x".into(), tally: vec![-3, 0], prior: vec![] }];
    let with = WithForecast { shares: &shares, ..WithForecast::default() };
    assert!(records.store_forecast_with(&forecast(id), &with).await.unwrap());
    let expected = FleetTally { actuators: 1, tally: vec![-3, 0] };
    assert_eq!(records.fleet_tally("x", Id::now()).await.unwrap(), expected);
}
