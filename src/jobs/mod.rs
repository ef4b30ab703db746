//! Jobs: long work that is queued durably, run by workers, watched, cancelled, and run again after a crash.
//!
//! A job's row in the store is the truth. The dispatch only wakes a worker, which then claims the row; whatever it finds
//! counts only if its attempt still runs.

pub mod alerts;
pub mod baselines;
pub mod dispatch;
pub mod kind;
pub mod lives;
pub mod run;
pub mod sets;
pub mod text;
mod watching;
mod worker;

use std::future::Future;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use tokio::sync::Mutex;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

use crate::store::records::{self, Actuator, ForecastRecord, Id, Job, JobState, NewJob, TraceRecord};
use crate::store::{Records, StoreError, Traces};
use alerts::AlertSettings;
use dispatch::Dispatch;
use kind::JobSpec;
use run::predict::RiskQuestion;
use run::{Compute, Models, predict};
use text::causes;

pub use worker::Step;

/// Limits of the jobs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JobSettings {
    /// Jobs that run at once; none with 0.
    pub workers: usize,
    /// Jobs that may wait.
    pub queue_limit: u64,
    /// Attempts that a job has when the service ends while it runs.
    pub attempts_max: u32,
    /// The longest that an attempt may take.
    pub time_limit: Duration,
    /// The longest that a stop waits for attempts which were asked to end.
    pub stop_limit: Duration,
    /// The usage ahead, in the actuator's unit, over which the fleet's risk is counted.
    pub risk_window: f64,
    /// The probability of a failure at which to act, above 0 and below 1.
    pub act_at_risk: f64,
    /// When alerts are raised and cleared.
    pub alerts: AlertSettings,
}

impl Default for JobSettings {
    fn default() -> Self {
        Self {
            workers: 1,
            queue_limit: 10_000,
            attempts_max: 3,
            time_limit: Duration::from_secs(300),
            stop_limit: Duration::from_secs(10),
            risk_window: 100.0,
            act_at_risk: 0.05,
            alerts: AlertSettings::default(),
        }
    }
}

impl JobSettings {
    /// What every stored forecast answers.
    fn asked(&self) -> RiskQuestion {
        let Self { risk_window, act_at_risk, .. } = *self;
        RiskQuestion { risk_window, within: risk_window, act_at_risk }
    }
}

/// The jobs of a service, and the forecasts that follow from them. Clones share everything.
#[derive(Clone)]
pub struct Jobs {
    records: Arc<dyn Records>,
    traces: Arc<dyn Traces>,
    dispatch: Arc<dyn Dispatch>,
    compute: Arc<dyn Compute>,
    settings: JobSettings,
    stop: CancellationToken,
    tasks: TaskTracker,
    /// Held by the one who brings the fleet's forecasts up to date.
    refreshing: Arc<Mutex<()>>,
}

impl Jobs {
    /// The jobs kept in `records`, computed by elevon's own models. Nothing runs before [`Jobs::start`].
    #[must_use]
    pub fn new(
        records: Arc<dyn Records>,
        traces: Arc<dyn Traces>,
        dispatch: Arc<dyn Dispatch>,
        settings: JobSettings,
    ) -> Self {
        Self::with_compute(records, traces, dispatch, settings, Arc::new(Models))
    }

    /// The same with other computations.
    #[must_use]
    pub fn with_compute(
        records: Arc<dyn Records>,
        traces: Arc<dyn Traces>,
        dispatch: Arc<dyn Dispatch>,
        settings: JobSettings,
        compute: Arc<dyn Compute>,
    ) -> Self {
        let (stop, tasks) = (CancellationToken::new(), TaskTracker::new());
        Self { records, traces, dispatch, compute, settings, stop, tasks, refreshing: Arc::default() }
    }

