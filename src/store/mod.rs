//! What is kept: records and traces, each behind one small trait, so that the engine is chosen once, at the start.

pub mod alerts;
mod cursor;
pub mod local;
pub mod records;
pub mod sqlite;
pub mod webhooks;

use std::io;

use async_trait::async_trait;
use jiff::Timestamp;
use thiserror::Error;

use alerts::{Alert, AlertChange, AlertState};
use records::{
    Actuator, ActuatorUpdate, FleetShare, FleetTally, ForecastRecord, HealthRecord, Id, Job, JobState, Maintenance,
    NewJob, Outcome, ParameterSetRecord, TraceRecord, TrendRecord,
};
use webhooks::{Attempt, Delivery, DueDelivery, Secret, Webhook, WebhookChange};

/// Why the store could not do what was asked.
#[derive(Debug, Error)]
pub enum StoreError {
    /// Another record has the same value in a field that must be unique.
    #[error("{field} {value:?} is taken already")]
    Conflict {
        /// The field.
        field: &'static str,
        /// The value that is taken.
        value: String,
    },
    /// As many jobs wait as may wait.
    #[error("{queued} jobs are waiting, {limit} may")]
    QueueFull {
        /// The jobs that wait.
        queued: u64,
        /// The most that may wait.
        limit: u64,
    },
    /// As many records of a kind are kept as may be.
    #[error("there are as many {what} as may be: {limit}")]
    TooMany {
        /// The kind of record.
        what: &'static str,
        /// The most that may be kept.
        limit: u32,
    },
    /// A cursor that this list did not make.
    #[error("cursor: found {found:?}, expected the next_cursor of a page of this list")]
    Cursor {
        /// What was given.
        found: String,
    },
    /// A stored value cannot be read back: the database was changed by something else, or is damaged.
    #[error("the stored {what} {id} cannot be read: {reason}")]
    Corrupt {
        /// The kind of record.
        what: &'static str,
        /// Its id.
        id: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The database failed.
    #[error("the database failed")]
    Database(#[from] sqlx::Error),
    /// The database's schema could not be brought up to date.
    #[error("the database could not be migrated")]
    Migration(#[from] sqlx::migrate::MigrateError),
    /// The file system failed.
    #[error("the trace store failed at {path}")]
    File {
        /// What was being read or written, relative to the store.
        path: String,
        /// Why it failed.
        source: io::Error,
    },
}

impl StoreError {
    /// Whether the same request may succeed later, once somebody else has let go or made room.
    #[must_use]
    pub fn may_pass(&self) -> bool {
        match self {
            Self::Database(sqlx::Error::PoolTimedOut) => true,
            Self::Database(sqlx::Error::Io(source)) | Self::File { source, .. } => io_may_pass(source),
            Self::Database(sqlx::Error::Database(error)) => {
                let code = error.code().and_then(|code| code.parse::<u32>().ok());
                code.is_some_and(|code| SQLITE_MAY_PASS.contains(&(code & 0xff)))
            }
            _ => false,
        }
    }
}

/// SQLite's result codes that may pass: busy, locked, a failure of input or output, full, a file that cannot be opened.
const SQLITE_MAY_PASS: [u32; 5] = [5, 6, 10, 13, 14];

fn io_may_pass(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, QuotaExceeded, ResourceBusy, StorageFull, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | QuotaExceeded | ResourceBusy | StorageFull | TimedOut | WouldBlock)
}

/// One page of a list: at most `limit` records after the one that `after` names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// The cursor of the last record already seen, as the store made it.
    pub after: Option<String>,
    /// The most records to return.
    pub limit: u32,
}

/// Records of one page and the cursor of the next, when there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Paged<T> {
    /// The records, in the list's order.
    pub items: Vec<T>,
    /// What to pass as [`Page::after`] for the page that follows.
    pub next_cursor: Option<String>,
}

/// The history of one actuator's current life: what a forecast is made from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LifeHistory {
    /// The actuator's revision that this history belongs to.
    pub revision: i64,
    /// When this life began, when a maintenance event says so.
    pub life_started_at: Option<Timestamp>,
    /// The usage at which this life began, when a maintenance event says so.
    pub life_start_usage: Option<f64>,
    /// The newest estimate of every trace of this life, ascending by time of recording.
    pub records: Vec<HealthRecord>,
}

