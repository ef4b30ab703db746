//! How the models' error falls with the time step: both are semi-implicit Euler steps, of first order.
//!
//! The error of a step h is estimated by the difference from the run at h/2: for a method of order p two such
//! differences in a row have the ratio 2^p, whatever the exact solution is.

use std::f64::consts::TAU;

use elevon::models::blocks::Input;
use elevon::models::monitoring::large_step::LargeStep;
use elevon::models::parameters::ParameterSet;
use elevon::models::{fault::Faults, monitoring, reference};

/// What is compared: jack position, load pressure, spool position, current.
const NAMES: [&str; 4] = ["XJ", "P12", "XS", "Cor"];

/// A command and the times at which the runs are compared, s.
struct Case {
    command_m: fn(f64) -> f64,
    times_s: [f64; 4],
    friction_n: f64,
}

/// 2 cm up and back in a second, from rest without a jump of the velocity; compared while the jack goes up. Without dry
/// friction, for a breakaway falls on a whole step.
const SMOOTH: Case =
    Case { command_m: |time_s| 0.01 * (1.0 - (TAU * time_s).cos()), times_s: [0.1, 0.2, 0.3, 0.45], friction_n: 0.0 };

/// The diagnostic ramp with the nominal friction, long after its breakaway.
const RAMP: Case = Case { command_m: |time_s| 0.1 * time_s, times_s: [1.2, 1.4, 1.6, 1.9], friction_n: 200.0 };

/// The states at the times of comparison.
fn at_times(case: &Case, time_step_s: f64, mut step: impl FnMut(f64) -> [f64; 4]) -> Vec<[f64; 4]> {
    let steps_per_s = (1.0 / time_step_s).round();
    let (mut now, mut done) = ([0.0; 4], 0.0);
    let mut states = Vec::new();
    for time_s in case.times_s {
        while done <= (time_s * steps_per_s).round() {
            now = step((case.command_m)(done / steps_per_s));
            done += 1.0;
        }
        states.push(now);
    }
    states
}

fn reference_states(case: &Case, time_step_s: f64) -> Vec<[f64; 4]> {
    let set = ParameterSet::reference();
    let mut own = *set.reference_model();
    own.time_step_s = time_step_s;
    if case.friction_n == 0.0 {
        (own.second_stage.friction_static_n, own.second_stage.friction_dynamic_n) = (0.0, 0.0);
    }
    let model = reference::Model::new(&set.shared(), &own, &Faults { fdj_n: case.friction_n, ..Faults::default() });
    let mut s = model.start();
    at_times(case, time_step_s, |command_m| {
        s = model.step(&s, &Input::command(command_m));
        [s.jack.position_m, s.pipe.load_pressure_pa(), s.second_stage.position_m, s.torque_motor.current_a]
    })
}

fn monitoring_states(case: &Case, time_step_s: f64, large: bool) -> Vec<[f64; 4]> {
    let set = ParameterSet::reference();
    let model = monitoring::Model::new(&set.shared(), set.monitoring_model());
    let candidate = model.candidate(0.0, case.friction_n);
    let coarse = LargeStep::new(&model, time_step_s);
    let mut s = monitoring::State::start((), 0.0);
    at_times(case, time_step_s, |command_m| {
        s = if large {
            coarse.step(&candidate, &s, command_m)
        } else {
            model.step(&candidate, &s, &Input::command(command_m), time_step_s)
        };
        [s.jack_position_m, s.load_pressure_pa, s.spool_position_m, s.servovalve_current_a]
    })
}

/// The observed orders of each quantity between halvings of the step, with the errors printed.
fn orders(title: &str, steps_s: &[f64], run: impl Fn(f64) -> Vec<[f64; 4]>) -> Vec<[f64; 4]> {
    let runs: Vec<_> = steps_s.iter().map(|&step_s| run(step_s)).collect();
    let difference = |two: &[Vec<[f64; 4]>]| {
        [0, 1, 2, 3].map(|i| two[0].iter().zip(&two[1]).map(|(a, b)| (a[i] - b[i]).abs()).fold(0.0, f64::max))
    };
    let errors: Vec<[f64; 4]> = runs.windows(2).map(difference).collect();
    for (step_s, error) in steps_s.iter().zip(&errors) {
        println!("{title}, {step_s:e} s: {NAMES:?} {error:?}");
    }
    let orders: Vec<_> = errors.windows(2).map(|two| [0, 1, 2, 3].map(|i| (two[0][i] / two[1][i]).log2())).collect();
    println!("{title}: orders {orders:.3?}");
    orders
}

/// Asserts that the first of the quantities, as many as are wanted, converge with these orders at every halving.
fn expect(orders: &[[f64; 4]], wanted: usize, least: f64, most: f64) {
    let all = orders.iter().flat_map(|order| &order[..wanted]);
    assert!(all.clone().all(|order| (least..=most).contains(order)), "{orders:?}");
}

const FINE_STEPS_S: [f64; 5] = [2e-5, 1e-5, 5e-6, 2.5e-6, 1.25e-6];
const LARGE_STEPS_S: [f64; 4] = [5e-4, 2.5e-4, 1.25e-4, 6.25e-5];

#[test]
fn order_the_reference_model_is_of_first_order() {
    expect(&orders("reference, smooth", &FINE_STEPS_S, |h| reference_states(&SMOOTH, h)), 4, 0.98, 1.02);
    expect(&orders("reference, ramp", &FINE_STEPS_S, |h| reference_states(&RAMP, h)), 4, 0.98, 1.02);
}

#[test]
fn order_the_monitoring_model_is_of_first_order() {
    expect(&orders("monitoring, smooth", &FINE_STEPS_S, |h| monitoring_states(&SMOOTH, h, false)), 4, 0.98, 1.02);
    // The step on which Karnopp's jack broke away still shows in its pressure, not in its position.
    expect(&orders("monitoring, ramp", &FINE_STEPS_S, |h| monitoring_states(&RAMP, h, false)), 1, 0.98, 1.02);
}

#[test]
fn order_the_large_step_is_of_first_order() {
    let smooth = orders("large step, smooth", &LARGE_STEPS_S, |h| monitoring_states(&SMOOTH, h, true));
    expect(&smooth, 3, 0.98, 1.02);
    // The current answers the position of the step before: its errors of first order cancel on a smooth command.
    expect(&smooth, 4, 0.98, 2.1);
    expect(&orders("large step, ramp", &LARGE_STEPS_S, |h| monitoring_states(&RAMP, h, true)), 1, 0.98, 1.02);
}
