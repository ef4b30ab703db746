//! The ramp's current from two sensors: what was recorded of it, and what command and jack position ask for.

use std::collections::BTreeMap;

use elevon::estimation::features::{Measured, measure};
use elevon::estimation::manoeuvre::find;
use elevon::models::blocks::Shared;
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::watch::Unwatched;

const KEPT: [Channel; 4] =
    [Channel::PositionCommand, Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition];

fn trace(noise_power_ma2_s: f64) -> Trace {
    let faults = Faults { kgm: 0.2, fdj_n: 450.0, ..Faults::default() };
    let quiet = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, 6.0, 1000.0);
    simulate(&Simulation { noise_power_ma2_s, seed: 11, ..quiet }, &ParameterSet::reference(), &Unwatched).unwrap()
}

/// The channels of a trace, with one of them sent through a function, or left out.
fn with(trace: &Trace, channel: Channel, change: impl Fn(f64) -> Option<f64>) -> Trace {
    let column = |of: Channel| {
        let values = trace.channel(of).unwrap().iter();
        let values: Option<Vec<f64>> =
            values.map(|&value| if of == channel { change(value) } else { Some(value) }).collect();
        Some((of, values?))
    };
    let channels: BTreeMap<Channel, Vec<f64>> = KEPT.into_iter().filter_map(column).collect();
    Trace::try_new(trace.time_s().to_vec(), channels, Vec::new()).unwrap()
}

fn measured(trace: &Trace, shared: &Shared) -> Measured {
    measure(trace, &find(trace.time_s(), trace.position_command_m()), shared).unwrap()
}

/// The ramp's current and its standard error, mA.
fn current_ma(trace: &Trace, shared: &Shared) -> (f64, f64) {
    let Measured { features, standard_errors, .. } = measured(trace, shared);
    (1e3 * features.servovalve_current_a, 1e3 * standard_errors.servovalve_current_a)
}

fn without_position(trace: &Trace) -> Trace {
    with(trace, Channel::JackPosition, |_| None)
}

#[test]
fn a_recorded_position_tells_a_noisy_current_ten_times_as_well() {
    let (noisy, shared) = (trace(5e-6), ParameterSet::reference().shared());
    let quiet_ma = current_ma(&trace(0.0), &shared).0;
    let (both, alone) = (current_ma(&noisy, &shared), current_ma(&without_position(&noisy), &shared));
    assert!(both.1 < 0.1 * alone.1, "{both:?}, without a position {alone:?}");
    assert!((both.0 - quiet_ma).abs() < 3.0 * both.1 + 0.003, "{both:?}, quiet {quiet_ma}");
    assert!((alone.0 - quiet_ma).abs() < 3.0 * alone.1, "{alone:?}, quiet {quiet_ma}");
}

#[test]
fn validate_the_standard_error_of_what_is_asked_for_is_that_of_the_loop_s_answer_to_the_noise() {
    // k = GAP v/Cor, and the mean of the answer over T strays by sqrt(k S/2 2(x - 1 + e^-x)/x²), x = k T.
    let shared = ParameterSet::reference().shared();
    let (value_ma, found_ma) = current_ma(&trace(5e-6), &shared);
    let rate_per_s = shared.controller.proportional_gain_a_per_m * 0.1 / (1e-3 * value_ma);
    let x = 0.1 * rate_per_s;
    let expected_ma = (rate_per_s * 5e-6 / 2.0 * 2.0 * (x - 1.0 + (-x).exp()) / (x * x)).sqrt();
    assert!((0.6..1.5).contains(&(found_ma / expected_ma)), "{found_ma} mA, expected {expected_ma} mA");
}

#[test]
fn a_controller_that_is_not_proportional_leaves_the_recorded_current_alone() {
    let noisy = trace(5e-6);
    let mut shared = ParameterSet::reference().shared();
    shared.controller.integral_gain_a_per_m_s = 0.1;
    assert_eq!(measured(&noisy, &shared), measured(&without_position(&noisy), &shared));
}

#[test]
fn a_constant_offset_of_the_current_sensor_is_not_passed_over() {
    let (noisy, shared) = (trace(5e-6), ParameterSet::reference().shared());
    let offset = with(&noisy, Channel::ServovalveCurrent, |a| Some(a + 0.3e-3));
    let (plain, moved) = (current_ma(&noisy, &shared), current_ma(&offset, &shared));
    assert!((moved.0 - plain.0 - 0.3).abs() < 4.0 * moved.1, "{plain:?} {moved:?}");
    assert!(moved.1 > plain.1, "the offset is known no better than the sensors tell: {plain:?} {moved:?}");
}

#[test]
fn a_position_of_another_scale_leaves_the_recorded_current_alone() {
    let (noisy, shared) = (trace(5e-6), ParameterSet::reference().shared());
    let stretched = with(&noisy, Channel::JackPosition, |m| Some(1.01 * m));
    assert_eq!(current_ma(&stretched, &shared), current_ma(&without_position(&noisy), &shared));
}
