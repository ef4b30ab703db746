//! Workers: each takes the next id, claims its job, computes on a thread of its own, and ends the attempt in the store.

use std::error::Error;
use std::future::{Future, ready};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::task::spawn_blocking;
use tokio::time::{self, MissedTickBehavior, interval_at, sleep};

use super::Jobs;
use super::run::{Finding, Work, conclude, panic_text, prepare};
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
        let Some(Some(job)) = self.insist(id, || self.records.claim_job(id, records::now())).await else {
            return Step::Skipped;
        };
        let started = Instant::now();
        let found = match prepare(&job, self.records.as_ref(), self.traces.as_ref()).await {
            Ok(work) => self.supervise(&job, work).await,
            Err(error) => Some(Err(text(&error))),
        };
        match found {
            Some(Ok(finding)) => match conclude(finding, self.traces.as_ref()).await {
                Ok(outcome) => self.finish(&job, outcome).await,
                Err(error) => self.fail(&job, text(&error)).await,
            },
            Some(Err(error)) => self.fail(&job, error).await,
            None => {}
        }
        metrics::histogram!("job_duration_seconds", "kind" => job.kind.name()).record(started.elapsed());
        Step::Ran
    }

    /// Computes, writes progress, and sees that the attempt ends when it should. What was found or why nothing was;
    /// `None` when the attempt's end is in the store already.
    async fn supervise(&self, job: &Job, work: Work) -> Option<Result<Finding, String>> {
        let watching = Arc::new(Watching::default());
        // Not a thread of the rayon pool: one that waits there for its own batch may take up another whole job first.
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
                        Err(error) => tracing::warn!(job_id = %job.id, error = text(&error), "progress not written"),
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
            (Ok(Err(error)), None) => Some(Err(text(&error))),
            (Err(ended), None) => Some(Err(panic_text(ended))),
        }
    }

    async fn release(&self, job: &Job) {
        match self.records.release_job(job.id, job.attempt).await {
            Ok(_) => tracing::info!(job_id = %job.id, attempt = job.attempt, "job put back to the queue"),
            Err(error) => tracing::warn!(job_id = %job.id, error = text(&error), "job left to the next start"),
        }
    }

    async fn fail(&self, job: &Job, error: String) {
        self.finish(job, Outcome::Failed { error }).await;
    }

    /// Ends an attempt in the store; what it found counts only if it still ran.
    async fn finish(&self, job: &Job, outcome: Outcome) {
        let now = records::now();
        let finished = self.insist(job.id, || self.records.finish_job(job.id, job.attempt, &outcome, now)).await;
        match (finished, outcome) {
            (Some(true), outcome) => self.finished(job, &outcome).await,
            (Some(false), Outcome::Simulated { trace, .. }) => self.forget(trace.id).await,
            (Some(false) | None, _) => {}
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
            && let Err(error) = self.forecast_after(*trace_id).await
        {
            tracing::warn!(job_id = %id, error = text(&error), "forecast left to its next reader");
        }
    }

    async fn forecast_after(&self, trace: Id) -> Result<(), StoreError> {
        let trace = self.records.trace(trace).await?;
        let Some(actuator_id) = trace.and_then(|trace| trace.actuator_id) else { return Ok(()) };
        let Some(actuator) = self.records.actuator(actuator_id).await? else { return Ok(()) };
        self.forecast(&actuator).await.map(drop)
    }

    /// Asks the store until it answers, for what must not be lost; `None` when the answer would never change, or the
    /// service stops first.
    async fn insist<T, F>(&self, job: Id, ask: impl Fn() -> F) -> Option<T>
    where
        F: Future<Output = Result<T, StoreError>>,
    {
        let mut told = false;
        loop {
            match ask().await {
                Ok(answer) => return Some(answer),
                Err(error) => {
                    let again = error.may_pass();
                    if !told {
                        told = true;
                        tracing::error!(job_id = %job, error = text(&error), again, "the store failed a job");
                    }
                    if !again {
                        return None;
                    }
                }
            }
            tokio::select! {
                () = self.stop.cancelled() => return None,
                () = sleep(STORE_PAUSE) => {}
            }
        }
    }
}

/// Counts a job that ended.
pub(super) fn count_finished(kind: JobKind, state: JobState) {
    metrics::counter!("jobs_finished_total", "kind" => kind.name(), "state" => state.name()).increment(1);
}

/// An error with its causes, in one line.
pub(super) fn text(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    text
}
