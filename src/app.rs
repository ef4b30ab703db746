//! The service put together: settings in, a running service out.

use std::fs::{File, TryLockError};
use std::io;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::serve::ListenerExt as _;
use thiserror::Error;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;

use crate::config::{Config, ThresholdsConfig, WebhooksConfig};
use crate::http::limits::Limits;
use crate::http::{self, App};
use crate::jobs::alerts::AlertSettings;
use crate::jobs::dispatch::InProcess;
use crate::jobs::{JobSettings, Jobs, sets};
use crate::store::local::{LocalTraces, create_durably};
use crate::store::records::Thresholds;
use crate::store::sqlite::SqliteRecords;
use crate::store::{Records, StoreError, Traces};
use crate::telemetry;
use crate::webhooks::sender::{Sender, SenderSettings};

/// The file in the data folder that is locked while a process works in it.
const LOCK_FILE: &str = "lock";
/// The folder of the traces in the data folder.
const TRACES_DIR: &str = "traces";
/// How often the metrics' samples are folded into their buckets.
const UPKEEP_EVERY: Duration = Duration::from_secs(5);
/// The longest that a stopping service waits for its connections, then for its jobs, then for its store: together less
/// than the 10 s after which whoever stopped it may kill it.
const CONNECTIONS_STOP: Duration = Duration::from_secs(4);
const JOBS_STOP: Duration = Duration::from_secs(4);
const SENDER_STOP: Duration = Duration::from_secs(1);
const STORE_STOP: Duration = Duration::from_secs(1);

