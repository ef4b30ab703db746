//! Feeding the fleet to the service: registrations, a replacement, and a trace for every flight.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::thread;
use std::time::Duration;

use anyhow::Context;
use indicatif::{MultiProgress, ProgressBar};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::client::{Client, text};
use super::fleet::{FLEET, FLIGHTS, NOISE_POWER_MA2_S, recorded, replaced};
use crate::cli::progress::style;
use crate::formats::{self, Format};
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, Simulation, simulate};
use crate::numeric::watch::Unwatched;

/// Between two looks at the jobs.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// What came of feeding.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    pub actuators: usize,
    pub flights: usize,
    pub succeeded: usize,
    pub failed: usize,
}

/// Registers the fleet, flies every flight that the service does not have yet, and waits for every job. A part is replaced
/// when the flights before are estimated, so that the service sees of it what it would have seen at the time.
pub fn feed(client: &Client) -> anyhow::Result<Tally> {
    let unfinished = unfinished(client)?;
    wait(client, unfinished, &ProgressBar::hidden())?;
    let ids = register(client)?;
    let missing = missing(client, &ids)?;
    let bars = MultiProgress::new();
    let bar = |what: &'static str| {
        let bar = bars.add(ProgressBar::new(missing.len() as u64));
        bar.set_style(style("{prefix:>22} [{bar:40}] {pos:>3} of {len}"));
        bar.set_prefix(what);
        bar
    };
    let (uploads, estimates) = (bar("flights simulated"), bar("faults estimated"));
    let set = ParameterSet::reference();
    let mut tally = Tally { actuators: FLEET.len(), flights: FLEET.len() * FLIGHTS as usize, ..Tally::default() };
    let replacements: BTreeSet<u32> = FLEET.iter().filter_map(|member| member.replaced_before).collect();
    let mut rest = &missing[..];
    for end in replacements.into_iter().chain([FLIGHTS]) {
        let (now, later) = rest.split_at(rest.partition_point(|&(_, flight)| flight < end));
        let (succeeded, failed) = thread::scope(|scope| {
            let (sent, jobs) = std::sync::mpsc::channel();
            let waiting = scope.spawn(|| wait(client, jobs, &estimates));
            for flight in now.chunk_by(|a, b| a.1 == b.1) {
                flight.par_iter().try_for_each_with(sent.clone(), |sent, &(index, flight)| {
                    let job = fly(client, &set, &ids[FLEET[index].serial_number], index, flight)?;
                    uploads.inc(1);
                    // The receiver is gone only when waiting has failed, which is told below.
                    let _ = sent.send(job);
                    anyhow::Ok(())
                })?;
            }
            drop(sent);
            waiting.join().map_err(|_| anyhow::anyhow!("waiting for the jobs ended early"))?
        })?;
        tally = Tally { succeeded: tally.succeeded + succeeded, failed: tally.failed + failed, ..tally };
        for member in FLEET.iter().filter(|member| member.replaced_before == Some(end)) {
            replace(client, &ids[member.serial_number], end)?;
        }
        rest = later;
    }
    uploads.finish();
    estimates.finish();
    Ok(tally)
}

/// The jobs of an earlier demo that have not ended.
fn unfinished(client: &Client) -> anyhow::Result<Vec<String>> {
    let mut jobs = client.list("/v1/jobs?state=queued")?;
    jobs.extend(client.list("/v1/jobs?state=running")?);
    jobs.iter().map(|job| text(job, "id").map(str::to_owned)).collect()
}

/// The ids of the fleet's actuators by serial number; those that are new are registered.
fn register(client: &Client) -> anyhow::Result<HashMap<String, String>> {
    let entry = |record: &Value| Ok((text(record, "serial_number")?.to_owned(), text(record, "id")?.to_owned()));
    let mut ids: HashMap<_, _> = client.list("/v1/actuators")?.iter().map(entry).collect::<anyhow::Result<_>>()?;
    for member in FLEET.iter().filter(|member| !ids.contains_key(member.serial_number)).collect::<Vec<_>>() {
        let record = client.post(
            "/v1/actuators",
            &json!({
                "serial_number": member.serial_number,
                "tail_number": member.tail_number,
                "location": member.location,
            }),
        )?;
        let (serial_number, id) = entry(&record)?;
        ids.insert(serial_number, id);
    }
    Ok(ids)
}

/// Reports the replacement of an actuator's part, unless the service knows of it.
fn replace(client: &Client, id: &str, before: u32) -> anyhow::Result<()> {
    let path = format!("/v1/actuators/{id}/maintenance");
    if client.list(&path)?.is_empty() {
        let (at, usage) = replaced(before);
        let note = "demagnetising fast; part changed";
        client.post(&path, &json!({"kind": "replaced", "at": at.to_string(), "usage": usage, "note": note}))?;
    }
    Ok(())
}

/// The flights that the service does not have: (index in the fleet, flight), flight by flight as a fleet flies them.
fn missing(client: &Client, ids: &HashMap<String, String>) -> anyhow::Result<Vec<(usize, u32)>> {
    let mut known = HashSet::new();
    for (index, member) in FLEET.iter().enumerate() {
        for record in client.list(&format!("/v1/actuators/{}/health", ids[member.serial_number]))? {
            known.insert((index, text(&record, "recorded_at")?.to_owned()));
        }
    }
    let all = (0..FLIGHTS).flat_map(|flight| (0..FLEET.len()).map(move |index| (index, flight)));
    Ok(all.filter(|&(index, flight)| !known.contains(&(index, recorded(flight).0.to_string()))).collect())
}

/// Makes the trace of a flight with the reference model and uploads it; returns its job's id.
fn fly(client: &Client, set: &ParameterSet, id: &str, index: usize, flight: u32) -> anyhow::Result<String> {
    let (command, faults, seed) = FLEET[index].flight(index, flight);
    let command = command.parse().context("the demo's own command")?;
    let quiet = Simulation::new(ModelKind::Reference, command, faults, 6.0, 1000.0);
    let recipe = Simulation { noise_power_ma2_s: NOISE_POWER_MA2_S, seed, ..quiet };
    let trace = simulate(&recipe, set, &Unwatched)?;
    let (at, usage) = recorded(flight);
    let path = format!("/v1/actuators/{id}/traces?recorded_at={at}&usage={usage}");
    let accepted = client.post_csv(&path, &formats::write(Format::Csv, &trace))?;
    Ok(text(&accepted["job"], "id")?.to_owned())
}

/// Waits until every job has ended; returns how many succeeded and how many did not.
fn wait(client: &Client, jobs: impl IntoIterator<Item = String>, bar: &ProgressBar) -> anyhow::Result<(usize, usize)> {
    let (mut succeeded, mut failed) = (0, 0);
    for id in jobs {
        loop {
            let job = client.get(&format!("/v1/jobs/{id}"))?;
            match text(&job, "state")? {
                "queued" | "running" => thread::sleep(LOOK_EVERY),
                "succeeded" => break succeeded += 1,
                _ => break failed += 1,
            }
        }
        bar.inc(1);
    }
    Ok((succeeded, failed))
}
