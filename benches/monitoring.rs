//! What the optimiser's model runs cost on one core, beside the same large step in plain C.
//!
//! `cargo bench --bench monitoring`. The C program (`monitoring.c`) is compiled here for this very processor, without fused
//! multiply-add as the program itself; where there is no C compiler the comparison is left out and said to be. Its features
//! are compared with ours first. Then both run a batch of 40 in turn, many times, and the ratio is told of each pair.
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on should panic")]

#[path = "../tests/it/models/fine.rs"]
#[allow(dead_code, reason = "the sweep has the rest")]
mod fine;

use std::fmt::Write as _;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use elevon::estimation::evaluate::{Evaluator, Proposal};
use elevon::models::monitoring::Model;
use elevon::models::monitoring::large_step::{LargeStep, TIME_STEP_MAX_S};
use elevon::models::parameters::ParameterSet;
use elevon::models::signal::Signal;

/// Candidates in a batch, as in the C program.
const BATCH: usize = 40;
const ROUNDS: usize = 15;
const RUNS_A_ROUND: usize = 20;
/// How far the features may be apart, relative to the larger of each kind.
const APART_MAX: f64 = 1e-12;

fn main() {
    let evaluator = fine::evaluator();
    let proposals = proposals();
    let Some(program) = compile() else {
        println!("batch of {BATCH}: {:.4} ms a candidate", ours_ms(&evaluator, &proposals) / BATCH as f64);
        println!("no C compiler (cc) here: nothing to compare with");
        return;
    };
    let mut theirs = InC::start(&program, &proposals);
    let apart = apart(&evaluator, &proposals, &mut theirs);
    println!("features in C and here differ by {apart:.1e} at most");
    assert!(apart < APART_MAX, "the two must do the same sums");
    let pair = |_| (ours_ms(&evaluator, &proposals), theirs.least_ms(RUNS_A_ROUND));
    let pairs: Vec<(f64, f64)> = (0..ROUNDS).map(pair).collect();
    let least = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).fold(f64::INFINITY, f64::min) / BATCH as f64;
    let (ours, in_c) = (least(|pair| pair.0), least(|pair| pair.1));
    let mut ratios: Vec<f64> = pairs.iter().map(|(ours, theirs)| ours / theirs).collect();
    ratios.sort_by(f64::total_cmp);
    println!("batch of {BATCH}, the program: {ours:.4} ms a candidate (goal 0.065)");
    println!("the same in C, -O3 for this processor: {in_c:.4} ms a candidate");
    let (low, median, high) = (ratios[0], ratios[ROUNDS / 2], ratios[ROUNDS - 1]);
    println!("ours over C, pair by pair: median {median:.2}, {low:.2} to {high:.2} (goal 1.2)");
}

/// A batch over the whole range of both faults.
fn proposals() -> Vec<Proposal> {
    let part = |i: usize, by: usize| (i * by % BATCH) as f64 / (BATCH - 1) as f64;
    (0..BATCH).map(|i| Proposal { kgm: 0.95 * part(i, 1), fdj_n: 200.0 + 1800.0 * part(i, 17) }).collect()
}

/// The least time of a batch, ms.
fn ours_ms(evaluator: &Evaluator, proposals: &[Proposal]) -> f64 {
    let once = |_| {
        let started = Instant::now();
        drop(black_box(evaluator.features(black_box(proposals))));
        started.elapsed().as_secs_f64() * 1e3
    };
    (0..RUNS_A_ROUND).map(once).fold(f64::INFINITY, f64::min)
}

/// The largest difference of any feature, relative to the largest of its kind.
fn apart(evaluator: &Evaluator, proposals: &[Proposal], theirs: &mut InC) -> f64 {
    theirs.least_ms(1);
    let columns: [Vec<f64>; 4] = [(); 4].map(|()| (0..BATCH).map(|_| theirs.number()).collect());
    let ours = evaluator.features(proposals);
    let ours = ours.iter().map(|f| [f.servovalve_current_a, f.ramp_pressure_pa, f.step_current_a, f.load_pressure_pa]);
    let mut apart = 0.0_f64;
    for (i, features) in ours.enumerate() {
        for (found, column) in features.into_iter().zip(&columns) {
            let scale = column.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            apart = apart.max((found - column[i]).abs() / scale);
        }
    }
    apart
}