/// What is kept with a forecast.
#[derive(Debug, Clone, Copy, Default)]
pub struct WithForecast<'a> {
    /// Its step of the trend.
    pub step: Option<&'a TrendRecord>,
    /// What it changes of its actuator's alerts.
    pub alerts: &'a [AlertChange],
    /// What its actuator's lives say of those of its cohorts, in the place of what was kept of the same faults.
    pub shares: &'a [FleetShare],
}

/// An actuator with its newest health and its forecast, for the fleet's list.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetRow {
    /// The actuator.
    pub actuator: Actuator,
    /// Its newest record in this life.
    pub newest: Option<HealthRecord>,
    /// Its stored forecast, possibly of an older revision.
    pub forecast: Option<ForecastRecord>,
    /// Its alerts that are not cleared.
    pub alerts_open: u64,
}

/// Where records are kept. What a method acknowledged survives a kill and a loss of power.
///
/// An actuator's `revision` grows by one with every change to its history (an estimate, an exclusion, a maintenance event), its
/// thresholds or the name of its parameter set, so that a stored forecast can be told from a stale one.
#[async_trait]
pub trait Records: Send + Sync {
    /// Answers when the records can be read and a transaction that writes can begin; for the readiness probe.
    async fn ping(&self) -> Result<(), StoreError>;

    /// Keeps a new actuator. A serial number that is taken is a [`StoreError::Conflict`].
    async fn insert_actuator(&self, actuator: &Actuator) -> Result<(), StoreError>;
    /// One actuator.
    async fn actuator(&self, id: Id) -> Result<Option<Actuator>, StoreError>;
    /// Changes an actuator, and returns it as it is now. Its revision grows when a threshold or the parameter set's name becomes
    /// another.
    async fn change_actuator(&self, id: Id, update: &ActuatorUpdate) -> Result<Option<Actuator>, StoreError>;
    /// Actuators in the order of their registration.
    async fn actuators(&self, page: &Page) -> Result<Paged<Actuator>, StoreError>;

    /// Keeps a version of a parameter set unless one of its name and hash is kept already: the record as it is kept, and
    /// whether it is new.
    async fn insert_parameter_set(&self, set: &ParameterSetRecord) -> Result<(ParameterSetRecord, bool), StoreError>;
    /// At a start: keeps the set that is built into the program, and pins every actuator of its name to it.
    async fn keep_built_in_set(&self, set: &ParameterSetRecord) -> Result<(), StoreError>;
    /// The version of a parameter set that was kept last.
    async fn newest_parameter_set(&self, name: &str) -> Result<Option<ParameterSetRecord>, StoreError>;
    /// The versions of a parameter set whose hash begins with `prefix`, at most two: enough to see that it is not unique.
    async fn parameter_sets_by_hash(&self, name: &str, prefix: &str) -> Result<Vec<ParameterSetRecord>, StoreError>;
    /// Every version of every parameter set, in the order in which they were kept.
    async fn parameter_sets(&self, page: &Page) -> Result<Paged<ParameterSetRecord>, StoreError>;

    /// Keeps a trace and the job that will estimate from it, both or neither.
    async fn insert_upload(&self, trace: &TraceRecord, job: &NewJob, queue_limit: u64) -> Result<(), StoreError>;
    /// Those of these ids under which no trace is recorded.
    async fn unrecorded_traces(&self, ids: &[Id]) -> Result<Vec<Id>, StoreError>;
    /// One trace's record (its bytes are in the [`Traces`]).
    async fn trace(&self, id: Id) -> Result<Option<TraceRecord>, StoreError>;

    /// Excludes a trace from its actuator's history, or takes it back, and returns it as it is now. What was or will be
    /// estimated from it is kept and stays out of the history as long. The actuator's revision grows when its history changes.
    async fn exclude_trace(&self, id: Id, excluded: bool, reason: &str) -> Result<Option<TraceRecord>, StoreError>;

