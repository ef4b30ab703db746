//! Every fault that a run may have moves the signals as the thesis says.

use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::statistics::mean_between;
use elevon::numeric::watch::Unwatched;

/// A run of the reference model at one sample a millisecond.
pub fn run(set: &ParameterSet, faults: Faults, command: &str, duration_s: f64) -> Trace {
    let command = command.parse().unwrap();
    let recipe = Simulation::new(ModelKind::Reference, command, faults, duration_s, 1000.0);
    simulate(&recipe, set, &Unwatched).unwrap()
}

/// A run of the built-in actuator.
fn faulty(faults: Faults, command: &str, duration_s: f64) -> Trace {
    run(&ParameterSet::reference(), faults, command, duration_s)
}

/// The mean of a channel.
pub fn mean(trace: &Trace, channel: Channel, from_s: f64, to_s: f64) -> f64 {
    mean_between(trace.time_s(), trace.channel(channel).unwrap(), from_s, to_s).unwrap()
}

/// The largest magnitude of a channel from a sample on.
fn most(trace: &Trace, channel: Channel, from: usize) -> f64 {
    trace.channel(channel).unwrap()[from..].iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// The time at which the jack first passes a position, s.
pub fn passes(trace: &Trace, position_m: f64) -> f64 {
    let passed = trace.channel(Channel::JackPosition).unwrap().iter().position(|&x| x >= position_m);
    trace.time_s()[passed.expect("the jack gets there")]
}

/// How far the jack is behind the command on the ramp, m.
fn lag_m(trace: &Trace) -> f64 {
    mean(trace, Channel::PositionCommand, 1.8, 1.9) - mean(trace, Channel::JackPosition, 1.8, 1.9)
}

pub fn rises(values: &[f64]) -> bool {
    values.windows(2).all(|two| two[1] > two[0])
}

pub fn falls(values: &[f64]) -> bool {
    values.windows(2).all(|two| two[1] < two[0])
}

/// The levels of demagnetisation of section 6.1.
const KGM: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.4];

fn demagnetised(command: &str, duration_s: f64) -> Vec<Trace> {
    KGM.iter().map(|&kgm| faulty(Faults { kgm, ..Faults::default() }, command, duration_s)).collect()
}

#[test]
fn validate_section_6_1_1_a_demagnetised_motor_is_slower_and_takes_more_current_on_a_step() {
    let all = demagnetised("step:0.1", 1.0);
    let slow: Vec<f64> = all.iter().map(|trace| passes(trace, 0.09)).collect();
    assert!(rises(&slow), "time to nine tenths of the step: {slow:?}");
    // The spool itself gets to its stop at every level, later.
    for channel in [Channel::SpoolPosition, Channel::JackVelocity] {
        let early: Vec<f64> = all.iter().map(|trace| mean(trace, channel, 0.0, 0.05)).collect();
        assert!(falls(&early), "{channel:?}: {early:?}");
    }
    let charges: Vec<f64> = all.iter().map(|trace| mean(trace, Channel::ServovalveCurrent, 0.0, 1.0)).collect();
    assert!(rises(&charges), "mean current: {charges:?}");
}

#[test]
fn validate_section_6_1_2_a_demagnetised_motor_lags_and_takes_more_current_on_a_ramp() {
    let all = demagnetised("ramp:0.1", 2.0);
    let currents: Vec<f64> = all.iter().map(|trace| mean(trace, Channel::ServovalveCurrent, 1.8, 1.9)).collect();
    assert!(rises(&currents), "{currents:?}");
    let lags: Vec<f64> = all.iter().map(lag_m).collect();
    assert!(rises(&lags), "{lags:?}");
    let early: Vec<f64> = all.iter().map(|trace| mean(trace, Channel::JackVelocity, 0.0, 0.2)).collect();
    assert!(falls(&early), "slower at first: {early:?}");
}

#[test]
fn validate_section_6_1_3_a_demagnetised_motor_swings_less_on_a_sine() {
    let all = demagnetised("sine:0.2@5", 2.0);
    // The mean magnitude of the spool's position: its peaks are cut by the end stop at every level.
    let sizes = |channel| {
        let size = |trace: &Trace| trace.channel(channel).unwrap()[1000..].iter().map(|x| x.abs()).sum::<f64>() / 1e3;
        all.iter().map(size).collect::<Vec<f64>>()
    };
    for channel in [Channel::SpoolPosition, Channel::JackPosition] {
        assert!(falls(&sizes(channel)), "{channel:?}: {:?}", sizes(channel));
    }
    let currents: Vec<f64> = all.iter().map(|trace| most(trace, Channel::ServovalveCurrent, 1000)).collect();
    assert!(currents.iter().all(|current| (current / currents[0] - 1.0).abs() < 0.05), "almost the same: {currents:?}");
}

