//! A service's jobs over a store of their own, and computations to put in the place of the models.

use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, LazyLock, Mutex};

use elevon::estimation::Settings;
use elevon::formats::{Format, write};
use elevon::jobs::dispatch::{Dispatch, InProcess};
use elevon::jobs::kind::{JobSpec, SimulationSpec};
use elevon::jobs::run::{Compute, Finding, Models, RunError, Work};
use elevon::jobs::{JobSettings, Jobs, Step};
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::numeric::digest::sha256_hex;
use elevon::numeric::watch::{Unwatched, Watch};
use elevon::store::local::LocalTraces;
use elevon::store::records::{Id, Job, TraceRecord};
use elevon::store::sqlite::SqliteRecords;
use elevon::store::{Records, Traces};

use crate::store_contract::samples;

/// Jobs, and the store beneath them.
pub struct Bench {
    pub jobs: Jobs,
    pub records: Arc<dyn Records>,
    pub traces: Arc<dyn Traces>,
}

/// No worker of its own: steps are driven.
pub fn driven() -> JobSettings {
    JobSettings { workers: 0, ..JobSettings::default() }
}

impl Bench {
    /// Opens a store, as a process does that starts.
    pub async fn open(dir: &Path, settings: JobSettings, compute: impl Compute + 'static) -> Self {
        Self::open_with(dir, settings, compute, |traces, _| Arc::new(traces)).await
    }

    /// The same with other traces, made of the real ones and of the records.
    pub async fn open_with(
        dir: &Path,
        settings: JobSettings,
        compute: impl Compute + 'static,
        traces: impl FnOnce(LocalTraces, Arc<dyn Records>) -> Arc<dyn Traces>,
    ) -> Self {
        let records: Arc<dyn Records> = Arc::new(SqliteRecords::open(dir).await.unwrap());
        let traces = traces(LocalTraces::open(&dir.join("traces")).unwrap(), records.clone());
        let dispatch: Arc<dyn Dispatch> = Arc::new(InProcess::default());
        let jobs = Jobs::with_compute(records.clone(), traces.clone(), dispatch, settings, Arc::new(compute));
        Self { jobs, records, traces }
    }

    /// Uploads bytes as a trace of an actuator.
    pub async fn upload(&self, actuator: Id, second: i64, bytes: Vec<u8>) -> (TraceRecord, Job) {
        self.upload_with(actuator, second, bytes, Settings::default()).await
    }

    /// The same, to be estimated with other settings.
    pub async fn upload_with(
        &self,
        actuator: Id,
        second: i64,
        bytes: Vec<u8>,
        settings: Settings,
    ) -> (TraceRecord, Job) {
        let mut trace = samples::trace(actuator, second);
        (trace.columns, trace.sample_rate_hz) = (String::new(), None);
        trace.sha256 = sha256_hex(&bytes);
        let spec = JobSpec::Estimation { trace_id: trace.id, settings };
        let job = self.jobs.upload(trace.clone(), bytes, spec).await.unwrap();
        (trace, job)
    }

    pub async fn job(&self, id: Id) -> Job {
        self.records.job(id).await.unwrap().unwrap()
    }

    /// Drives steps until nothing is left to do; the number of jobs that ran.
    pub async fn run_all(&self) -> usize {
        let mut ran = 0;
        loop {
            match self.jobs.try_run_next().await {
                Step::Ran => ran += 1,
                Step::Skipped => {}
                Step::Empty => return ran,
            }
        }
    }
}

/// A trace of the thesis's diagnostic command in CSV, with KGM 0.2 and FDJ 600 N.
pub fn csv() -> Vec<u8> {
    static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let faults = Faults { kgm: 0.2, fdj_n: 600.0, ..Faults::default() };
        let recipe = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, 5.0, 1000.0);
        write(Format::Csv, &simulate(&recipe, &ParameterSet::reference(), &Unwatched).unwrap())
    });
    BYTES.clone()
}

/// A simulation that takes no time.
pub fn simulation() -> JobSpec {
    JobSpec::Simulation(SimulationSpec {
        model: ModelKind::Monitoring,
        parameter_set: None,
        fluid: None,
        command: "diagnostic".into(),
        faults: Faults::default(),
        external_load_n: None,
        supply_pressure_pa: None,
        noise_power: 0.0,
        seed: 1,
        duration_s: 0.1,
        sample_rate_hz: 1000.0,
    })
}

/// The models, counting how often they are asked.
#[derive(Clone, Default)]
pub struct Counted(Arc<AtomicU32>);

impl Counted {
    pub fn runs(&self) -> u32 {
        self.0.load(Ordering::SeqCst)
    }
}

impl Compute for Counted {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        Models.compute(work, watch)
    }
}

/// Panics the first time, then computes.
#[derive(Default)]
pub struct PanicsOnce(AtomicU32);

impl Compute for PanicsOnce {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        assert!(self.0.fetch_add(1, Ordering::SeqCst) > 0, "the spool fell out");
        Models.compute(work, watch)
    }
}

/// Says that it began, then works until it is asked to end.
pub struct Endless {
    began: Sender<()>,
}

impl Endless {
    pub fn new() -> (Self, Receiver<()>) {
        let (began, seen) = channel();
        (Self { began }, seen)
    }
}

impl Compute for Endless {
    fn compute(&self, _: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        self.began.send(()).unwrap();
        watch.progress(0.5);
        while !watch.cancelled() {
            std::thread::yield_now();
        }
        Err(RunError::Estimation(elevon::estimation::EstimationError::Cancelled))
    }
}

/// Says that it began, waits to be let go, and then computes to the end whatever it is asked.
pub struct Held {
    began: Sender<()>,
    go: Mutex<Receiver<()>>,
}

impl Held {
    pub fn new() -> (Self, Receiver<()>, Sender<()>) {
        let (began, seen) = channel();
        let (let_go, go) = channel();
        (Self { began, go: Mutex::new(go) }, seen, let_go)
    }
}

impl Compute for Held {
    fn compute(&self, work: Work, _: &dyn Watch) -> Result<Finding, RunError> {
        self.began.send(()).unwrap();
        self.go.lock().unwrap().recv().unwrap();
        Models.compute(work, &Unwatched)
    }
}

/// Waits for a sign from a computing thread.
pub async fn seen(sign: Receiver<()>) {
    tokio::task::spawn_blocking(move || sign.recv().unwrap()).await.unwrap();
}
