//! The ramp's current as command and jack position tell it.
//!
//! The controller asks for Cor = GAP (Com - XJ), and noise on the current comes after it. So the recorded position is a measure of
//! the current's mean that a noisy or thinly sampled current sensor does not spoil, as long as the two sensors agree.
//!
//! How well it is known: the loop answers interference as a lag of the rate k = GAP v/Cor (at a velocity v of the ramp), so that
//! what is asked for strays from its mean with the variance k S/2, where S is the interference's power, and stays where it strayed
//! for 1/k, longer than the window. Neither is seen inside the window. S is taken from second differences of means over 20 ms, whose
//! mean square is k² S times 20 ms; the mean over a window of length T then has the variance (k S/2) 2 (x - 1 + e^-x)/x², x = k T.
//! A position sensor's own noise counts as more of S, which is on the safe side.

use super::features::Mean;
use super::manoeuvre::Window;
use crate::models::blocks::Shared;
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, resolution, standard_error, window};

/// A difference of this many standard errors is one between the sensors.
const SIGNIFICANT: f64 = 4.0;
/// The part of the motor's limit up to which what is asked for counts as flowing.
const UNSATURATED: f64 = 0.8;
/// Parts into which the difference of the two currents is cut, to judge how well its mean is known.
const BATCHES: usize = 20;
/// The length of the means whose second differences show the interference, s: some periods of the stick-slip, a part of 1/k.
const BLOCK_S: f64 = 0.02;
/// The length of the ramp up to the window's end in which they are taken, s, and the fewest of them.
const STRETCH_S: f64 = 0.8;
const BLOCKS_MIN: usize = 8;

/// The mean current of a window on a ramp, A: the recorded one, and where the position tells it better, that one's share.
pub fn steady_current(trace: &Trace, at: &Window, recorded: Mean, shared: &Shared) -> Mean {
    told_by_position(trace, at, shared).map_or(recorded, |asked| recorded.with(asked))
}

/// The mean current that is asked for in a window, A, with the current sensor's constant offset; `None` without a position,
/// with a controller that is not proportional, or where the two sensors differ by more than an offset.
fn told_by_position(trace: &Trace, at: &Window, shared: &Shared) -> Option<Mean> {
    let controller = &shared.controller;
    if controller.integral_gain_a_per_m_s != 0.0 || controller.derivative_gain_a_s_per_m != 0.0 {
        return None;
    }
    let (gain, position_m) = (controller.proportional_gain_a_per_m, trace.channel(Channel::JackPosition)?);
    let ask = |(command_m, jack_m): (&f64, &f64)| gain * (command_m - jack_m);
    let asked_a: Vec<f64> = trace.position_command_m().iter().zip(position_m).map(ask).collect();
    let recorded_a = trace.channel(Channel::ServovalveCurrent)?;
    let offset = offset(&asked_a, recorded_a, UNSATURATED * shared.torque_motor.current_max_a)?;
    let value = mean_between(trace.time_s(), &asked_a, at.from_s, at.to_s)?;
    let error = stray(trace, at, &asked_a, gain, value)?.hypot(gain * resolution(position_m) / 12f64.sqrt());
    Some(Mean { value: value + offset.value, error: error.hypot(offset.error), window: *at })
}

/// The constant by which a recorded current is more than what was asked for, A: none where it is not significant. `None` where
/// the difference follows the current: then one of the gains is another than the set's.
fn offset(asked_a: &[f64], recorded_a: &[f64], most_a: f64) -> Option<Offset> {
    let both = || asked_a.iter().zip(recorded_a).filter(|(asked, _)| asked.abs() < most_a);
    let more_a: Vec<f64> = both().map(|(asked, recorded)| recorded - asked).collect();
    let count = more_a.len() as f64;
    let error = standard_error(&more_a, BATCHES)?;
    let value = more_a.iter().sum::<f64>() / count;
    let mean_a = both().map(|(asked, _)| asked).sum::<f64>() / count;
    let square: f64 = both().map(|(asked, _)| (asked - mean_a).powi(2)).sum();
    let product: f64 = both().zip(&more_a).map(|((asked, _), more)| (asked - mean_a) * (more - value)).sum();
    let scatter_a = (more_a.iter().map(|more| (more - value).powi(2)).sum::<f64>() / count).sqrt();
    if product.abs() > SIGNIFICANT * scatter_a * square.sqrt() {
        return None;
    }
    let significant = value.abs() > SIGNIFICANT * error;
    Some(if significant { Offset { value, error } } else { Offset { value: 0.0, error: 0.0 } })
}

struct Offset {
    value: f64,
    error: f64,
}

/// The standard error of the mean of what is asked for in a window, A.
fn stray(trace: &Trace, at: &Window, asked_a: &[f64], gain_a_per_m: f64, mean_a: f64) -> Option<f64> {
    let time_s = trace.time_s();
    let inside = window(time_s, at.from_s, at.to_s);
    let (first, last) = (inside.start, inside.end.checked_sub(1)?);
    let length_s = time_s[last] - time_s[first];
    let moved_m = trace.position_command_m()[last] - trace.position_command_m()[first];
    let rate_per_s = gain_a_per_m * (moved_m / length_s / mean_a).abs();
    let step_s = length_s / (last - first) as f64;
    let size = (BLOCK_S / step_s).round().max(1.0) as usize;
    let stretch = &asked_a[window(time_s, at.to_s - STRETCH_S, at.to_s)];
    let means: Vec<f64> = stretch.rchunks_exact(size).map(|block| block.iter().sum::<f64>() / size as f64).collect();
    if means.len() < BLOCKS_MIN {
        return None;
    }
    let differences = means.windows(3).map(|three| three[2] - 2.0 * three[1] + three[0]);
    let mean_square = differences.map(|d| d * d).sum::<f64>() / (means.len() - 2) as f64;
    let power = mean_square / (rate_per_s.powi(2) * size as f64 * step_s);
    let x = rate_per_s * length_s;
    let share = 2.0 * (x - 1.0 + (-x).exp()) / (x * x);
    let variance = 0.5 * rate_per_s * power * share;
    variance.is_finite().then(|| variance.sqrt())
}
