//! Workers: each takes the next id, claims its job, computes on a thread of its own, and ends the attempt in the store.

use std::future::{Future, ready};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::task::spawn_blocking;
use tokio::time::{self, MissedTickBehavior, interval_at, sleep};

use super::Jobs;
use super::run::{Finding, RunError, Work, conclude, panic_text, prepare};
use super::text::causes;
use super::watching::Watching;
use crate::store::StoreError;
use crate::store::records::{self, Id, Job, JobKind, JobState, Outcome};

/// How often a running attempt writes its progress, and learns that it was cancelled.
const PROGRESS_EVERY: Duration = Duration::from_millis(500);
/// How long a worker waits before it asks a failed store again.
const STORE_PAUSE: Duration = Duration::from_secs(1);

/// What a single step of a worker did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// It ran a job.
    Ran,
    /// It took an id whose job does not wait any more.
    Skipped,
    /// It found nothing to do.
    Empty,
}

/// Why an attempt was asked to end early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Early {
    /// Its job was cancelled.
    Cancelled,
    /// It took too long.
    Late,
    /// The service stops.
    Stopping,
}

impl Jobs {
    /// Runs jobs, one at a time, until the dispatch is closed.
    pub(super) async fn work(self) {
        while let Some(id) = self.dispatch.next().await {
            self.run(id).await;
        }
    }

    /// A worker's single step: runs the job that waits longest, if one waits.
    pub async fn try_run_next(&self) -> Step {
        let next = tokio::select! {
            biased;
            id = self.dispatch.next() => id,
            () = ready(()) => None,
        };
        match next {
            Some(id) => self.run(id).await,
            None => Step::Empty,
        }
    }

    async fn run(&self, id: Id) -> Step {
        let claimed = self.insist(id, || self.records.claim_job(id, records::now())).await;
        let Some(job) = claimed.inspect_err(|error| refused(id, error)).ok().flatten() else {
            return Step::Skipped;
        };
        let started = Instant::now();
        let prepared = self.insist(id, || prepare(&job, self.records.as_ref(), self.traces.as_ref())).await;
        let found = match prepared {
            Ok(work) => self.supervise(&job, work).await,
            Err(error) => {
                self.give_up(&job, error).await;
                None
            }
        };
        match found {
            Some(Ok(finding)) => match self.insist(id, || conclude(finding.clone(), self.traces.as_ref())).await {
                Ok(outcome) => self.finish(&job, outcome).await,
                Err(error) => self.give_up(&job, error).await,
            },
            Some(Err(error)) => self.fail(&job, error).await,
            None => {}
        }
        metrics::histogram!("elevon_job_duration_seconds", "kind" => job.kind.name()).record(started.elapsed());
        Step::Ran
    }

    /// Computes, writes progress, and sees that the attempt ends when it should. What was found or why nothing was;
    /// `None` when the attempt's end is in the store already.
    async fn supervise(&self, job: &Job, work: Work) -> Option<Result<Finding, String>> {
        let watching = Arc::new(Watching::default());
        // A thread for work that blocks, so that those of the runtime go on answering.
        let mut computing = spawn_blocking({
            let (compute, watching) = (self.compute.clone(), watching.clone());
            move || compute.compute(work, watching.as_ref())
        });
        let mut early = None;
        let mut late = std::pin::pin!(sleep(self.settings.time_limit));
        let mut tick = interval_at(time::Instant::now() + PROGRESS_EVERY, PROGRESS_EVERY);
        tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let ended = loop {
            tokio::select! {
                ended = &mut computing => break ended,
                () = &mut late, if early.is_none() => {
                    early = Some(Early::Late);
                    watching.end();
                    let limit = self.settings.time_limit.as_secs_f64();
                    self.fail(job, format!("took longer than the limit of {limit} s")).await;
                }
                () = self.stop.cancelled(), if early.is_none() => {
                    early = Some(Early::Stopping);
                    watching.end();
                }
                _ = tick.tick(), if early.is_none() => {
                    match self.records.report_progress(job.id, job.attempt, watching.fraction()).await {
                        Ok(true) => {}
                        Ok(false) => {
                            early = Some(Early::Cancelled);
                            watching.end();
                        }
                        Err(error) => tracing::warn!(job_id = %job.id, error = causes(&error), "progress not written"),
                    }
                }
            }
        };
        match (ended, early) {
            (Ok(Ok(finding)), None | Some(Early::Stopping)) => Some(Ok(finding)),
            (_, Some(Early::Cancelled | Early::Late)) => None,
            (_, Some(Early::Stopping)) => {
                self.release(job).await;
                None
            }
            (Ok(Err(error)), None) => Some(Err(causes(&error))),
            (Err(ended), None) => Some(Err(panic_text(ended))),
        }
    }

