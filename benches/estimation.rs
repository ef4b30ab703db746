//! What the estimation costs on one core: model runs in lock-step at several batch sizes, and a whole estimate.
//!
//! `cargo bench --bench estimation`
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on should panic")]

use std::hint::black_box;
use std::time::Instant;

use elevon::estimation::evaluate::{Evaluator, Proposal};
use elevon::estimation::{Settings, estimate, features, manoeuvre};
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::numeric::watch::Unwatched;

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
    let evaluator = Evaluator::new(&trace, &features::measure(&trace, &found).unwrap(), &set);
    for size in [1, 2, 6, 8, 16, 24, 32, 40, 80] {
        let proposals: Vec<Proposal> =
            (0..size).map(|i| Proposal { kgm: f64::from(i) / 100.0, fdj_n: 200.0 + 10.0 * f64::from(i) }).collect();
        let batch_ms = least_ms(20, || drop(black_box(evaluator.features(&proposals))));
        println!("batch of {size:2}: {batch_ms:6.2} ms, {:.4} ms a candidate", batch_ms / f64::from(size));
    }

    let settings = Settings::default();
    let whole_ms = least_ms(10, || drop(black_box(estimate(&trace, &set, &settings, &Unwatched))));
    println!("estimate, 40 x 10 and polish: {whole_ms:.1} ms");
}
