//! Records in SQLite: one writer, so that no write ever meets another, and several readers beside it.

mod actuators;
mod alerts;
mod cohorts;
#[cfg(test)]
mod durability;
mod fleet;
mod health;
mod jobs;
mod parameter_sets;
#[cfg(test)]
mod plans;
mod row;
mod traces;
mod trend;
#[cfg(test)]
mod upgrades;
mod uploads;
mod webhooks;

use std::path::Path;
use std::time::Duration;

use async_trait::async_trait;
use jiff::Timestamp;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{Connection as _, Sqlite, SqliteConnection, Transaction};

use super::alerts::{Alert, AlertState};
use super::local::create_durably;
use super::records::{
    Actuator, ActuatorUpdate, FleetTally, ForecastRecord, HealthRecord, Id, Job, JobState, Maintenance, NewJob,
    Outcome, ParameterSetRecord, TraceRecord, TrendRecord,
};
use super::webhooks::{Attempt, Delivery, DueDelivery, Secret, Webhook, WebhookChange};
use super::{FleetRow, LifeHistory, Page, Paged, Records, StoreError, WithForecast};

/// The database's file in its folder.
pub const FILE: &str = "elevon.db";
/// Connections that only read; more did not serve more pages on two cores.
const READERS: u32 = 4;
/// How long a connection waits for another process's lock, such as a backup's.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

static MIGRATIONS: Migrator = sqlx::migrate!("migrations/sqlite");

/// Records in one SQLite file.
#[derive(Debug, Clone)]
pub struct SqliteRecords {
    writer: SqlitePool,
    readers: SqlitePool,
}

impl SqliteRecords {
    /// Opens the database in `dir`, creates both where they are missing, and brings the schema up to date.
    ///
    /// # Errors
    /// A folder or file that cannot be created or is no database; a schema newer than this program.
    pub async fn open(dir: &Path) -> Result<Self, StoreError> {
        create_durably(dir).map_err(|source| StoreError::File { path: dir.display().to_string(), source })?;
        let options = SqliteConnectOptions::new()
            .filename(dir.join(FILE))
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(BUSY_TIMEOUT);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .after_release(|connection, _| Box::pin(is_between_transactions(connection)))
            .connect_with(options.clone())
            .await?;
        MIGRATIONS.run(&writer).await?;
        let readers = SqlitePoolOptions::new().max_connections(READERS).connect_with(options.read_only(true)).await?;
        Ok(Self { writer, readers })
    }

    /// Ends every connection, once what runs on them has ended.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

/// Whether a connection may be used again. SQLite itself rolls a transaction back when, say, the disk is full; the
/// driver then still counts itself within one and would refuse every later transaction, so the connection is closed.
async fn is_between_transactions(connection: &mut SqliteConnection) -> Result<bool, sqlx::Error> {
    // A transaction that was dropped is rolled back before the ping is answered.
    connection.ping().await?;
    Ok(!connection.is_in_transaction())
}

/// Begins a transaction that holds the write lock from its start.
async fn begin(writer: &SqlitePool) -> Result<Transaction<'static, Sqlite>, StoreError> {
    Ok(writer.begin_with("BEGIN IMMEDIATE").await?)
}