    /// Keeps a new job, queued.
    async fn insert_job(&self, job: &NewJob, queue_limit: u64) -> Result<(), StoreError>;
    /// One job.
    async fn job(&self, id: Id) -> Result<Option<Job>, StoreError>;
    /// Jobs, newest first, all or those in one state.
    async fn jobs(&self, state: Option<JobState>, page: &Page) -> Result<Paged<Job>, StoreError>;
    /// Number of jobs in each state, every state included.
    async fn job_counts(&self) -> Result<Vec<(JobState, u64)>, StoreError>;
    /// Takes a queued job: it becomes running, its attempt grows by one. `None` when it is not queued any more.
    async fn claim_job(&self, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError>;
    /// Notes how far a running attempt has come (0 to 1). `false`, and nothing noted, when that attempt does not run
    /// any more: that is how it learns of its cancellation.
    async fn report_progress(&self, id: Id, attempt: u32, progress: f64) -> Result<bool, StoreError>;
    /// Ends a running attempt and keeps what it found (an estimate grows the actuator's history and revision; a
    /// simulation adds its trace) in one transaction. `false`, and nothing kept, when that attempt does not run any more.
    async fn finish_job(&self, id: Id, attempt: u32, outcome: &Outcome, now: Timestamp) -> Result<bool, StoreError>;
    /// Puts a running attempt back to the queue as if it had never started, for a service that ends before its work
    /// does. `false` when that attempt does not run any more.
    async fn release_job(&self, id: Id, attempt: u32) -> Result<bool, StoreError>;
    /// Cancels a job that is queued or running and returns it as it is now; a finished one is returned unchanged.
    async fn cancel_job(&self, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError>;
    /// After a start: queues again what was running when the process ended, fails what was running in its attempt number
    /// `attempts_max` or later, and returns the ids of all queued jobs, oldest first.
    async fn recover_jobs(&self, attempts_max: u32, now: Timestamp) -> Result<Vec<Id>, StoreError>;

    /// The history of an actuator, one record per trace that is not excluded (its newest estimate), ascending by time of recording, with
    /// `from <= recorded_at < to`.
    async fn health(
        &self,
        actuator: Id,
        from: Option<Timestamp>,
        to: Option<Timestamp>,
        page: &Page,
    ) -> Result<Paged<HealthRecord>, StoreError>;
    /// The history of the current life: what was recorded since the newest event that starts a life.
    async fn life_history(&self, actuator: Id) -> Result<Option<LifeHistory>, StoreError>;

    /// Keeps a maintenance event and grows the actuator's revision.
    async fn insert_maintenance(&self, event: &Maintenance) -> Result<(), StoreError>;
    /// The maintenance events of an actuator, ascending by their time.
    async fn maintenance(&self, actuator: Id, page: &Page) -> Result<Paged<Maintenance>, StoreError>;

    /// The newest forecast of an actuator, possibly of an older revision.
    async fn forecast(&self, actuator: Id) -> Result<Option<ForecastRecord>, StoreError>;
    /// Keeps a forecast, and with it the step of the trend that it makes, if the actuator still is at the revision that it was
    /// made from; `false`, and nothing kept, otherwise. A step of the same life and newest trace is replaced, others stay.
    async fn store_forecast(&self, forecast: &ForecastRecord, step: Option<&TrendRecord>) -> Result<bool, StoreError> {
        self.store_forecast_with(forecast, &WithForecast { step, ..WithForecast::default() }).await
    }
    /// The same with all that follows from the forecast, and what the webhooks are told of its alerts: all in one
    /// transaction. What is so already is not changed: an alert that is open is not raised again, a cleared one stays cleared.
    async fn store_forecast_with(&self, forecast: &ForecastRecord, with: &WithForecast<'_>)
    -> Result<bool, StoreError>;
    /// What the actuators of a cohort say of its lives, without one of them.
    async fn fleet_tally(&self, cohort: &str, without: Id) -> Result<FleetTally, StoreError>;
    /// The prior that the forecast of an actuator at a revision had of a fault from its fleet; none where it had none, or where
    /// another forecast is kept.
    async fn forecast_prior(&self, actuator: Id, revision: i64, fault: &str) -> Result<Vec<f64>, StoreError>;
    /// Keeps a step of the trend unless one of its life and trace is kept already; whether it was kept.
    async fn fill_trend(&self, step: &TrendRecord) -> Result<bool, StoreError>;
    /// The trend of an actuator's forecasts, life by life, in each ascending by usage, then by the time at which they were made:
    /// the steps whose trace was recorded at `from <= recorded_at < to` and is not excluded.
    async fn trend(
        &self,
        actuator: Id,
        from: Option<Timestamp>,
        to: Option<Timestamp>,
        page: &Page,
    ) -> Result<Paged<TrendRecord>, StoreError>;
    /// Makes the forecasts stale that rest on something else than `basis`: an older version, other settings.
    async fn expire_forecasts(&self, basis: &str) -> Result<(), StoreError>;
    /// Actuators whose forecast is missing or of an older revision, at most `limit`.
    async fn stale_forecasts(&self, limit: u32) -> Result<Vec<Id>, StoreError>;
    /// The fleet, riskiest first: risk falling in whole percents, then median remaining life rising, those without a
    /// forecast last.
    async fn fleet(&self, tail_number: Option<&str>, page: &Page) -> Result<Paged<FleetRow>, StoreError>;

    /// The alerts of an actuator that are not cleared.
    async fn open_alerts(&self, actuator: Id) -> Result<Vec<Alert>, StoreError>;
    /// One alert.
    async fn alert(&self, id: Id) -> Result<Option<Alert>, StoreError>;
    /// Alerts, newest first: all, those in one state, those of one actuator.
    async fn alerts(
        &self,
        state: Option<AlertState>,
        actuator: Option<Id>,
        page: &Page,
    ) -> Result<Paged<Alert>, StoreError>;
    /// Acknowledges an alert that is open, tells the webhooks in the same transaction, and returns it as it is now and whether
    /// this changed it.
    async fn acknowledge_alert(&self, id: Id, note: &str, now: Timestamp) -> Result<Option<(Alert, bool)>, StoreError>;

    /// Keeps a new webhook with its secret. One more than [`webhooks::WEBHOOKS_MAX`] is [`StoreError::TooMany`].
    async fn insert_webhook(&self, webhook: &Webhook, secret: &Secret) -> Result<(), StoreError>;
    /// One webhook.
    async fn webhook(&self, id: Id) -> Result<Option<Webhook>, StoreError>;
    /// Webhooks in the order in which they were made.
    async fn webhooks(&self, page: &Page) -> Result<Paged<Webhook>, StoreError>;
    /// Changes a webhook and returns it as it is now.
    async fn change_webhook(&self, id: Id, change: &WebhookChange) -> Result<Option<Webhook>, StoreError>;
    /// Deletes a webhook, its secret and its deliveries. `false` when there is none.
    async fn delete_webhook(&self, id: Id) -> Result<bool, StoreError>;
    /// Queues a delivery that only tries a webhook, or finds the one that waits already.
    async fn ping_webhook(&self, id: Id, now: Timestamp) -> Result<Option<Delivery>, StoreError>;
    /// What was and is to be sent to a webhook, newest first.
    async fn deliveries(&self, webhook: Id, page: &Page) -> Result<Paged<Delivery>, StoreError>;
    /// Of each enabled webhook, the delivery that has been due for longest, if one is due.
    async fn due_deliveries(&self, now: Timestamp) -> Result<Vec<DueDelivery>, StoreError>;
    /// Keeps how an attempt to deliver ended, and what follows. `false` when the delivery does not wait any more.
    async fn record_attempt(&self, delivery: Id, attempt: &Attempt) -> Result<bool, StoreError>;
    /// Forgets deliveries that are over and were written before a time; the number of them.
    async fn forget_deliveries(&self, before: Timestamp) -> Result<u64, StoreError>;
}

/// Where the bytes of traces are kept.
#[async_trait]
pub trait Traces: Send + Sync {
    /// Keeps bytes under an id; they are durable when this returns.
    async fn put(&self, id: Id, bytes: Vec<u8>) -> Result<(), StoreError>;
    /// The bytes under an id, or `None`.
    async fn get(&self, id: Id) -> Result<Option<Vec<u8>>, StoreError>;
    /// The ids that end in a byte and have bytes: for all of them, part by part.
    async fn ids_ending_in(&self, end: u8) -> Result<Vec<Id>, StoreError>;
    /// Puts the bytes under an id where nobody finds them but an operator: no record names them, which a kill between bytes
    /// and record explains, but so does a database that was restored from an older backup.
    async fn set_aside(&self, id: Id) -> Result<(), StoreError>;
    /// Forgets the bytes under an id, if any: for a trace whose record could not be kept.
    async fn delete(&self, id: Id) -> Result<(), StoreError>;
}
