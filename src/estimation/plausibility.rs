//! What speaks against believing a trace: before the search, against the laws that hold at any fault; after it, against the
//! model at its best.

use super::features::{Features, Measured};
use super::manoeuvre::{Manoeuvres, Window};
use super::request::Requested;
use crate::models::parameters::ParameterSet;
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, range, window};

/// A current this close to the motor's limit, as a part of it, is saturated.
const SATURATED: f64 = 0.999;
/// The part of the command's motion that a jack must make to count as following it.
const MOTION_MIN: f64 = 0.5;
/// How far the current may be from what the controller asks for, as a part of it, beside four standard errors.
const CONTROL_MAX: f64 = 0.03;
/// How long the current is looked at after a step, s, how far the jack may be from its command when the step comes, m, and
/// how much of the current may be short.
const JUST_AFTER_S: f64 = 0.02;
const MOVED_MAX_M: f64 = 0.025;
const STEP_SHORT_MAX: f64 = 0.1;
/// How much a channel must move over the whole trace, as a part of its feature.
const RANGE_MIN: f64 = 0.5;
/// How far a recorded supply pressure may be from the model's, as a part of it.
const SUPPLY_MAX: f64 = 0.01;
/// The largest recorded load that counts as none, N.
const LOAD_MAX_N: f64 = 5.0;
/// How far the spool may stand from where the current puts it, as a part of that.
const SPOOL_OFF_MAX: f64 = 0.015;
/// The part of a feature that may remain unexplained.
const MISFIT_MAX: f64 = 0.05;
/// The part of the ramp's pressure that may remain unexplained, and of the ramp's current after the step.
const CHECK_MAX: f64 = 0.15;

/// Whether a trace has all that the two features take, and no more is asked of it.
pub fn features_suffice(trace: &Trace, found: &Manoeuvres, set: &ParameterSet, faults: Requested) -> bool {
    faults == Requested::KGM_AND_FDJ
        && found.current.is_some()
        && found.pressure.is_some()
        && [Channel::ServovalveCurrent, Channel::LoadPressure]
            .into_iter()
            .all(|channel| trace.channel(channel).is_some())
        && loaded(trace).is_none()
        && other_supply(trace, set.reference_model().fluid.supply_pressure_pa).is_none()
}

/// Whether the spool, where it was recorded, stands elsewhere on the ramp than the current puts it: in a steady state the torque
/// motor's force holds the feedback spring, and the flapper the flow force (docs/estimation.md).
pub fn spool_contradicts(trace: &Trace, found: &Manoeuvres, set: &ParameterSet, kgm: f64) -> bool {
    let contradicts = || {
        let spool_m = trace.channel(Channel::SpoolPosition)?;
        let at = found.current?;
        let Window { from_s, to_s } = at;
        let mean = |values: &[f64]| mean_between(trace.time_s(), values, from_s, to_s);
        let current_a = mean(trace.channel(Channel::ServovalveCurrent)?)?;
        let moved_m = inside(trace, trace.position_command_m(), &at);
        let velocity = (moved_m.last()? - moved_m.first()?) / (to_s - from_s);
        let (shared, own) = (set.shared(), set.reference_model());
        let (first, second) = (&own.first_stage, &own.second_stage);
        let force_n = shared.torque_motor.force_gain_n_per_a * (1.0 - kgm) * current_a;
        let flow_force_n = second.flow_force_n_s_per_m3 * shared.jack.area_m2 * velocity;
        let stiffness = first.armature_stiffness_n_per_m + first.feedback_spring_stiffness_n_per_m;
        let held_n = stiffness * flow_force_n / (second.end_area_m2 * second.pressure_gain_pa_per_m);
        let expected_m = (force_n - held_n) / first.feedback_spring_stiffness_n_per_m;
        Some((mean(spool_m)? - expected_m).abs() > SPOOL_OFF_MAX * expected_m.abs())
    };
    contradicts().unwrap_or(false)
}

/// Why no search should be made.
pub fn objections(trace: &Trace, measured: &Measured, set: &ParameterSet) -> Vec<String> {
    let shared = set.shared();
    let checks = [
        saturated(trace, &measured.current_window, shared.torque_motor.current_max_a),
        stands_still(trace, &measured.current_window),
        uncontrolled(trace, measured, shared.controller.proportional_gain_a_per_m),
        flat_step(trace, measured, set),
        stuck(trace, Channel::ServovalveCurrent, measured.features.servovalve_current_a),
        stuck(trace, Channel::LoadPressure, measured.features.load_pressure_pa),
        loaded(trace),
        other_supply(trace, set.reference_model().fluid.supply_pressure_pa),
    ];
    checks.into_iter().flatten().collect()
}

fn inside<'a>(trace: &Trace, values: &'a [f64], at: &Window) -> &'a [f64] {
    &values[window(trace.time_s(), at.from_s, at.to_s)]
}

fn saturated(trace: &Trace, ramp: &Window, current_max_a: f64) -> Option<String> {
    let current_a = inside(trace, trace.channel(Channel::ServovalveCurrent)?, ramp);
    let peak_a = current_a.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
    (peak_a >= SATURATED * current_max_a).then(|| {
        let [peak_ma, max_ma] = [peak_a, current_max_a].map(|a| a * 1e3);
        format!("the current is saturated on the ramp: {peak_ma:.2} mA of {max_ma:.2} mA")
    })
}