/// Why the service could not start or go on.
#[derive(Debug, Error)]
pub enum AppError {
    /// There are no keys, so nobody but this machine may be let in.
    #[error("--listen {address}: expected a loopback address such as 127.0.0.1:8080, because the service has no keys")]
    NotLoopback {
        /// The address that was asked for.
        address: SocketAddr,
    },
    /// The address cannot be had.
    #[error("--listen {address}: cannot be had")]
    Listen {
        /// The address that was asked for.
        address: SocketAddr,
        /// Why not.
        source: io::Error,
    },
    /// Another process works in the data folder.
    #[error("--data {}: another elevon works in this folder", data.display())]
    DataInUse {
        /// The data folder.
        data: PathBuf,
    },
    /// The data folder cannot be used.
    #[error("--data {}: cannot be used", data.display())]
    Data {
        /// The data folder.
        data: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The listener failed.
    #[error("the listener failed")]
    Serve(#[source] io::Error),
}

/// A service that is ready to run. Dropping it frees its address and its data folder.
pub struct Application {
    listener: TcpListener,
    address: SocketAddr,
    router: Router,
    jobs: Jobs,
    sender: Sender,
    records: SqliteRecords,
    /// Unlocked by the kernel when the process ends, however it ends.
    _lock: File,
}

impl Application {
    /// Takes the data folder and the address, creates what is missing, and brings the database up to date. Nothing is
    /// answered and no job runs before [`Application::run`].
    ///
    /// # Errors
    /// An address that is not loopback or is in use, a data folder that is in use or cannot be used, a failing store.
    pub async fn build(config: &Config) -> Result<Self, AppError> {
        let (address, data) = (config.http.listen, config.store.data.as_path());
        if !address.ip().is_loopback() {
            return Err(AppError::NotLoopback { address });
        }
        telemetry::metrics();
        let lock = lock(data)?;
        let in_use = |source| AppError::Listen { address, source };
        let listener = TcpListener::bind(address).await.map_err(in_use)?;
        let address = listener.local_addr().map_err(in_use)?;
        let records = SqliteRecords::open(data).await?;
        sets::keep_built_in(&records).await?;
        let app = app(config, &records, LocalTraces::open(&data.join(TRACES_DIR))?);
        let jobs = app.jobs.clone();
        let sender = Sender::new(Arc::clone(&app.records), sender_settings(&config.webhooks));
        Ok(Self { listener, address, router: http::router::router(app), jobs, sender, records, _lock: lock })
    }

    /// The address that the service listens on, its port never 0.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The routes, for callers within the process.
    pub fn router(&self) -> Router {
        self.router.clone()
    }

    /// The jobs, for callers within the process.
    #[must_use]
    pub fn jobs(&self) -> &Jobs {
        &self.jobs
    }

    /// What sends the outbox, for callers within the process.
    #[must_use]
    pub fn sender(&self) -> &Sender {
        &self.sender
    }

    /// Serves until `shutdown` is there, then takes no more connections, finishes the requests that were begun, and
    /// stops the jobs; what ran goes back to the queue.
    ///
    /// # Errors
    /// The store fails at the start, or the listener fails.
    pub async fn run(self, shutdown: impl Future<Output = ()> + Send + 'static) -> Result<(), AppError> {
        self.jobs.start().await?;
        self.sender.start();
        let stopping = CancellationToken::new();
        let signalled = stopping.clone();
        tokio::spawn(async move {
            shutdown.await;
            signalled.cancel();
        });
        let upkeep = tokio::spawn(keep_up_metrics());
        let listener = self.listener.tap_io(|stream| {
            if let Err(error) = stream.set_nodelay(true) {
                tracing::debug!(%error, "a connection keeps its delay");
            }
        });
        let served = axum::serve(listener, self.router).with_graceful_shutdown(stopping.clone().cancelled_owned());
        let ended = tokio::select! {
            ended = served.into_future() => ended,
            () = overdue(stopping) => Ok(()),
        };
        upkeep.abort();
        tokio::join!(self.jobs.stop(), self.sender.stop());
        if tokio::time::timeout(STORE_STOP, self.records.close()).await.is_err() {
            tracing::warn!("the database is still in use; the service stops all the same");
        }
        ended.map_err(AppError::Serve)
    }
}

/// What the handlers work with.
fn app(config: &Config, records: &SqliteRecords, traces: LocalTraces) -> App {
    let records: Arc<dyn Records> = Arc::new(records.clone());
    let traces: Arc<dyn Traces> = Arc::new(traces);
    let settings = JobSettings {
        workers: config.jobs.workers(),
        queue_limit: config.jobs.queue_limit,
        attempts_max: config.jobs.attempts_max,
        time_limit: Duration::from_secs_f64(config.jobs.time_limit_s),
        stop_limit: JOBS_STOP,
        risk_window: config.prognostics.risk_window,
        act_at_risk: config.prognostics.act_at_risk,
        alerts: AlertSettings {
            risk_raise: config.alerts.risk_raise,
            risk_clear: config.alerts.risk_clear,
            threshold_clear: config.alerts.threshold_clear,
        },
    };
    let jobs = Jobs::new(Arc::clone(&records), Arc::clone(&traces), Arc::new(InProcess::default()), settings);
    let baseline_traces = config.prognostics.baseline_traces;
    let ThresholdsConfig { kgm, fdj_n } = config.prognostics.thresholds;
    let (thresholds, limits) = (Thresholds { kgm, fdj_n }, Limits::from(&config.http));
    App { records, traces, jobs, baseline_traces, thresholds, limits }
}

fn sender_settings(config: &WebhooksConfig) -> SenderSettings {
    SenderSettings {
        timeout: Duration::from_secs_f64(config.timeout_s),
        retry_first: Duration::from_secs_f64(config.retry_first_s),
        retry_max: Duration::from_secs_f64(config.retry_max_s),
        attempts_max: config.attempts_max,
        age_max: Duration::from_secs_f64(config.age_max_s),
        poll: Duration::from_secs_f64(config.poll_s),
        keep: Duration::from_secs_f64(config.keep_s),
        stop_limit: SENDER_STOP,
    }
}

/// Creates the data folder where it is missing, and takes it for this process.
fn lock(data: &Path) -> Result<File, AppError> {
    let wrong = |source| AppError::Data { data: data.to_path_buf(), source };
    create_durably(data).map_err(wrong)?;
    let file = File::options().create(true).truncate(false).write(true).open(data.join(LOCK_FILE)).map_err(wrong)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(AppError::DataInUse { data: data.to_path_buf() }),
        Err(TryLockError::Error(source)) => Err(wrong(source)),
    }
}

async fn keep_up_metrics() {
    let mut ticks = tokio::time::interval(UPKEEP_EVERY);
    loop {
        ticks.tick().await;
        telemetry::metrics().run_upkeep();
    }
}

/// Ends when connections had their time to end after the service began to stop.
async fn overdue(stopping: CancellationToken) {
    stopping.cancelled().await;
    tokio::time::sleep(CONNECTIONS_STOP).await;
    tracing::warn!("connections are still open; the service stops all the same");
}