    async fn release(&self, job: &Job) {
        match self.records.release_job(job.id, job.attempt).await {
            Ok(_) => tracing::info!(job_id = %job.id, attempt = job.attempt, "job put back to the queue"),
            Err(error) => tracing::warn!(job_id = %job.id, error = causes(&error), "job left to the next start"),
        }
    }

    /// Fails an attempt, or puts it back when only the service's end kept the store from answering.
    async fn give_up(&self, job: &Job, error: RunError) {
        if error.may_pass() { self.release(job).await } else { self.fail(job, causes(&error)).await }
    }

    async fn fail(&self, job: &Job, error: String) {
        self.finish(job, Outcome::Failed { error }).await;
    }

    /// Ends an attempt in the store; what it found counts only if it still ran.
    async fn finish(&self, job: &Job, outcome: Outcome) {
        let now = records::now();
        let finished = self.insist(job.id, || self.records.finish_job(job.id, job.attempt, &outcome, now)).await;
        match (finished, outcome) {
            (Ok(true), outcome) => self.finished(job, &outcome).await,
            (Ok(false), Outcome::Simulated { trace, .. }) => self.forget(trace.id).await,
            (Ok(false), _) => {}
            (Err(error), outcome) => {
                refused(job.id, &error);
                if let Outcome::Simulated { trace, .. } = outcome {
                    self.forget_unrecorded(trace.id).await;
                }
            }
        }
    }

    /// Says that a job ended, and forecasts again from what it found.
    async fn finished(&self, job: &Job, outcome: &Outcome) {
        let (id, kind, attempt) = (job.id, job.kind.name(), job.attempt);
        if let Outcome::Failed { error } = outcome {
            count_finished(job.kind, JobState::Failed);
            tracing::warn!(job_id = %id, kind, attempt, error, "job failed");
            return;
        }
        count_finished(job.kind, JobState::Succeeded);
        tracing::info!(job_id = %id, kind, attempt, "job succeeded");
        if let Outcome::Estimated { trace_id, .. } = outcome
            && let Err(error) = self.insist(id, || self.forecast_after(*trace_id)).await
        {
            tracing::warn!(job_id = %id, error = causes(&error), "forecast left to its next reader");
        }
    }

    async fn forecast_after(&self, trace: Id) -> Result<(), StoreError> {
        let record = self.records.trace(trace).await?;
        let known = record.and_then(|record| record.actuator_id.zip(record.recorded_at));
        let Some((actuator_id, recorded_at)) = known else { return Ok(()) };
        let Some(actuator) = self.records.actuator(actuator_id).await? else { return Ok(()) };
        self.forecast(&actuator).await?;
        self.fill_trend(&actuator, (trace, recorded_at)).await
    }

    /// Asks until the store answers, for what must not be lost. An error is one that would never pass, or, when the
    /// service stops first, the last one.
    async fn insist<T, E, F>(&self, job: Id, ask: impl Fn() -> F) -> Result<T, RunError>
    where
        E: Into<RunError>,
        F: Future<Output = Result<T, E>>,
    {
        let mut told = false;
        loop {
            let error = match ask().await.map_err(Into::into) {
                Err(error) if error.may_pass() => error,
                answer => return answer,
            };
            if !told {
                told = true;
                tracing::error!(job_id = %job, error = causes(&error), "the store fails a job; it is asked again");
            }
            tokio::select! {
                () = self.stop.cancelled() => return Err(error),
                () = sleep(STORE_PAUSE) => {}
            }
        }
    }
}

/// Says that the store refused a job's beginning or end, which the next start makes up for.
fn refused(job: Id, error: &RunError) {
    tracing::error!(job_id = %job, error = causes(error), "the store failed a job; the next start queues it again");
}

/// Counts a job that ended.
pub(super) fn count_finished(kind: JobKind, state: JobState) {
    metrics::counter!("elevon_jobs_finished_total", "kind" => kind.name(), "state" => state.name()).increment(1);
}