    /// Takes up what an earlier process left, deletes what it kept of traces without a record, starts the workers, and
    /// makes stale forecasts again meanwhile.
    ///
    /// # Errors
    /// The store fails.
    pub async fn start(&self) -> Result<(), StoreError> {
        self.records.expire_forecasts(&predict::basis(&self.settings)).await?;
        for id in self.records.recover_jobs(self.settings.attempts_max, records::now()).await? {
            self.dispatch.publish(id).await;
        }
        self.sweep().await?;
        for _ in 0..self.settings.workers {
            self.tasks.spawn(self.clone().work());
        }
        self.tasks.spawn(self.clone().refresh_at_start());
        Ok(())
    }

    async fn refresh_at_start(self) {
        tokio::select! {
            () = self.stop.cancelled() => {}
            refreshed = self.refresh_stale() => {
                if let Err(error) = refreshed {
                    tracing::warn!(error = causes(&error), "forecasts left to their next reader");
                }
            }
        }
    }

    /// Ends the workers. What runs is asked to end early and goes back to the queue, its attempt not counted. What has
    /// not ended after [`JobSettings::stop_limit`] is left: the next start queues it again, its attempt counted.
    pub async fn stop(&self) {
        self.stop.cancel();
        self.dispatch.close();
        self.tasks.close();
        if timeout(self.settings.stop_limit, self.tasks.wait()).await.is_err() {
            tracing::warn!(tasks = self.tasks.len(), "work that does not end is left; the next start queues it again");
        }
    }

    /// Keeps a trace and queues its estimation. Both are durable when this returns, and neither is there when it
    /// fails. It goes on to its end when the caller stops waiting.
    ///
    /// # Errors
    /// A full queue; the store fails.
    pub async fn upload(&self, trace: TraceRecord, bytes: Vec<u8>, spec: JobSpec) -> Result<Job, StoreError> {
        let jobs = self.clone();
        self.to_the_end(async move {
            if let Err(error) = jobs.traces.put(trace.id, bytes).await {
                // A trace may have its final name already, and only that name may not be durable.
                jobs.forget(trace.id).await;
                return Err(error);
            }
            let job = new_job(&spec);
            if let Err(error) = jobs.records.insert_upload(&trace, &job, jobs.settings.queue_limit).await {
                jobs.forget_unrecorded(trace.id).await;
                return Err(error);
            }
            jobs.dispatch.publish(job.id).await;
            Ok(queued(job))
        })
        .await
    }

    /// Queues a job. It goes on to its end when the caller stops waiting.
    ///
    /// # Errors
    /// A full queue; the store fails.
    pub async fn enqueue(&self, spec: JobSpec) -> Result<Job, StoreError> {
        let jobs = self.clone();
        self.to_the_end(async move {
            let job = new_job(&spec);
            jobs.records.insert_job(&job, jobs.settings.queue_limit).await?;
            jobs.dispatch.publish(job.id).await;
            Ok(queued(job))
        })
        .await
    }

    /// Cancels a job that is queued or running, and returns it as it is now. A running attempt ends soon after.
    ///
    /// # Errors
    /// The store fails.
    pub async fn cancel(&self, id: Id) -> Result<Option<Job>, StoreError> {
        let now = records::now();
        let job = self.records.cancel_job(id, now).await?;
        if let Some(job) = &job
            && job.state == JobState::Cancelled
            && job.finished_at == Some(now)
        {
            worker::count_finished(job.kind, JobState::Cancelled);
        }
        Ok(job)
    }

    /// The forecast of an actuator at its revision or a later one: the stored one, or one made now and stored.
    ///
    /// # Errors
    /// The store fails.
    pub async fn forecast(&self, actuator: &Actuator) -> Result<ForecastRecord, StoreError> {
        predict::forecast(self.records.as_ref(), self.compute.clone(), actuator, &self.settings).await
    }

    /// Makes the forecast of an actuator whose history or thresholds have changed, beside whatever else goes on: alerts and the
    /// fleet do not wait for somebody to read it.
    pub fn forecast_soon(&self, actuator: Id) {
        let jobs = self.clone();
        self.tasks.spawn(async move {
            if let Err(error) = jobs.refresh(actuator).await {
                tracing::warn!(actuator_id = %actuator, error = causes(&error), "forecast left to its next reader");
            }
        });
    }