#[async_trait]
impl Records for SqliteRecords {
    async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT 1 FROM actuators LIMIT 1").fetch_optional(&self.readers).await?;
        Ok(begin(&self.writer).await?.rollback().await?)
    }

    async fn insert_actuator(&self, actuator: &Actuator) -> Result<(), StoreError> {
        actuators::insert(&self.writer, actuator).await
    }

    async fn actuator(&self, id: Id) -> Result<Option<Actuator>, StoreError> {
        actuators::one(&self.readers, id).await
    }

    async fn change_actuator(&self, id: Id, update: &ActuatorUpdate) -> Result<Option<Actuator>, StoreError> {
        actuators::change(&self.writer, id, update).await
    }

    async fn actuators(&self, page: &Page) -> Result<Paged<Actuator>, StoreError> {
        actuators::list(&self.readers, page).await
    }

    async fn insert_parameter_set(&self, set: &ParameterSetRecord) -> Result<(ParameterSetRecord, bool), StoreError> {
        parameter_sets::insert(&self.writer, set).await
    }

    async fn keep_built_in_set(&self, set: &ParameterSetRecord) -> Result<(), StoreError> {
        parameter_sets::keep_built_in(&self.writer, set).await
    }

    async fn newest_parameter_set(&self, name: &str) -> Result<Option<ParameterSetRecord>, StoreError> {
        parameter_sets::newest(&self.readers, name).await
    }

    async fn parameter_sets_by_hash(&self, name: &str, prefix: &str) -> Result<Vec<ParameterSetRecord>, StoreError> {
        parameter_sets::by_hash(&self.readers, name, prefix).await
    }

    async fn parameter_sets(&self, page: &Page) -> Result<Paged<ParameterSetRecord>, StoreError> {
        parameter_sets::list(&self.readers, page).await
    }

    async fn insert_upload(&self, trace: &TraceRecord, job: &NewJob, queue_limit: u64) -> Result<(), StoreError> {
        uploads::insert(&self.writer, trace, job, queue_limit).await
    }

    async fn unrecorded_traces(&self, ids: &[Id]) -> Result<Vec<Id>, StoreError> {
        traces::unrecorded(&self.readers, ids).await
    }

    async fn trace(&self, id: Id) -> Result<Option<TraceRecord>, StoreError> {
        traces::one(&self.readers, id).await
    }

    async fn exclude_trace(&self, id: Id, excluded: bool, reason: &str) -> Result<Option<TraceRecord>, StoreError> {
        traces::exclude(&self.writer, id, excluded, reason).await
    }

    async fn insert_job(&self, job: &NewJob, queue_limit: u64) -> Result<(), StoreError> {
        jobs::insert(&self.writer, job, queue_limit).await
    }

    async fn job(&self, id: Id) -> Result<Option<Job>, StoreError> {
        jobs::one(&self.readers, id).await
    }

    async fn jobs(&self, state: Option<JobState>, page: &Page) -> Result<Paged<Job>, StoreError> {
        jobs::list(&self.readers, state, page).await
    }

    async fn job_counts(&self) -> Result<Vec<(JobState, u64)>, StoreError> {
        jobs::counts(&self.readers).await
    }

    async fn claim_job(&self, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError> {
        jobs::claim(&self.writer, id, now).await
    }

    async fn report_progress(&self, id: Id, attempt: u32, progress: f64) -> Result<bool, StoreError> {
        jobs::report_progress(&self.writer, id, attempt, progress).await
    }

    async fn finish_job(&self, id: Id, attempt: u32, outcome: &Outcome, now: Timestamp) -> Result<bool, StoreError> {
        jobs::finish(&self.writer, id, attempt, outcome, now).await
    }

    async fn release_job(&self, id: Id, attempt: u32) -> Result<bool, StoreError> {
        jobs::release(&self.writer, id, attempt).await
    }

    async fn cancel_job(&self, id: Id, now: Timestamp) -> Result<Option<Job>, StoreError> {
        jobs::cancel(&self.writer, id, now).await
    }

    async fn recover_jobs(&self, attempts_max: u32, now: Timestamp) -> Result<Vec<Id>, StoreError> {
        jobs::recover(&self.writer, attempts_max, now).await
    }

    async fn health(
        &self,
        actuator: Id,
        from: Option<Timestamp>,
        to: Option<Timestamp>,
        page: &Page,
    ) -> Result<Paged<HealthRecord>, StoreError> {
        health::list(&self.readers, actuator, from, to, page).await
    }

    async fn life_history(&self, actuator: Id) -> Result<Option<LifeHistory>, StoreError> {
        health::life(&self.readers, actuator).await
    }

    async fn insert_maintenance(&self, event: &Maintenance) -> Result<(), StoreError> {
        health::insert_maintenance(&self.writer, event).await
    }

    async fn maintenance(&self, actuator: Id, page: &Page) -> Result<Paged<Maintenance>, StoreError> {
        health::maintenance(&self.readers, actuator, page).await
    }

    async fn forecast(&self, actuator: Id) -> Result<Option<ForecastRecord>, StoreError> {
        fleet::forecast(&self.readers, actuator).await
    }

    async fn store_forecast_with(
        &self,
        forecast: &ForecastRecord,
        with: &WithForecast<'_>,
    ) -> Result<bool, StoreError> {
        fleet::store_forecast(&self.writer, forecast, with).await
    }

    async fn fleet_tally(&self, cohort: &str, without: Id) -> Result<FleetTally, StoreError> {
        cohorts::tally(&self.readers, cohort, without).await
    }

    async fn forecast_prior(&self, actuator: Id, revision: i64, fault: &str) -> Result<Vec<f64>, StoreError> {
        cohorts::prior(&self.readers, actuator, revision, fault).await
    }

    async fn fill_trend(&self, step: &TrendRecord) -> Result<bool, StoreError> {
        trend::fill(&self.writer, step).await
    }

    async fn trend(
        &self,
        actuator: Id,
        from: Option<Timestamp>,
        to: Option<Timestamp>,
        page: &Page,
    ) -> Result<Paged<TrendRecord>, StoreError> {
        trend::list(&self.readers, actuator, from, to, page).await
    }

    async fn expire_forecasts(&self, basis: &str) -> Result<(), StoreError> {
        fleet::expire(&self.writer, basis).await
    }

    async fn stale_forecasts(&self, limit: u32) -> Result<Vec<Id>, StoreError> {
        fleet::stale(&self.readers, limit).await
    }

    async fn fleet(&self, tail_number: Option<&str>, page: &Page) -> Result<Paged<FleetRow>, StoreError> {
        fleet::list(&self.readers, tail_number, page).await
    }

    async fn open_alerts(&self, actuator: Id) -> Result<Vec<Alert>, StoreError> {
        alerts::open(&self.readers, actuator).await
    }

    async fn alert(&self, id: Id) -> Result<Option<Alert>, StoreError> {
        alerts::one(&self.readers, id).await
    }

    async fn alerts(
        &self,
        state: Option<AlertState>,
        actuator: Option<Id>,
        page: &Page,
    ) -> Result<Paged<Alert>, StoreError> {
        alerts::list(&self.readers, state, actuator, page).await
    }

    async fn acknowledge_alert(&self, id: Id, note: &str, now: Timestamp) -> Result<Option<(Alert, bool)>, StoreError> {
        alerts::acknowledge(&self.writer, id, note, now).await
    }

    async fn insert_webhook(&self, webhook: &Webhook, secret: &Secret) -> Result<(), StoreError> {
        webhooks::insert(&self.writer, webhook, secret).await
    }

    async fn webhook(&self, id: Id) -> Result<Option<Webhook>, StoreError> {
        webhooks::one(&self.readers, id).await
    }

    async fn webhooks(&self, page: &Page) -> Result<Paged<Webhook>, StoreError> {
        webhooks::list(&self.readers, page).await
    }

    async fn change_webhook(&self, id: Id, change: &WebhookChange) -> Result<Option<Webhook>, StoreError> {
        webhooks::change(&self.writer, id, change).await
    }

    async fn delete_webhook(&self, id: Id) -> Result<bool, StoreError> {
        webhooks::delete(&self.writer, id).await
    }

    async fn ping_webhook(&self, id: Id, now: Timestamp) -> Result<Option<Delivery>, StoreError> {
        webhooks::ping(&self.writer, id, now).await
    }

    async fn deliveries(&self, webhook: Id, page: &Page) -> Result<Paged<Delivery>, StoreError> {
        webhooks::deliveries(&self.readers, webhook, page).await
    }

    async fn due_deliveries(&self, now: Timestamp) -> Result<Vec<DueDelivery>, StoreError> {
        webhooks::due(&self.readers, now).await
    }

    async fn record_attempt(&self, delivery: Id, attempt: &Attempt) -> Result<bool, StoreError> {
        webhooks::record(&self.writer, delivery, attempt).await
    }

    async fn forget_deliveries(&self, before: Timestamp) -> Result<u64, StoreError> {
        webhooks::forget(&self.writer, before).await
    }
}
