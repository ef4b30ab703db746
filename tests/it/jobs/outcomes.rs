//! How jobs end by themselves.

use std::time::Duration;

use elevon::formats::{Format, ReadOptions, read};
use elevon::jobs::kind::JobSpec;
use elevon::jobs::run::Models;
use elevon::jobs::{JobSettings, Step};
use elevon::store::StoreError;
use elevon::store::records::{Id, Job, JobState};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use tokio::task::JoinSet;

use super::bench::{Bench, Endless, PanicsOnce, csv, driven, simulation};
use crate::store_contract::samples::{all, at, registered, trace};

#[tokio::test]
async fn an_upload_is_estimated_and_shows_in_the_history_and_in_the_forecast() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let actuator = registered(&*bench.records, "A").await;
    let (trace, queued) = bench.upload(actuator.id, 10, csv()).await;
    assert_eq!(queued, bench.job(queued.id).await);
    assert_eq!(bench.traces.get(trace.id).await.unwrap(), Some(csv()));

    assert_eq!(bench.jobs.try_run_next().await, Step::Ran);
    assert_eq!(bench.jobs.try_run_next().await, Step::Empty);
    let done = bench.job(queued.id).await;
    assert_eq!((done.state, done.attempt, done.progress), (JobState::Succeeded, 1, 1.0), "{:?}", done.error);
    let result = done.result.unwrap();
    assert_eq!(result["trace_id"], trace.id.to_string());
    assert!(result["elapsed_s"].as_f64().unwrap() >= 0.0 && result["verdict"].is_string(), "{result}");
    let history = bench.records.health(actuator.id, None, None, &all()).await.unwrap().items;
    assert_eq!((history[0].trace_id, history[0].job_id, history[0].recorded_at), (trace.id, queued.id, at(10)));
    assert_eq!((history[0].kgm, history[0].fdj_n), (result["kgm"].as_f64(), result["fdj_n"].as_f64()));
    assert!((history[0].kgm.unwrap() - 0.2).abs() < 0.05, "{result}");
    let forecast = bench.records.forecast(actuator.id).await.unwrap().unwrap();
    assert_eq!((forecast.revision, &forecast.document["usage"]), (1, &Value::from(10.0)));
}

#[tokio::test]
async fn a_simulation_leaves_a_trace_that_can_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    assert_eq!(bench.run_all().await, 1);
    let id: Id = bench.job(job.id).await.result.unwrap()["trace_id"].as_str().unwrap().parse().unwrap();
    let record = bench.records.trace(id).await.unwrap().unwrap();
    let bytes = bench.traces.get(id).await.unwrap().unwrap();
    let sha256: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!((record.sha256, record.size_bytes), (sha256, bytes.len() as u64));
    let trace = read(Format::Csv, &bytes, &ReadOptions::default()).unwrap();
    assert_eq!((record.samples, record.duration_s), (trace.samples() as u64, trace.duration_s()));
}

#[tokio::test]
async fn a_trace_that_cannot_be_read_or_found_fails_its_job_with_the_place() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let actuator = registered(&*bench.records, "A").await.id;
    let (_, damaged) = bench.upload(actuator, 10, b"time_s,position_command_m\n0,x\n".into()).await;
    let (lost_trace, lost) = bench.upload(actuator, 20, csv()).await;
    bench.traces.delete(lost_trace.id).await.unwrap();
    assert_eq!(bench.run_all().await, 2);
    for (job, place) in [(damaged, "line 2".to_owned()), (lost, lost_trace.id.to_string())] {
        let failed = bench.job(job.id).await;
        assert_eq!(failed.state, JobState::Failed);
        assert!(failed.error.as_ref().unwrap().contains(&place), "{:?}", failed.error);
    }
    assert!(bench.records.health(actuator, None, None, &all()).await.unwrap().items.is_empty());
}

#[tokio::test]
async fn a_panic_is_recorded_with_its_message_and_the_next_job_runs() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), PanicsOnce::default()).await;
    let jobs = [bench.jobs.enqueue(simulation()).await.unwrap(), bench.jobs.enqueue(simulation()).await.unwrap()];
    assert_eq!(bench.run_all().await, 2);
    let failed = bench.job(jobs[0].id).await;
    assert_eq!((failed.state, failed.error.as_deref()), (JobState::Failed, Some("panicked: the spool fell out")));
    assert_eq!(bench.job(jobs[1].id).await.state, JobState::Succeeded);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_job_over_its_time_limit_fails_and_its_computation_ends() {
    let dir = tempfile::tempdir().unwrap();
    let settings = JobSettings { time_limit: Duration::ZERO, ..driven() };
    let (endless, _began) = Endless::new();
    let bench = Bench::open(dir.path(), settings, endless).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    assert_eq!(bench.jobs.try_run_next().await, Step::Ran);
    let failed = bench.job(job.id).await;
    assert_eq!((failed.state, failed.error.as_deref()), (JobState::Failed, Some("took longer than the limit of 0 s")));
}

#[tokio::test]
async fn an_upload_that_the_records_refuse_leaves_no_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), JobSettings { queue_limit: 0, ..driven() }, Models).await;
    let trace = trace(registered(&*bench.records, "A").await.id, 10);
    let spec = JobSpec::Estimation { trace_id: trace.id, settings: Default::default() };
    let error = bench.jobs.upload(trace.clone(), csv(), spec).await.unwrap_err();
    assert!(matches!(error, StoreError::QueueFull { limit: 0, .. }), "{error}");
    assert_eq!(bench.traces.get(trace.id).await.unwrap(), None);
    assert_eq!(bench.jobs.try_run_next().await, Step::Empty);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn determinism_estimates_are_the_same_on_one_worker_and_on_four() {
    let mut found = Vec::new();
    for workers in [1, 4] {
        let dir = tempfile::tempdir().unwrap();
        let bench = Bench::open(dir.path(), driven(), Models).await;
        let actuator = registered(&*bench.records, "A").await.id;
        let mut queued = Vec::new();
        for second in 0..6 {
            queued.push(bench.upload(actuator, second, csv()).await.1.id);
        }
        let bench = std::sync::Arc::new(bench);
        let mut steps = JoinSet::new();
        for _ in 0..workers {
            let bench = bench.clone();
            steps.spawn(async move { bench.run_all().await });
        }
        assert_eq!(steps.join_all().await.into_iter().sum::<usize>(), queued.len());
        let mut results = Vec::new();
        for id in queued {
            results.push(without_chance(bench.job(id).await));
        }
        found.push(results);
    }
    assert_eq!(found[0], found[1]);
}

/// A job's result without what differs from run to run.
fn without_chance(job: Job) -> Value {
    let mut result = job.result.unwrap();
    for key in ["trace_id", "elapsed_s"] {
        result.as_object_mut().unwrap().remove(key).unwrap();
    }
    result
}