fn stands_still(trace: &Trace, ramp: &Window) -> Option<String> {
    let moved_mm = |values: &[f64]| {
        let values = inside(trace, values, ramp);
        1e3 * (values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0))
    };
    let (jack_mm, command_mm) = (moved_mm(trace.channel(Channel::JackPosition)?), moved_mm(trace.position_command_m()));
    (jack_mm < MOTION_MIN * command_mm.abs() && -jack_mm < MOTION_MIN * command_mm.abs()).then(|| {
        format!(
            "the jack does not follow the ramp: it moved {jack_mm:.3} mm while the command moved {command_mm:.3} mm"
        )
    })
}

/// The current that the controller asks for follows from command and position alone, whatever the faults.
fn uncontrolled(trace: &Trace, measured: &Measured, gain_a_per_m: f64) -> Option<String> {
    let Window { from_s, to_s } = measured.current_window;
    let mean = |values: &[f64]| mean_between(trace.time_s(), values, from_s, to_s);
    let error_m = mean(trace.position_command_m())? - mean(trace.channel(Channel::JackPosition)?)?;
    let (asked_ma, found_ma) = (1e3 * gain_a_per_m * error_m, 1e3 * measured.features.servovalve_current_a);
    let noise_ma = 4e3 * measured.standard_errors.servovalve_current_a;
    ((found_ma - asked_ma).abs() > CONTROL_MAX * asked_ma.abs() + noise_ma).then(|| {
        format!("the current on the ramp is {found_ma:.2} mA where command and jack position ask for {asked_ma:.2} mA")
    })
}

/// Right after a step the current is the controller's answer to the whole of it, or the motor's limit.
fn flat_step(trace: &Trace, measured: &Measured, set: &ParameterSet) -> Option<String> {
    let (shared, jump) = (set.shared(), measured.jump?);
    let at = Window { from_s: jump.at_s, to_s: jump.at_s + JUST_AFTER_S };
    let current_a = inside(trace, trace.channel(Channel::ServovalveCurrent)?, &at);
    let peak_a = current_a.iter().map(|a| a * jump.height_m.signum()).fold(0.0, f64::max);
    let asked_a = shared.controller.proportional_gain_a_per_m * (jump.height_m.abs() - MOVED_MAX_M);
    let expected_a = asked_a.min(shared.torque_motor.current_max_a);
    (peak_a < (1.0 - STEP_SHORT_MAX) * expected_a).then(|| {
        let [peak_ma, expected_ma] = [peak_a, expected_a].map(|a| a * 1e3);
        format!("the current reaches {peak_ma:.2} mA after the step where {expected_ma:.2} mA are expected")
    })
}

fn stuck(trace: &Trace, channel: Channel, feature: f64) -> Option<String> {
    let moved = range(trace.channel(channel)?);
    (moved < RANGE_MIN * feature.abs()).then(|| {
        format!("{} moves by {moved:.3e} in the whole trace: a sensor that is stuck or clipped", channel.column())
    })
}

fn loaded(trace: &Trace) -> Option<String> {
    let load_n = trace.channel(Channel::ExternalLoad)?.iter().fold(0.0_f64, |most, n| most.max(n.abs()));
    (load_n > LOAD_MAX_N)
        .then(|| format!("an external load of up to {load_n:.0} N was recorded, which the model does not have"))
}

fn other_supply(trace: &Trace, nominal_pa: f64) -> Option<String> {
    let supply_pa = trace.channel(Channel::SupplyPressure)?;
    let off = |pa: &&f64| (*pa - nominal_pa).abs() > SUPPLY_MAX * nominal_pa;
    let found_mpa = supply_pa.iter().find(off)? * 1e-6;
    Some(format!("a supply pressure of {found_mpa:.2} MPa was recorded, the model has {:.2} MPa", nominal_pa * 1e-6))
}

/// Why the model at its best, corrected by the known bias, does not explain a trace.
pub fn misfits(measured: &Features, modelled: &Features) -> Vec<String> {
    let Features { servovalve_current_a: current_a, step_current_a, .. } = *modelled;
    let scale = |one: f64, other: f64| one.abs().max(other.abs());
    let rows = [
        ("the ramp's current, A", measured.servovalve_current_a, current_a, MISFIT_MAX, current_a),
        ("the pressure after the step, Pa", measured.load_pressure_pa, modelled.load_pressure_pa, MISFIT_MAX, 0.0),
        ("the ramp's pressure, Pa", measured.ramp_pressure_pa, modelled.ramp_pressure_pa, CHECK_MAX, 0.0),
        ("the current after the step, A", measured.step_current_a, step_current_a, CHECK_MAX, current_a),
    ];
    let unexplained = |&&(_, found, model, part, least): &&(&str, f64, f64, f64, f64)| {
        (found - model).abs() > part * scale(scale(found, model), least) || !model.is_finite()
    };
    let rows = rows.iter().filter(unexplained);
    rows.map(|(what, found, model, ..)| {
        format!("no faults explain {what}: found {found:.4e}, the model that fits the rest has {model:.4e}")
    })
    .collect()
}