/// The C program, if there is a compiler.
fn compile() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/monitoring.c");
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("monitoring-in-c");
    let vectors = if cfg!(target_arch = "x86_64") { "-mprefer-vector-width=512" } else { "-O3" };
    let status = Command::new("cc")
        .args(["-std=gnu11", "-O3", "-march=native", vectors, "-funroll-loops"])
        .args(["-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math", "-o"])
        .args([program.as_path(), source.as_path()])
        .arg("-lm")
        .status()
        .ok()?;
    status.success().then_some(program)
}

/// The C program at work.
struct InC {
    child: Child,
    asked: ChildStdin,
    told: BufReader<ChildStdout>,
}

impl InC {
    fn start(program: &Path, proposals: &[Proposal]) -> Self {
        let mut child = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut asked = child.stdin.take().unwrap();
        let told = BufReader::new(child.stdout.take().unwrap());
        let mut input = String::new();
        let candidates = proposals.iter().flat_map(|at| [at.kgm, at.fdj_n]);
        let transitions = [TIME_STEP_MAX_S, 0.5 * TIME_STEP_MAX_S].map(transition).concat();
        for value in parameters().into_iter().chain(candidates).chain(transitions).chain(command_m()) {
            let _ = writeln!(input, "{value:e}");
        }
        asked.write_all(input.as_bytes()).unwrap();
        Self { child, asked, told }
    }

    /// The least time of a batch, ms.
    fn least_ms(&mut self, repeats: usize) -> f64 {
        writeln!(self.asked, "{repeats}").unwrap();
        self.number()
    }

    fn number(&mut self) -> f64 {
        let mut line = String::new();
        self.told.read_line(&mut line).unwrap();
        line.trim().parse().unwrap()
    }
}

impl Drop for InC {
    fn drop(&mut self) {
        // It waits for another number: of no use without this program.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Flapper position, flapper velocity and spool position after a step, by each of them and the force, row by row.
fn transition(time_step_s: f64) -> Vec<f64> {
    let set = ParameterSet::reference();
    let model = Model::new(&set.shared(), set.monitoring_model());
    LargeStep::new(&model, time_step_s).transition().concat()
}

/// The diagnostic command at every half step, between the samples of the trace as the estimation takes it, m.
fn command_m() -> Vec<f64> {
    let trace = fine::trace();
    let command = Signal::command(trace.time_s(), trace.position_command_m());
    let half_steps = 2 * (5.11 / TIME_STEP_MAX_S).round() as usize;
    (0..=half_steps).map(|k| command.at(k as f64 * (0.5 * TIME_STEP_MAX_S))).collect()
}

/// The nominal values in the order of the C program's `struct params`.
fn parameters() -> Vec<f64> {
    let set = ParameterSet::reference();
    let (shared, own) = (set.shared(), set.monitoring_model().clone());
    let (motor, jack, flapper, spool, fluid) =
        (shared.torque_motor, shared.jack, own.first_stage, own.second_stage, own.fluid);
    assert!(jack.aerodynamic_stiffness_n_per_m == 0.0 && jack.external_load_n == 0.0, "the C program has no load");
    #[rustfmt::skip]
    let values = vec![
        TIME_STEP_MAX_S, shared.controller.proportional_gain_a_per_m, motor.current_max_a, motor.force_gain_n_per_a,
        flapper.flapper_position_max_m, spool.spool_speed_gain_per_s, spool.spool_position_max_m,
        fluid.supply_pressure_differential_pa, fluid.spool_saturation_m, fluid.flow_gain_m2_per_s,
        fluid.leakage_m3_per_s_per_pa, fluid.flow_reference_m3_per_s, fluid.lag_scale_s, fluid.lag_bell_a,
        fluid.lag_bell_b, fluid.lag_bell_c, fluid.lag_flow_slope_s_per_m3,
        own.friction.velocity_dead_band_m_per_s, jack.area_m2, jack.mass_kg, jack.damping_n_s_per_m,
        jack.friction_static_ratio, jack.position_max_m,
    ];
    values
}
