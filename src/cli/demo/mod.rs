//! `elevon demo`: the service, a simulated fleet that is fed to it over HTTP, and what comes out.

mod client;
mod feed;
mod fleet;
mod summary;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use clap::Args;
use tokio::sync::oneshot;
use tokio::task::JoinError;

use super::Failure;
use super::serve::{refused, stop_signal};
use crate::app::{AppError, Application};
use crate::config::Config;
use crate::telemetry;
use client::Client;

/// Arguments of `elevon demo`.
#[derive(Debug, Args)]
pub struct DemoArgs {
    /// Address to listen on, loopback only; port 0 takes a free one
    #[arg(long, value_name = "ADDR:PORT", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,
    /// Folder of the database and the traces; a fleet that is there already is kept and completed
    #[arg(long, value_name = "DIR", default_value = "data/demo")]
    data: PathBuf,
    /// End after the last job, with status 0 only if every job succeeded
    #[arg(long)]
    exit: bool,
}

/// Runs the command.
pub fn run(args: &DemoArgs) -> Result<(), Failure> {
    let mut config = Config::load(None).map_err(Failure::usage)?;
    config.http.listen = args.listen;
    config.store.data.clone_from(&args.data);
    config.log.filter = "warn".into();
    telemetry::start_log(&config.log).map_err(Failure::usage)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().map_err(Failure::work)?;
    let ended = runtime.block_on(demo(&config, args.exit));
    // Dropping the runtime would wait for whatever still computes.
    runtime.shutdown_background();
    ended
}

async fn demo(config: &Config, exit: bool) -> Result<(), Failure> {
    let stopped = stop_signal().map_err(Failure::work)?;
    let application = Application::build(config).await.map_err(refused)?;
    let address = format!("http://{}", application.address());
    let (stop, told) = oneshot::channel::<()>();
    let mut service = tokio::spawn(application.run(async {
        // A sender that is dropped stops the service as well.
        let _ = told.await;
    }));
    let client = Client::new(&address);
    let feeding = tokio::task::spawn_blocking(move || show(&client));
    let shown = tokio::select! {
        shown = feeding => shown.context("the demo ended early").and_then(|shown| shown),
        ended = &mut service => return Err(ended_early(ended)),
        () = stopped => Err(anyhow!("interrupted before the last job ended")),
    };
    if shown.is_ok() && !exit {
        println!("\nDashboard: {address}/\nThe service stays up; ctrl-c ends it.");
        tokio::select! {
            () = stop_signal().map_err(Failure::work)? => {}
            ended = &mut service => return Err(ended_early(ended)),
        }
    }
    let _ = stop.send(());
    let stopped = service.await.map_err(Failure::work)?.map_err(Failure::work);
    shown.map_err(Failure::work).and(stopped)
}

/// A service that ended before it was told to.
fn ended_early(ended: Result<Result<(), AppError>, JoinError>) -> Failure {
    match ended {
        Ok(Ok(())) => Failure::work(anyhow!("the service ended early")),
        Ok(Err(error)) => Failure::work(error),
        Err(error) => Failure::work(error),
    }
}

/// Feeds the fleet, waits for every job and prints the ranking.
fn show(client: &Client) -> anyhow::Result<()> {
    let started = Instant::now();
    println!("elevon {} at {}", crate::VERSION, client.address());
    let tally = feed::feed(client)?;
    println!(
        "{} flights of {} actuators: {} estimates succeeded, {} failed, in {:.0} s\n",
        tally.flights,
        tally.actuators,
        tally.succeeded,
        tally.failed,
        started.elapsed().as_secs_f64()
    );
    summary::print(client)?;
    if tally.failed > 0 {
        bail!("{} of {} jobs did not succeed", tally.failed, tally.succeeded + tally.failed);
    }
    Ok(())
}
