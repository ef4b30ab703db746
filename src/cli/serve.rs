//! `elevon serve`: the service.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use tokio::signal::unix::{SignalKind, signal};

use super::Failure;
use crate::app::{AppError, Application};
use crate::config::Config;
use crate::telemetry;

/// What `elevon serve` can be told.
#[derive(Debug, Args)]
pub(crate) struct ServeArgs {
    /// Address to listen on, loopback only; port 0 takes a free one [default: 127.0.0.1:8080]
    #[arg(long, value_name = "ADDR:PORT")]
    listen: Option<SocketAddr>,
    /// Folder of the database and the traces, created where it is missing [default: ./data]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Settings, as documented in config/elevon.toml; ELEVON_* variables win over it
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

/// Serves until the process is told to end.
pub(super) fn run(args: ServeArgs) -> Result<(), Failure> {
    let config = args.settings()?;
    telemetry::start_log(&config.log).map_err(Failure::usage)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().map_err(Failure::work)?;
    let served = runtime.block_on(serve(&config)).map_err(refused);
    // Without waiting for a computation that does not end: its job is queued again at the next start.
    runtime.shutdown_background();
    served
}

/// Why the service did not run, as a failure of the command.
pub(super) fn refused(error: AppError) -> Failure {
    match error {
        AppError::NotLoopback { .. } => Failure::usage(error),
        _ => Failure::work(error),
    }
}

impl ServeArgs {
    fn settings(self) -> Result<Config, Failure> {
        let mut config = Config::load(self.config.as_deref()).map_err(Failure::usage)?;
        config.http.listen = self.listen.unwrap_or(config.http.listen);
        config.store.data = self.data.unwrap_or(config.store.data);
        Ok(config)
    }
}

async fn serve(config: &Config) -> Result<(), AppError> {
    let stopped = stop_signal().map_err(AppError::Serve)?;
    let application = Application::build(config).await?;
    let (address, data) = (application.address(), config.store.data.display());
    tracing::info!(version = crate::VERSION, address = %format!("http://{address}"), %data, "the service listens");
    application.run(stopped).await?;
    tracing::info!("the service stopped");
    Ok(())
}

/// Ends when the process is told to: by ctrl-c or SIGTERM, from now on.
pub(super) fn stop_signal() -> std::io::Result<impl Future<Output = ()> + Send + 'static> {
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    })
}
