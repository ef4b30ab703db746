//! What jobs do about a trace store that fails, or is slow.

use std::io::{Error, ErrorKind};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};

use async_trait::async_trait;
use elevon::jobs::JobSettings;
use elevon::jobs::kind::JobSpec;
use elevon::jobs::run::Models;
use elevon::store::local::LocalTraces;
use elevon::store::records::{Id, JobState};
use elevon::store::{Records, StoreError, Traces};

use super::bench::{Bench, Counted, csv, driven, seen, simulation};
use crate::store_contract::samples::{registered, trace};

fn failure(kind: ErrorKind) -> StoreError {
    StoreError::File { path: "00".into(), source: Error::from(kind) }
}

/// Does what it is asked, and then says that it failed, once for each planned failure.
struct Failing {
    traces: LocalTraces,
    failures: Mutex<Vec<ErrorKind>>,
    asked: Sender<()>,
}

impl Failing {
    fn then<T>(&self, done: T) -> Result<T, StoreError> {
        // Nobody may listen any more.
        let _ = self.asked.send(());
        match self.failures.lock().unwrap().pop() {
            Some(kind) => Err(failure(kind)),
            None => Ok(done),
        }
    }
}

#[async_trait]
impl Traces for Failing {
    async fn put(&self, id: Id, bytes: Vec<u8>) -> Result<(), StoreError> {
        self.traces.put(id, bytes).await?;
        self.then(())
    }

    async fn get(&self, id: Id) -> Result<Option<Vec<u8>>, StoreError> {
        let found = self.traces.get(id).await?;
        self.then(found)
    }

    async fn ids_ending_in(&self, end: u8) -> Result<Vec<Id>, StoreError> {
        self.traces.ids_ending_in(end).await
    }

    async fn set_aside(&self, id: Id) -> Result<(), StoreError> {
        self.traces.set_aside(id).await
    }

    async fn delete(&self, id: Id) -> Result<(), StoreError> {
        self.traces.delete(id).await
    }
}

/// The files of traces, the one being written included.
fn files(dir: &std::path::Path) -> usize {
    let folders = std::fs::read_dir(dir.join("traces")).unwrap();
    folders.flat_map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap()).count()
}

#[tokio::test]
async fn an_upload_whose_bytes_were_kept_by_a_store_that_failed_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open_with(dir.path(), driven(), Models, |traces, _| {
        Arc::new(Failing { traces, failures: Mutex::new(vec![ErrorKind::Other]), asked: channel().0 })
    })
    .await;
    let trace = trace(registered(&*bench.records, "A").await.id, 10);
    let spec = JobSpec::Estimation { trace_id: trace.id, settings: Default::default() };
    let error = bench.jobs.upload(trace.clone(), csv(), spec).await.unwrap_err();
    assert!(matches!(error, StoreError::File { .. }), "{error}");
    assert_eq!((files(dir.path()), bench.records.trace(trace.id).await.unwrap()), (0, None));
}

