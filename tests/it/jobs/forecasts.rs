//! Forecasts that follow their history, whatever was missed.

use std::sync::mpsc::{Sender, channel};

use elevon::jobs::run::predict::RemainingLife;
use elevon::jobs::run::{Compute, Finding, Models, RunError, Work};
use elevon::numeric::watch::Watch;
use elevon::store::LifeHistory;
use elevon::store::records::{Actuator, Id, JobState, MaintenanceKind};
use serde_json::{Value, json};

use super::bench::{Bench, csv, driven};
use crate::store_contract::samples::{maintained, measured, registered};

#[tokio::test]
async fn a_forecast_is_made_again_only_when_its_history_has_changed() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    let forecast = async || {
        let actuator = bench.records.actuator(id).await.unwrap().unwrap();
        let forecast = bench.jobs.forecast(&actuator).await.unwrap();
        assert_eq!(forecast.revision, actuator.revision);
        assert_eq!(bench.records.forecast(id).await.unwrap().as_ref(), Some(&forecast));
        forecast
    };
    let empty = forecast().await;
    assert_eq!((empty.risk, empty.median_remaining, &empty.document["forecast"]), (None, None, &Value::Null));
    assert_eq!(empty.document["faults"]["kgm"]["threshold"], json!(0.4));
    for i in 1..=9 {
        measured(&*bench.records, id, 100 * i, Some(0.04 * i as f64)).await;
    }
    let worn = forecast().await;
    assert!(worn.risk.unwrap() > 0.2 && worn.median_remaining.unwrap() < 500.0, "{worn:?}");
    assert_eq!(worn.document["unit"], "flight_hours");
    assert_eq!(worn.document["forecast"]["quantiles"]["0.5"], json!(worn.median_remaining));
    assert_eq!(worn.document["risk"], json!({"within": 100.0, "probability": worn.risk}));
    assert_eq!(forecast().await, worn, "the stored one, as its history has not changed");
    maintained(&*bench.records, id, MaintenanceKind::Replaced, 1000).await;
    let renewed = forecast().await;
    assert_eq!((renewed.risk, &renewed.document["as_of"]), (None, &Value::Null));
}

#[tokio::test]
async fn what_a_dead_process_left_stale_is_made_up_for_before_the_fleet_is_listed() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let mut ids: Vec<Id> = Vec::new();
    for i in 0..3 {
        ids.push(registered(&*bench.records, &format!("SN-{i}")).await.id);
        measured(&*bench.records, ids[i], 10, Some(0.1)).await;
    }
    assert_eq!(bench.records.stale_forecasts(10).await.unwrap(), ids);
    bench.jobs.refresh_stale().await.unwrap();
    assert!(bench.records.stale_forecasts(10).await.unwrap().is_empty());
    for id in ids {
        assert!(bench.records.forecast(id).await.unwrap().unwrap().risk.is_some());
    }
}

/// The models, noting whose forecast they make.
struct Noted(Sender<Id>);

impl Compute for Noted {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        Models.compute(work, watch)
    }

    fn predict(&self, actuator: &Actuator, history: &LifeHistory, risk_window: f64) -> RemainingLife {
        self.0.send(actuator.id).unwrap();
        Models.predict(actuator, history, risk_window)
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn readers_at_the_same_time_make_each_stale_forecast_once() {
    let dir = tempfile::tempdir().unwrap();
    let (made, noted) = channel();
    let bench = Bench::open(dir.path(), driven(), Noted(made)).await;
    let mut ids: Vec<Id> = Vec::new();
    for i in 0..3 {
        ids.push(registered(&*bench.records, &format!("SN-{i}")).await.id);
    }
    let refresh = || bench.jobs.refresh_stale();
    let (one, two, three) = tokio::join!(refresh(), refresh(), refresh());
    one.and(two).and(three).unwrap();
    assert_eq!(noted.try_iter().collect::<Vec<_>>(), ids);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_start_makes_stale_forecasts_without_being_asked() {
    let dir = tempfile::tempdir().unwrap();
    let (made, noted) = channel();
    let bench = Bench::open(dir.path(), driven(), Noted(made)).await;
    let id = registered(&*bench.records, "A").await.id;
    bench.jobs.start().await.unwrap();
    let first = tokio::task::spawn_blocking(move || noted.recv().unwrap()).await.unwrap();
    assert_eq!(first, id);
    bench.jobs.stop().await;
}

/// Cannot forecast.
struct NoForecast;

impl Compute for NoForecast {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        Models.compute(work, watch)
    }

    fn predict(&self, _: &Actuator, _: &LifeHistory, _: f64) -> RemainingLife {
        panic!("a singular matrix")
    }
}

#[tokio::test]
async fn a_forecast_that_panics_is_kept_as_a_reason_and_its_job_has_succeeded() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), NoForecast).await;
    let actuator = registered(&*bench.records, "A").await.id;
    let (_, job) = bench.upload(actuator, 10, csv()).await;
    assert_eq!(bench.run_all().await, 1);
    assert_eq!(bench.job(job.id).await.state, JobState::Succeeded);
    let forecast = bench.records.forecast(actuator).await.unwrap().unwrap();
    assert_eq!((forecast.revision, forecast.risk), (1, None));
    assert_eq!(forecast.document["reasons"], json!(["the forecast failed: panicked: a singular matrix"]));
}
