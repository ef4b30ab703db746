//! What the estimation costs on one core: model runs in lock-step at several batch sizes, a whole estimate, and the
//! program from a file to its result.
//!
//! `cargo bench --bench estimation`
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on should panic")]

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use rayon::ThreadPoolBuilder;

use elevon::estimation::evaluate::{Evaluator, Proposal};
use elevon::estimation::{Settings, estimate, features, manoeuvre};
use elevon::formats::{self, Format, ReadOptions};
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::Trace;
use elevon::numeric::watch::Unwatched;

/// Timings of what takes long enough to be disturbed.
const WHOLE_REPEATS: usize = 30;

/// The least of several timings, ms: what the machine does when nothing else disturbs it.
fn least_ms(repeats: usize, mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let started = Instant::now();
        work();
        started.elapsed().as_secs_f64() * 1e3
    };
    (0..repeats).map(once).fold(f64::INFINITY, f64::min)
}

fn main() {
    let set = ParameterSet::reference();
    let faults = Faults { kgm: 0.2, fdj_n: 600.0, ..Faults::default() };
    let recipe = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, 6.0, 1000.0);
    let trace = simulate(&recipe, &set, &Unwatched).unwrap();
    let simulation_ms = least_ms(5, || drop(black_box(simulate(&recipe, &set, &Unwatched))));
    println!("reference model, 6 s: {simulation_ms:.1} ms, {:.0} ns a step", simulation_ms * 1e6 / 600_001.0);

    let found = manoeuvre::find(trace.time_s(), trace.position_command_m());
    let evaluator = Evaluator::new(&trace, &features::measure(&trace, &found, &set.shared()).unwrap(), &set);
    let batch_ms = |size: u32| {
        let proposal =
            |i| Proposal { kgm: f64::from(i) * 0.95 / f64::from(size), fdj_n: 200.0 + f64::from(10 * i % 1800) };
        let proposals: Vec<Proposal> = (0..size).map(proposal).collect();
        least_ms(20, || drop(black_box(evaluator.features(&proposals))))
    };
    for size in [1, 2, 6, 8, 16, 24, 32, 40, 80] {
        let ms = batch_ms(size);
        println!("batch of {size:2}: {ms:6.2} ms, {:.4} ms a candidate", ms / f64::from(size));
    }
    for threads in [1, 2] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        println!("batch of 400 on {threads} threads: {:.2} ms", pool.install(|| batch_ms(400)));
    }

    let settings = Settings::default();
    let whole_ms = least_ms(WHOLE_REPEATS, || drop(black_box(estimate(&trace, &set, &settings, &Unwatched))));
    println!("estimate, 40 x 10 and polish: {whole_ms:.1} ms");
    from_file_to_result(&trace);
}

/// The program as a user starts it on a file of one diagnostic trace. It needs one core.
fn from_file_to_result(trace: &Trace) {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diagnostic.csv");
    let bytes = formats::write(Format::Csv, trace);
    fs::write(&file, &bytes).unwrap();
    let (mut whole_ms, mut start_ms) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..WHOLE_REPEATS {
        let started = Instant::now();
        let output =
            Command::new(env!("CARGO_BIN_EXE_elevon")).arg("estimate").arg("--json").arg(&file).output().unwrap();
        let once_ms = started.elapsed().as_secs_f64() * 1e3;
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(told[0]["verdict"], "conclusive");
        // What the program itself took for reading and estimating; the rest is its start and end.
        let inside_ms = told[0]["elapsed_s"].as_f64().unwrap() * 1e3;
        (whole_ms, start_ms) = (whole_ms.min(once_ms), start_ms.min(once_ms - inside_ms));
    }
    let read_ms = least_ms(WHOLE_REPEATS, || {
        let bytes = fs::read(&file).unwrap();
        drop(black_box(formats::read(Format::Csv, &bytes, &ReadOptions::default()).unwrap()));
    });
    println!(
        "the program on a file of {} kB: {whole_ms:.1} ms from its start to its end (goal 60)",
        bytes.len() / 1000
    );
    println!("of which start and end {start_ms:.1} ms, reading the file {read_ms:.1} ms (goal 20 for both)");
}
