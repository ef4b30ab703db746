//! Forecasts that follow their history, whatever was missed.

use std::sync::mpsc::{Sender, channel};

use elevon::jobs::JobSettings;
use elevon::jobs::run::fleet::KnownLives;
use elevon::jobs::run::predict::{Predicted, RiskQuestion};
use elevon::jobs::run::{Compute, Finding, Models, RunError, Work};
use elevon::numeric::watch::Watch;
use elevon::store::LifeHistory;
use elevon::store::records::{Actuator, ActuatorUpdate, Id, JobState, MaintenanceKind, TrendRecord};
use serde_json::{Value, json};

use super::bench::{Bench, csv, driven};
use crate::store_contract::samples::{all, at, maintained, measured, registered};

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

    fn predict(
        &self,
        actuator: &Actuator,
        history: &LifeHistory,
        known: &KnownLives,
        asked: &RiskQuestion,
    ) -> Predicted {
        self.0.send(actuator.id).unwrap();
        Models.predict(actuator, history, known, asked)
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

    fn predict(&self, _: &Actuator, _: &LifeHistory, _: &KnownLives, _: &RiskQuestion) -> Predicted {
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

async fn trend(bench: &Bench, actuator: Id) -> Vec<TrendRecord> {
    bench.records.trend(actuator, None, None, &all()).await.unwrap().items
}

/// Makes the forecast of an actuator as it is now.
async fn forecast(bench: &Bench, actuator: Id) {
    let actuator = bench.records.actuator(actuator).await.unwrap().unwrap();
    bench.jobs.forecast(&actuator).await.unwrap();
}

#[tokio::test]
async fn every_estimation_leaves_its_step_of_the_trend_without_a_reader() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let actuator = registered(&*bench.records, "A").await.id;
    let mut expected = Vec::new();
    for second in [10, 20] {
        let (trace, _) = bench.upload(actuator, second, csv()).await;
        assert_eq!(bench.run_all().await, 1);
        expected.push((trace.id, second as f64));
    }
    let trend = trend(&bench, actuator).await;
    assert_eq!(trend.iter().map(|step| (step.trace_id, step.usage)).collect::<Vec<_>>(), expected);
    assert!(trend[0].made_at < trend[1].made_at);
    let stored = bench.records.forecast(actuator).await.unwrap().unwrap();
    let (newest, document) = (trend[1].actuator.unwrap(), &stored.document);
    assert_eq!(json!(newest.q50), document["forecast"]["quantiles"]["0.5"]);
    assert_eq!(json!(newest.mean), document["forecast"]["mean"]);
    assert_eq!(json!(newest.risk), document["risk"]["probability"]);
    assert_eq!(json!(trend[1].faults.kgm.unwrap().q05), document["faults"]["kgm"]["forecast"]["quantiles"]["0.05"]);
    assert_eq!((trend[1].made_at, trend[1].basis.as_str()), (stored.created_at, stored.basis.as_str()));
}

#[tokio::test]
async fn estimates_that_come_late_or_end_together_have_their_steps_from_what_was_recorded_up_to_them() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    for i in [1, 2, 4] {
        measured(&*bench.records, id, 100 * i, Some(0.04 * i as f64)).await;
    }
    forecast(&bench, id).await;
    let newest = trend(&bench, id).await;
    assert_eq!(newest.len(), 1, "no worker estimated these");
    let (late, _) = bench.upload(id, 300, csv()).await;
    assert_eq!(bench.run_all().await, 1);
    let steps = trend(&bench, id).await;
    assert_eq!(steps.iter().map(|step| step.usage).collect::<Vec<_>>(), [300.0, 400.0]);
    assert_eq!((steps[0].trace_id, steps[0].recorded_at), (late.id, at(300)));
    assert!(steps[0].actuator.is_some() && steps[0].made_at > newest[0].made_at);
    assert_ne!(steps[1].actuator, newest[0].actuator, "the newest is forecast with it");
    // In a fleet of its own: what was learnt of the first would inform it.
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let twin = registered(&*bench.records, "B").await.id;
    for i in [1, 2] {
        measured(&*bench.records, twin, 100 * i, Some(0.04 * i as f64)).await;
    }
    bench.upload(twin, 300, csv()).await;
    assert_eq!(bench.run_all().await, 1);
    let alone = trend(&bench, twin).await;
    assert_eq!((alone[0].usage, alone[0].actuator), (300.0, steps[0].actuator), "as if nothing had come after it");
}