    /// Brings the forecast of an actuator up to date, if there is such an actuator.
    async fn refresh(&self, actuator: Id) -> Result<(), StoreError> {
        if let Some(actuator) = self.records.actuator(actuator).await? {
            self.forecast(&actuator).await?;
        }
        Ok(())
    }

    /// The remaining life of an actuator as it is served, with the risk within other usage ahead and at another risk to act
    /// than the service's own, where they are told. The stored one answers the service's own; others are made anew and not
    /// stored.
    ///
    /// # Errors
    /// The store fails.
    pub async fn remaining_life(
        &self,
        actuator: &Actuator,
        within: Option<f64>,
        act_at_risk: Option<f64>,
    ) -> Result<serde_json::Value, StoreError> {
        let own = self.settings.asked();
        let (within, act_at_risk) = (within.unwrap_or(own.within), act_at_risk.unwrap_or(own.act_at_risk));
        let asked = RiskQuestion { within, act_at_risk, ..own };
        let kept = self.forecast(actuator).await?;
        if asked == own {
            return Ok(kept.document);
        }
        let (records, compute) = (self.records.as_ref(), self.compute.clone());
        Ok(predict::document(&predict::answer(records, compute, actuator, &kept, &asked).await?))
    }

    /// Gives a trace, recorded at a time, its step of its actuator's trend, unless it has one.
    async fn fill_trend(&self, actuator: &Actuator, trace: (Id, Timestamp)) -> Result<(), StoreError> {
        let (records, compute) = (self.records.as_ref(), self.compute.clone());
        predict::fill_trend(records, compute, actuator, trace, &self.settings).await
    }

    /// Brings every forecast up to date, for a list of the whole fleet. Callers take turns: who waited finds it done.
    ///
    /// # Errors
    /// The store fails.
    pub async fn refresh_stale(&self) -> Result<(), StoreError> {
        const AT_ONCE: u32 = 100;
        let _turn = self.refreshing.lock().await;
        loop {
            let stale = self.records.stale_forecasts(AT_ONCE).await?;
            for id in &stale {
                self.refresh(*id).await?;
            }
            if stale.len() < AT_ONCE as usize {
                return Ok(());
            }
        }
    }

    /// Sets the bytes of every trace without a record aside, while nothing else keeps any.
    async fn sweep(&self) -> Result<(), StoreError> {
        for end in 0..=u8::MAX {
            let ids = self.traces.ids_ending_in(end).await?;
            for id in self.records.unrecorded_traces(&ids).await? {
                tracing::warn!(trace_id = %id, "a trace's bytes without a record were set aside");
                self.traces.set_aside(id).await?;
            }
        }
        Ok(())
    }

    /// Deletes bytes if no record names them: a commit that failed may have happened all the same.
    async fn forget_unrecorded(&self, trace: Id) {
        if matches!(self.records.trace(trace).await, Ok(None)) {
            self.forget(trace).await;
        }
    }

    /// Deletes bytes that no record names.
    async fn forget(&self, trace: Id) {
        if let Err(error) = self.traces.delete(trace).await {
            tracing::warn!(trace_id = %trace, error = causes(&error), "bytes without a record not deleted");
        }
    }

    /// Runs a future to its end even if the caller is dropped halfway, as a request is when its client goes away.
    async fn to_the_end<T: Send + 'static>(&self, future: impl Future<Output = T> + Send + 'static) -> T {
        self.tasks.spawn(future).await.unwrap_or_else(|ended| resume_unwind(ended.into_panic()))
    }
}

fn new_job(spec: &JobSpec) -> NewJob {
    let spec_json = serde_json::to_value(spec).expect("a spec's fields have names");
    NewJob { id: Id::now(), kind: spec.kind(), spec: spec_json, created_at: records::now() }
}

/// The job as the store has it right after it was queued.
fn queued(NewJob { id, kind, spec, created_at }: NewJob) -> Job {
    Job {
        id,
        kind,
        state: JobState::Queued,
        progress: 0.0,
        attempt: 0,
        created_at,
        started_at: None,
        finished_at: None,
        result: None,
        error: None,
        spec,
    }
}
