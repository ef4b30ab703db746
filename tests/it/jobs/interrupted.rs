//! Jobs that are cancelled, and jobs whose process ends.

use std::fs;
use std::time::Duration;

use elevon::jobs::run::Models;
use elevon::jobs::{JobSettings, Step};
use elevon::store::records::{JobState, now};

use super::bench::{Bench, Counted, Endless, Held, csv, driven, seen, simulation};
use crate::store_contract::samples::registered;

#[tokio::test]
async fn a_cancelled_queued_job_never_runs() {
    let dir = tempfile::tempdir().unwrap();
    let counted = Counted::default();
    let bench = Bench::open(dir.path(), driven(), counted.clone()).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    let cancelled = bench.jobs.cancel(job.id).await.unwrap().unwrap();
    assert_eq!(cancelled.state, JobState::Cancelled);
    assert_eq!(bench.jobs.try_run_next().await, Step::Skipped);
    assert_eq!(bench.jobs.try_run_next().await, Step::Empty);
    assert_eq!(counted.runs(), 0);
    assert_eq!(bench.job(job.id).await, cancelled);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn cancelling_a_running_job_ends_its_computation() {
    let dir = tempfile::tempdir().unwrap();
    let (endless, began) = Endless::new();
    let bench = Bench::open(dir.path(), driven(), endless).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    let (step, cancelled) = tokio::join!(bench.jobs.try_run_next(), async {
        seen(began).await;
        bench.jobs.cancel(job.id).await.unwrap().unwrap()
    });
    assert_eq!((step, cancelled.state, cancelled.error), (Step::Ran, JobState::Cancelled, None));
    assert_eq!(bench.job(job.id).await.state, JobState::Cancelled);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_simulation_that_is_cancelled_before_its_last_word_leaves_no_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let (held, began, let_go) = Held::new();
    let bench = Bench::open(dir.path(), driven(), held).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    tokio::join!(bench.jobs.try_run_next(), async {
        seen(began).await;
        bench.jobs.cancel(job.id).await.unwrap();
        let_go.send(()).unwrap();
    });
    assert_eq!(bench.job(job.id).await.state, JobState::Cancelled);
    let folders = fs::read_dir(dir.path().join("traces")).unwrap();
    let files: Vec<_> = folders.flat_map(|folder| fs::read_dir(folder.unwrap().path()).unwrap()).collect();
    assert!(files.is_empty(), "{files:?}");
}

#[tokio::test]
async fn a_job_that_ran_when_its_process_died_runs_again_exactly_once() {
    let dir = tempfile::tempdir().unwrap();
    let killed = Bench::open(dir.path(), driven(), Models).await;
    let actuator = registered(&*killed.records, "A").await;
    let (_, job) = killed.upload(actuator.id, 10, csv()).await;
    killed.records.claim_job(job.id, now()).await.unwrap().unwrap();

    let counted = Counted::default();
    let bench = Bench::open(dir.path(), driven(), counted.clone()).await;
    bench.jobs.start().await.unwrap();
    assert_eq!(bench.run_all().await, 1);
    assert_eq!(counted.runs(), 1);
    let done = bench.job(job.id).await;
    assert_eq!((done.state, done.attempt), (JobState::Succeeded, 2));
    let again = Bench::open(dir.path(), driven(), counted.clone()).await;
    again.jobs.start().await.unwrap();
    assert_eq!((again.run_all().await, counted.runs()), (0, 1));
}

#[tokio::test]
async fn a_job_whose_process_dies_three_times_fails() {
    let dir = tempfile::tempdir().unwrap();
    let first = Bench::open(dir.path(), driven(), Models).await;
    let job = first.jobs.enqueue(simulation()).await.unwrap();
    for _ in 0..3 {
        let process = Bench::open(dir.path(), driven(), Models).await;
        process.jobs.start().await.unwrap();
        process.records.claim_job(job.id, now()).await.unwrap().unwrap();
    }
    let counted = Counted::default();
    let bench = Bench::open(dir.path(), driven(), counted.clone()).await;
    bench.jobs.start().await.unwrap();
    assert_eq!((bench.run_all().await, counted.runs()), (0, 0));
    let failed = bench.job(job.id).await;
    assert_eq!((failed.state, failed.attempt), (JobState::Failed, 3));
    assert!(failed.error.as_ref().unwrap().contains("3 attempts"), "{:?}", failed.error);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_puts_the_running_job_back_without_counting_its_attempt() {
    let dir = tempfile::tempdir().unwrap();
    let (endless, began) = Endless::new();
    let bench = Bench::open(dir.path(), JobSettings { workers: 1, ..driven() }, endless).await;
    bench.jobs.start().await.unwrap();
    let running = bench.jobs.enqueue(simulation()).await.unwrap();
    let waiting = bench.jobs.enqueue(simulation()).await.unwrap();
    seen(began).await;
    bench.jobs.stop().await;
    for id in [running.id, waiting.id] {
        let job = bench.job(id).await;
        assert_eq!((job.state, job.attempt), (JobState::Queued, 0));
    }
    let next = Bench::open(dir.path(), driven(), Models).await;
    next.jobs.start().await.unwrap();
    assert_eq!(next.run_all().await, 2);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_does_not_wait_for_a_computation_that_does_not_end_and_the_next_start_runs_it_again() {
    let dir = tempfile::tempdir().unwrap();
    let (held, began, let_go) = Held::new();
    let settings = JobSettings { workers: 1, stop_limit: Duration::ZERO, ..driven() };
    let bench = Bench::open(dir.path(), settings, held).await;
    bench.jobs.start().await.unwrap();
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    seen(began).await;
    bench.jobs.stop().await;
    assert_eq!(bench.job(job.id).await.state, JobState::Running);
    let next = Bench::open(dir.path(), driven(), Models).await;
    next.jobs.start().await.unwrap();
    assert_eq!(next.run_all().await, 1);
    let done = next.job(job.id).await;
    assert_eq!((done.state, done.attempt), (JobState::Succeeded, 2));
    let_go.send(()).unwrap();
}