#[tokio::test]
async fn a_late_upload_and_another_threshold_change_the_newest_step_alone() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    for i in [1, 2, 4, 5] {
        measured(&*bench.records, id, 100 * i, Some(0.04 * i as f64)).await;
        forecast(&bench, id).await;
    }
    let before = trend(&bench, id).await;
    assert_eq!(before.len(), 4);
    measured(&*bench.records, id, 300, Some(0.12)).await;
    forecast(&bench, id).await;
    let late = trend(&bench, id).await;
    assert_eq!(late[..3], before[..3]);
    assert_eq!((late.len(), late[3].trace_id), (4, before[3].trace_id));
    assert_ne!(late[3].actuator, before[3].actuator);
    let update = ActuatorUpdate { threshold_kgm: Some(0.3), ..ActuatorUpdate::default() };
    bench.records.change_actuator(id, &update).await.unwrap().unwrap();
    forecast(&bench, id).await;
    let sooner = trend(&bench, id).await;
    assert_eq!((&sooner[..3], sooner.len()), (&before[..3], 4));
    assert!(sooner[3].faults.kgm.unwrap().q50 < late[3].faults.kgm.unwrap().q50, "{sooner:?}");
}

#[tokio::test]
async fn a_new_life_goes_on_with_the_trend_and_the_old_one_s_steps_stay() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    for second in [100, 200] {
        measured(&*bench.records, id, second, Some(0.1)).await;
        forecast(&bench, id).await;
    }
    maintained(&*bench.records, id, MaintenanceKind::Replaced, 250).await;
    forecast(&bench, id).await;
    assert_eq!(trend(&bench, id).await.len(), 2, "there is no trace of the new life yet");
    measured(&*bench.records, id, 300, Some(0.0)).await;
    forecast(&bench, id).await;
    let lives: Vec<_> = trend(&bench, id).await.iter().map(|step| (step.usage, step.life_started_at)).collect();
    assert_eq!(lives, [(100.0, None), (200.0, None), (300.0, Some(at(250)))]);
}

#[tokio::test]
async fn a_trace_of_a_life_that_is_over_has_its_step_in_that_life() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    for second in [100, 250] {
        maintained(&*bench.records, id, MaintenanceKind::Replaced, second).await;
    }
    for second in [50, 150, 170, 300] {
        measured(&*bench.records, id, second, Some(0.1)).await;
    }
    let (late, _) = bench.upload(id, 160, csv()).await;
    let (first, _) = bench.upload(id, 60, csv()).await;
    assert_eq!(bench.run_all().await, 2);
    let steps: Vec<_> = trend(&bench, id)
        .await
        .iter()
        .map(|step| (step.trace_id, step.life_started_at, step.life_start_usage))
        .collect();
    assert_eq!(steps[..2], [(first.id, None, None), (late.id, Some(at(100)), Some(100.0))]);
    assert_eq!((steps.len(), steps[2].1), (3, Some(at(250))));
}

#[tokio::test]
async fn restarts_and_other_settings_do_not_multiply_the_steps() {
    let dir = tempfile::tempdir().unwrap();
    let mut basis = String::new();
    for (round, act_at_risk) in [0.05, 0.05, 0.1].into_iter().enumerate() {
        let settings = JobSettings { act_at_risk, ..driven() };
        let bench = Bench::open(dir.path(), settings, Models).await;
        let id = match bench.records.actuators(&all()).await.unwrap().items.first() {
            Some(actuator) => actuator.id,
            None => registered(&*bench.records, "A").await.id,
        };
        if round == 0 {
            for second in [100, 200, 300] {
                measured(&*bench.records, id, second, Some(0.1)).await;
                forecast(&bench, id).await;
            }
        }
        bench.jobs.start().await.unwrap();
        bench.jobs.refresh_stale().await.unwrap();
        let steps = trend(&bench, id).await;
        assert_eq!(steps.len(), 3);
        assert_eq!(steps[2].basis != basis, round != 1, "{basis}");
        basis = steps[2].basis.clone();
        let stored = bench.records.forecast(id).await.unwrap().unwrap();
        assert_eq!(stored.document["act_by"]["risk"], json!(act_at_risk));
        bench.jobs.stop().await;
    }
}
