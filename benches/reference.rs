//! What a step of the reference model costs on one core, beside the same loop in plain C.
//!
//! `cargo bench --bench reference`. The C program (`reference.c`) is compiled here, without fused multiply-add as the
//! program itself; where there is no C compiler the comparison is left out and said to be. Both run in turn, several times:
//! the least of the timings is what the machine does when nothing else disturbs it.
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on should panic")]

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use elevon::models::blocks::Input;
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::reference::Model;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::watch::Unwatched;

const ROUNDS: usize = 5;
const RUNS_A_ROUND: u32 = 5;

fn main() {
    let set = ParameterSet::reference();
    let recipe = Simulation::new(ModelKind::Reference, Drive::Diagnostic, Faults::default(), 6.0, 1000.0);
    let steps = 600_001;
    let compiled = compile();
    let (mut ours, mut plain, mut theirs) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        plain = plain.min(plain_ns(&set, steps));
        let mut trace = None;
        for _ in 0..RUNS_A_ROUND {
            let started = Instant::now();
            trace = Some(simulate(&recipe, &set, &Unwatched).unwrap());
            ours = ours.min(started.elapsed().as_secs_f64() * 1e9 / f64::from(steps));
        }
        if let Some(program) = &compiled {
            let (ns, last) = run(program, &set, steps);
            theirs = theirs.min(ns);
            assert_eq!(last, last_sample(&trace.unwrap()), "the two loops must do the same sums");
        }
    }
    println!("reference model, 6 s at 1e-5 s, trace included: {ours:.1} ns a step");
    println!("its steps in plain numbers, without the vector instructions: {plain:.1} ns a step");
    match compiled {
        Some(_) => {
            println!("the same loop in C, -O2, without a trace: {theirs:.1} ns a step, last states equal bit by bit");
            println!("ours over C: {:.2}", ours / theirs);
        }
        None => println!("no C compiler (cc) here: nothing to compare with"),
    }
}

/// Nanoseconds a step of the model in plain numbers, as it runs where there is no register of four.
fn plain_ns(set: &ParameterSet, steps: u32) -> f64 {
    let model = Model::new(&set.shared(), set.reference_model(), &Faults::default());
    let mut s = model.start();
    let started = Instant::now();
    for step in 0..steps {
        s = model.step(&s, &Input::command(Drive::Diagnostic.position_m(f64::from(step) / 1e5, 6.0)));
    }
    std::hint::black_box(s);
    started.elapsed().as_secs_f64() * 1e9 / f64::from(steps)
}

/// Current, load pressure and jack position of the last sample.
fn last_sample(trace: &Trace) -> [f64; 3] {
    [Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition]
        .map(|channel| *trace.channel(channel).unwrap().last().unwrap())
}

/// The C program, if there is a compiler.
fn compile() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/reference.c");
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reference-in-c");
    let status = Command::new("cc")
        .args(["-O2", "-ffp-contract=off", "-o"])
        .args([program.as_path(), source.as_path()])
        .arg("-lm")
        .status()
        .ok()?;
    status.success().then_some(program)
}

/// Nanoseconds a step of the C program, and its last current, load pressure and jack position.
fn run(program: &Path, set: &ParameterSet, steps: u32) -> (f64, [f64; 3]) {
    let mut child = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = String::new();
    for value in parameters(set) {
        let _ = writeln!(input, "{value:e}");
    }
    let _ = writeln!(input, "{steps} {RUNS_A_ROUND}");
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let numbers: Vec<f64> = text.split_whitespace().map(|number| number.parse().unwrap()).collect();
    (numbers[0], [numbers[1], numbers[2], numbers[3]])
}

/// The nominal values in the order of the C program's `struct params`.
fn parameters(set: &ParameterSet) -> Vec<f64> {
    let (shared, own) = (set.shared(), set.reference_model());
    let (motor, jack, fdj_n) = (shared.torque_motor, shared.jack, Faults::default().fdj_n);
    let (flapper, spool, fluid) = (own.first_stage, own.second_stage, own.fluid);
    let supply_ratio = (fluid.supply_pressure_pa - fluid.return_pressure_pa) / spool.nominal_pressure_differential_pa;
    #[rustfmt::skip]
    let values = vec![
        own.time_step_s, shared.controller.proportional_gain_a_per_m, motor.current_max_a, motor.force_gain_n_per_a,
        flapper.mass_kg, flapper.damping_ratio, flapper.armature_stiffness_n_per_m,
        flapper.feedback_spring_stiffness_n_per_m, flapper.flapper_position_max_m,
        spool.end_area_m2, spool.pressure_gain_pa_per_m, spool.flow_gain_m2_per_s, spool.damping_n_s_per_m,
        spool.flow_force_n_s_per_m3, spool.friction_static_n, spool.friction_dynamic_n, spool.spool_position_max_m,
        supply_ratio,
        fluid.supply_pressure_pa, fluid.return_pressure_pa, fluid.density_kg_per_m3, fluid.kinematic_viscosity_m2_per_s,
        fluid.port_width_m, fluid.radial_clearance_m, fluid.overlap_supply_m, fluid.overlap_return_m,
        fluid.discharge_coefficient, fluid.transition_reynolds, fluid.discharge_geometry_correction,
        fluid.bulk_modulus_pa, fluid.chamber_volume_m3, fluid.leakage_m3_per_s_per_pa, fluid.vapour_pressure_pa,
        jack.area_m2, jack.mass_kg, jack.damping_n_s_per_m, fdj_n * jack.friction_static_ratio, fdj_n, jack.position_max_m,
    ];
    values
}