#[test]
fn validate_section_6_2_1_friction_shows_in_the_pressure_after_a_step_and_nowhere_else() {
    let levels_n = [200.0, 400.0, 600.0, 800.0, 1000.0];
    let all: Vec<Trace> =
        levels_n.iter().map(|&fdj_n| faulty(Faults { fdj_n, ..Faults::default() }, "step:0.1", 1.2)).collect();
    let pressures: Vec<f64> = all.iter().map(|trace| mean(trace, Channel::LoadPressure, 1.09, 1.11)).collect();
    for (pressure_pa, fdj_n) in pressures.iter().zip(levels_n) {
        assert!((pressure_pa * 8e-4 / fdj_n - 1.0).abs() < 0.02, "a force to overcome {fdj_n} N: {pressures:?}");
    }
    let positions: Vec<f64> = all.iter().map(|trace| mean(trace, Channel::JackPosition, 1.09, 1.11)).collect();
    assert!(positions.iter().all(|position| (position - positions[0]).abs() < 1e-3), "{positions:?}");
}

#[test]
fn validate_section_7_2_a_worn_sleeve_leaks_and_takes_more_current_on_a_ramp() {
    let current = |clearance_m: f64| {
        let trace = faulty(Faults { clearance_m, ..Faults::default() }, "ramp:0.1", 2.0);
        mean(&trace, Channel::ServovalveCurrent, 1.8, 1.9)
    };
    let ratios = [0.0, 15e-6, 30e-6].map(|clearance_m| current(clearance_m) / current(0.0));
    // docs/conventions.md's reading of the third test: radial, beyond the nominal clearance.
    assert!((ratios[1] - 1.017).abs() < 2e-3 && (ratios[2] - 1.043).abs() < 2e-3, "{ratios:?}");
}

#[test]
fn validate_section_4_1_2_a_clogged_filter_makes_the_valve_slower() {
    let all: Vec<Trace> = [0.0, 0.3, 0.6, 0.9]
        .iter()
        .map(|&clogging| faulty(Faults { clogging, ..Faults::default() }, "step:0.1", 1.5))
        .collect();
    let slow: Vec<f64> = all.iter().map(|trace| passes(trace, 0.02)).collect();
    assert!(rises(&slow), "{slow:?}");
    // The spool's early travel follows its speed, which falls by the root of what is open, as the flow gain does.
    let early: Vec<f64> = all.iter().map(|trace| trace.channel(Channel::SpoolPosition).unwrap()[5]).collect();
    assert!(falls(&early) && (early[2] / early[0] / 0.4_f64.sqrt() - 1.0).abs() < 0.1, "{early:?}");
}

#[test]
fn validate_section_4_1_2_play_in_the_feedback_spring_lets_the_spool_go_further_for_the_same_current() {
    let set = ParameterSet::reference();
    let (motor, flapper) = (set.shared().torque_motor, set.reference_model().first_stage);
    let current = |feedback_backlash_m: f64| {
        let trace = faulty(Faults { feedback_backlash_m, ..Faults::default() }, "ramp:0.1", 2.0);
        mean(&trace, Channel::ServovalveCurrent, 1.8, 1.9)
    };
    // The spring bends by half the play less, so that the same opening takes this much less current.
    let spared_a = flapper.feedback_spring_stiffness_n_per_m * 0.5 * 20e-6 / motor.force_gain_n_per_a;
    assert!(((current(0.0) - current(20e-6)) / spared_a - 1.0).abs() < 0.05, "{} {}", current(0.0), current(20e-6));
}

#[test]
fn validate_section_3_2_5_backlash_delays_the_surface_after_a_reversal() {
    let waits = [0.0, 0.5e-3, 2e-3].map(|jack_backlash_m| {
        let trace = faulty(Faults { jack_backlash_m, ..Faults::default() }, "sequence:0.02@0,0@1", 1.5);
        let surface = &trace.channel(Channel::JackPosition).unwrap()[1000..];
        surface.iter().position(|position| *position < surface[0] - 1e-6).unwrap()
    });
    assert!(waits[0] < waits[1] && waits[1] < waits[2], "{waits:?} ms");
}

#[test]
fn validate_section_3_2_6_an_offset_moves_the_jack_without_a_command() {
    let gain = ParameterSet::reference().shared().controller.proportional_gain_a_per_m;
    for current_offset_a in [1e-3, -1e-3, 4e-3] {
        let trace = faulty(Faults { current_offset_a, ..Faults::default() }, "step:0", 3.0);
        let position_m = mean(&trace, Channel::JackPosition, 2.9, 3.0);
        // Until the controller asks for the opposite of it, but for what the overlap and the friction hold.
        let left_a = (current_offset_a - position_m * gain) * current_offset_a.signum();
        assert!((0.0..2e-4).contains(&left_a), "{current_offset_a}: {position_m} m, {left_a} A left");
    }
}

#[test]
fn validate_section_4_1_1_hysteresis_lags_behind_on_the_way_up_and_down() {
    let gain = ParameterSet::reference().shared().controller.proportional_gain_a_per_m;
    let lag =
        |hysteresis_a: f64, command: &str| lag_m(&faulty(Faults { hysteresis_a, ..Faults::default() }, command, 2.0));
    for (command, direction) in [("ramp:0.1", 1.0), ("ramp:-0.1", -1.0)] {
        // The error has to ask for His more, whichever way it grows.
        let more_a = (lag(1e-3, command) - lag(0.0, command)) * direction * gain;
        assert!((more_a / 1e-3 - 1.0).abs() < 0.05, "{command}: {more_a}");
    }
}