#[tokio::test]
async fn a_failure_of_the_store_that_may_pass_is_waited_for_and_another_one_fails_the_job() {
    for (kind, state, left, runs) in
        [(ErrorKind::StorageFull, JobState::Succeeded, 1, 2), (ErrorKind::PermissionDenied, JobState::Failed, 0, 1)]
    {
        let dir = tempfile::tempdir().unwrap();
        let (asked, was_asked) = channel();
        let counted = Counted::default();
        let bench = Bench::open_with(dir.path(), driven(), counted.clone(), |traces, _| {
            Arc::new(Failing { traces, failures: Mutex::new(vec![kind]), asked })
        })
        .await;
        let job = bench.jobs.enqueue(simulation()).await.unwrap();
        assert_eq!(bench.run_all().await, 1);
        let job = bench.job(job.id).await;
        assert_eq!((job.state, job.attempt), (state, 1), "{:?}", job.error);
        assert_eq!((counted.runs(), was_asked.try_iter().count(), files(dir.path())), (1, runs, left));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_while_the_store_is_waited_for_puts_the_job_back() {
    let dir = tempfile::tempdir().unwrap();
    let (asked, was_asked) = channel();
    let settings = JobSettings { workers: 1, ..driven() };
    let bench = Bench::open_with(dir.path(), settings, Models, |traces, _| {
        Arc::new(Failing { traces, failures: Mutex::new(vec![ErrorKind::StorageFull; 1000]), asked })
    })
    .await;
    bench.jobs.start().await.unwrap();
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    seen(was_asked).await;
    bench.jobs.stop().await;
    let job = bench.job(job.id).await;
    assert_eq!((job.state, job.attempt, job.error), (JobState::Queued, 0, None));
}

/// Notes whether a trace had a record already when its bytes were durable.
struct Witness {
    traces: LocalTraces,
    records: Arc<dyn Records>,
    seen: Arc<Mutex<Vec<(Id, bool)>>>,
}

#[async_trait]
impl Traces for Witness {
    async fn put(&self, id: Id, bytes: Vec<u8>) -> Result<(), StoreError> {
        self.traces.put(id, bytes).await?;
        let recorded = self.records.trace(id).await?.is_some();
        self.seen.lock().unwrap().push((id, recorded));
        Ok(())
    }

    async fn get(&self, id: Id) -> Result<Option<Vec<u8>>, StoreError> {
        self.traces.get(id).await
    }

    async fn ids_ending_in(&self, end: u8) -> Result<Vec<Id>, StoreError> {
        self.traces.ids_ending_in(end).await
    }

    async fn set_aside(&self, id: Id) -> Result<(), StoreError> {
        self.traces.set_aside(id).await
    }

    async fn delete(&self, id: Id) -> Result<(), StoreError> {
        self.traces.delete(id).await
    }
}

#[tokio::test]
async fn a_trace_is_durable_before_its_record_is_there() {
    let dir = tempfile::tempdir().unwrap();
    let seen = Arc::<Mutex<Vec<(Id, bool)>>>::default();
    let noted = seen.clone();
    let bench = Bench::open_with(dir.path(), driven(), Models, |traces, records| {
        Arc::new(Witness { traces, records, seen: noted })
    })
    .await;
    let (uploaded, _) = bench.upload(registered(&*bench.records, "A").await.id, 10, csv()).await;
    let job = bench.jobs.enqueue(simulation()).await.unwrap();
    assert_eq!(bench.run_all().await, 2);
    let simulated = bench.job(job.id).await.result.unwrap()["trace_id"].as_str().unwrap().parse().unwrap();
    assert_eq!(*seen.lock().unwrap(), [(uploaded.id, false), (simulated, false)]);
    for id in [uploaded.id, simulated] {
        assert!(bench.records.trace(id).await.unwrap().is_some());
    }
}

#[tokio::test]
async fn bytes_that_a_killed_process_left_without_a_record_are_set_aside_at_the_next_start() {
    let (dir, unrecorded) = (tempfile::tempdir().unwrap(), Id::now());
    let kept = {
        let bench = Bench::open(dir.path(), driven(), Models).await;
        let (kept, _) = bench.upload(registered(&*bench.records, "A").await.id, 10, csv()).await;
        bench.traces.put(unrecorded, csv()).await.unwrap();
        kept.id
    };
    let bench = Bench::open(dir.path(), driven(), Models).await;
    bench.jobs.start().await.unwrap();
    assert_eq!(bench.traces.get(unrecorded).await.unwrap(), None);
    assert!(dir.path().join("traces/unrecorded").join(unrecorded.to_string()).exists());
    assert!(bench.traces.get(kept).await.unwrap().is_some());
}

#[tokio::test]
async fn bytes_that_changed_since_they_were_kept_fail_the_job() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let (trace, job) = bench.upload(registered(&*bench.records, "A").await.id, 10, csv()).await;
    let changed = String::from_utf8(csv()).unwrap().replacen("0.1", "0.2", 1);
    bench.traces.put(trace.id, changed.into_bytes()).await.unwrap();
    assert_eq!(bench.run_all().await, 1);
    let job = bench.job(job.id).await;
    assert_eq!(job.state, JobState::Failed);
    assert!(job.error.as_ref().unwrap().contains("SHA-256"), "{:?}", job.error);
}
