//! The command line: one file per sub-command.
//!
//! Exit status: 0 done; 1 the work failed; 2 bad usage or bad input. An error is one line on standard error.

mod demo;
mod estimate;
mod methods;
mod openapi;
mod parameter_sets;
mod parameters;
mod progress;
mod remaining_life;
mod reproduce;
mod serve;
mod simulate;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context as _, anyhow};
use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use crate::formats::{Format, FormatError};

/// Prognostic health monitoring of electro-hydraulic flight-control actuators.
#[derive(Debug, Parser)]
#[command(name = "elevon", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the service: HTTP, an embedded database and workers
    Serve(serve::ServeArgs),
    /// Run the service, feed it a simulated fleet and show what comes out
    Demo(demo::DemoArgs),
    /// Run a model and write a trace
    Simulate(simulate::SimulateArgs),
    /// Estimate faults from traces, without a server
    Estimate(estimate::EstimateArgs),
    /// Forecast the remaining life from a history, or score such forecasts
    RemainingLife(remaining_life::RemainingLifeArgs),
    /// Compare the methods of the search at equal evaluations
    Methods(methods::MethodsArgs),
    /// Make the thesis's tables and figures again, ours beside the thesis's
    Reproduce(reproduce::ReproduceArgs),
    /// Show a parameter set, check one, or fit its monitoring model to its reference model
    Parameters(parameters::ParametersArgs),
    /// Print the HTTP interface's specification as YAML
    Openapi,
}

impl Command {
    fn run(self) -> Result<(), Failure> {
        match self {
            Self::Serve(args) => serve::run(args),
            Self::Demo(args) => demo::run(&args),
            Self::Simulate(args) => simulate::run(&args),
            Self::Estimate(args) => estimate::run(&args),
            Self::RemainingLife(args) => remaining_life::run(&args),
            Self::Methods(args) => methods::run(&args),
            Self::Reproduce(args) => reproduce::run(&args),
            Self::Parameters(args) => parameters::run(&args),
            Self::Openapi => openapi::run(),
        }
    }
}

/// Why a command did not end well.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What was asked for cannot be understood: status 2.
    Usage(anyhow::Error),
    /// The work failed: status 1.
    Work(anyhow::Error),
}

impl Failure {
    /// What was asked for cannot be understood.
    pub(crate) fn usage(error: impl Into<anyhow::Error>) -> Self {
        Self::Usage(error.into())
    }

    /// The work failed.
    pub(crate) fn work(error: impl Into<anyhow::Error>) -> Self {
        Self::Work(error.into())
    }

    /// Tells the user, on one line.
    fn report(&self) -> ExitCode {
        let (error, status) = match self {
            Self::Usage(error) => (error, 2),
            Self::Work(error) => (error, 1),
        };
        // Where standard error cannot be written, the status still tells.
        let _ = writeln!(io::stderr(), "elevon: {}", one_line(&format!("{error:#}")));
        ExitCode::from(status)
    }
}

/// Runs the command that `args` ask for; the first of them is the program's name.
#[must_use]
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => return explain(&error),
    };
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Answers a request for help, or says in one line what is wrong with the arguments.
fn explain(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let shown = error.print().is_ok();
            if shown && error.exit_code() == 0 { ExitCode::SUCCESS } else { ExitCode::from(2) }
        }
        _ => {
            let text = error.to_string();
            let end = ["\n\nUsage:", "\n\nFor more"].into_iter().filter_map(|mark| text.find(mark)).min();
            let what = text[..end.unwrap_or(text.len())].trim_start_matches("error: ").to_owned();
            Failure::usage(anyhow!("{what} (see --help)")).report()
        }
    }
}

/// Writes to standard output. Whoever stops reading it has seen enough.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::work(anyhow::Error::new(error).context("standard output")))
        }
        _ => Ok(()),
    }
}

/// The bytes of a file that holds a trace, and its format by its name.
fn read_file(file: &Path) -> Result<(Format, Vec<u8>), Failure> {
    let name = file.display();
    let extension = file.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let format = Format::from_extension(extension).ok_or_else(|| {
        Failure::usage(anyhow!("found the file {:?}, expected a name that ends in .csv or .json", name.to_string()))
    })?;
    let bytes = std::fs::read(file).with_context(|| name.to_string()).map_err(Failure::usage)?;
    Ok((format, bytes))
}

/// A file that cannot be used.
fn refused(file: &Path, errors: &[FormatError]) -> Failure {
    Failure::usage(anyhow!("{}: {}", file.display(), first_of(errors)))
}

/// The first error, and how many more there are.
fn first_of(errors: &[FormatError]) -> String {
    match errors {
        [] => "cannot be read".into(),
        [only] => only.to_string(),
        [first, rest @ ..] => format!("{first} (and {} more)", rest.len()),
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
