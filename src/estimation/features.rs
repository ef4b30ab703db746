//! The two features of section 6.3: the steady current of the ramp and the pressure 1.1 s after the step. Beside them the
//! pressure of the ramp and the current after the step, by which a model can be told wrong.

use super::asked;
use super::manoeuvre::{Jump, Manoeuvres, Window};
use crate::models::blocks::Shared;
use crate::models::monitoring::bias::Difference;
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, resolution, standard_error, window};

/// Parts into which a window is cut to judge how well its mean is known, and the fewest samples that it may have.
const BATCHES: (usize, usize) = (10, 5);
/// How far around its window, in windows, a pressure is looked at to judge how well its mean is known, and how far the means that are
/// compared lie apart, in halves of a window: several distances, so that no period of the noise is favoured, and none so long that
/// the creep bends.
const AROUND: usize = 10;
const APART: [usize; 3] = [5, 6, 7];
/// The fewest comparisons.
const COMPARISONS_MIN: usize = 20;
/// The median of a normal deviate's magnitude.
const MEDIAN_MAGNITUDE: f64 = 0.6745;
/// How far a command may stray while it holds, m.
const HELD_M: f64 = 1e-3;

/// What a trace, or a candidate, shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// Steady current of the ramp, A: the feature of demagnetisation.
    pub servovalve_current_a: f64,
    /// Load pressure after the step, Pa: the feature of friction.
    pub load_pressure_pa: f64,
    /// Load pressure of the ramp, Pa, for the check only.
    pub ramp_pressure_pa: f64,
    /// Current after the step, A, for the check only.
    pub step_current_a: f64,
}

impl Features {
    /// What the reference model would show where the monitoring model shows this, by the known difference between them.
    #[must_use]
    pub fn corrected(&self, known: &Difference) -> Self {
        Self {
            servovalve_current_a: known.current_ratio * self.servovalve_current_a,
            // It was learnt on a step upwards; downwards it has the other sign.
            load_pressure_pa: self.load_pressure_pa
                + known.load_pressure_pa.copysign(known.load_pressure_pa * self.load_pressure_pa),
            ramp_pressure_pa: self.ramp_pressure_pa,
            step_current_a: known.current_ratio * self.step_current_a,
        }
    }
}

/// How well a mean is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandardErrors {
    /// Of the steady current, A.
    pub servovalve_current_a: f64,
    /// Of the load pressure after the step, Pa.
    pub load_pressure_pa: f64,
}

/// The features of a trace, with how well it knows them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The features.
    pub features: Features,
    /// Standard errors of the two that are searched for.
    pub standard_errors: StandardErrors,
    /// Where the current was taken: the end of the ramp.
    pub current_window: Window,
    /// Where the pressure was taken: after the step.
    pub pressure_window: Window,
    /// The step, where it rises within one sample.
    pub jump: Option<Jump>,
}

/// Measures the features of a trace. What both models have tells what the controller asked for.
///
/// # Errors
/// Every reason why the trace does not show them.
pub fn measure(trace: &Trace, manoeuvres: &Manoeuvres, shared: &Shared) -> Result<Measured, Vec<String>> {
    let ramp = "a ramp of 0.09 to 0.11 m/s for at least 1 s (KGM)";
    let step =
        "a step of at least 0.05 m, out of a hold or ramp of at least 1 s, that is held for at least 1.11 s (FDJ)";
    let at_ramp = at(manoeuvres.current, ramp);
    let at_step = at(manoeuvres.pressure, step);
    let current = mean(trace, Channel::ServovalveCurrent, &at_ramp);
    let pressure = mean(trace, Channel::LoadPressure, &at_step);
    let (Ok(current), Ok(pressure)) = (&current, &pressure) else {
        return Err([current.err(), pressure.err()].into_iter().flatten().collect());
    };
    let pressures = trace.channel(Channel::LoadPressure).unwrap_or_default();
    let steady = asked::steady_current(trace, &current.window, *current, shared);
    let other = |channel, window| mean(trace, channel, window).map_err(|reason| vec![reason]);
    let ramp_pressure = other(Channel::LoadPressure, &at_ramp)?;
    let step_current = other(Channel::ServovalveCurrent, &at_step)?;
    Ok(Measured {
        features: Features {
            servovalve_current_a: steady.value,
            load_pressure_pa: pressure.value,
            ramp_pressure_pa: ramp_pressure.value,
            step_current_a: step_current.value,
        },
        standard_errors: StandardErrors {
            servovalve_current_a: steady.error,
            load_pressure_pa: spread_around(trace, &pressure.window)
                .map_or(pressure.error, |spread| spread.hypot(coarseness(pressures))),
        },
        current_window: current.window,
        pressure_window: pressure.window,
        jump: manoeuvres.jump,
    })
}

/// The mean of a channel over a window, with its standard error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean {
    pub value: f64,
    pub error: f64,
    pub window: Window,
}

impl Mean {
    /// The mean of two measures of the same by their standard errors; the first one where neither has any.
    pub fn with(self, other: Self) -> Self {
        let (own, others) = (self.error.powi(2), other.error.powi(2));
        let both = own + others;
        if both == 0.0 || !both.is_finite() {
            return self;
        }
        let value = (self.value * others + other.value * own) / both;
        Self { value, error: (own * others / both).sqrt(), ..self }
    }
}

fn at(window: Option<Window>, needs: &str) -> Result<Window, String> {
    window.ok_or_else(|| format!("the command has no manoeuvre that is known to show the fault: {needs}"))
}

fn mean(trace: &Trace, channel: Channel, at: &Result<Window, String>) -> Result<Mean, String> {
    let column = channel.column();
    let values = trace.channel(channel).ok_or_else(|| format!("{column} was not recorded"))?;
    let at = at.as_ref().map_err(Clone::clone)?;
    let inside = &values[window(trace.time_s(), at.from_s, at.to_s)];
    let known = mean_between(trace.time_s(), values, at.from_s, at.to_s)
        .zip(standard_error(inside, BATCHES.0.min(inside.len())))
        .filter(|_| inside.len() >= BATCHES.1);
    let (value, scatter) = known.ok_or_else(|| {
        let (found, least) = (inside.len(), BATCHES.1);
        format!("{column} has {found} samples from {:.3} to {:.3} s, expected at least {least}", at.from_s, at.to_s)
    })?;
    Ok(Mean { value, error: scatter.hypot(coarseness(values)), window: *at })
}

/// A coarse sensor may be off by its quantum over the square root of twelve without any scatter.
fn coarseness(values: &[f64]) -> f64 {
    resolution(values) / 12f64.sqrt()
}

/// The standard error of the pressure's mean over a window, Pa: the spread of means of the same length around it, while the command
/// holds. The jack swings on its oil, so that samples in one window depend on each other, and more on those a swing away. Each mean
/// is compared with those before and after it, so that the slow creep does not count; the median, so that a slip does not.
/// `None` where there is too little around the window.
fn spread_around(trace: &Trace, at: &Window) -> Option<f64> {
    let (time_s, command_m) = (trace.time_s(), trace.position_command_m());
    let values = trace.channel(Channel::LoadPressure)?;
    let inside = window(time_s, at.from_s, at.to_s);
    let (size, reach) = (inside.len(), AROUND * inside.len());
    let held = |&i: &usize| (command_m[i] - command_m[inside.start]).abs() <= HELD_M;
    let first = (inside.start.saturating_sub(reach)..inside.start).rev().take_while(held).last()?;
    let last = (inside.end..(inside.end + reach).min(values.len())).take_while(held).last().unwrap_or(inside.end - 1);
    let values = &values[first..=last];
    // By the trapezoidal rule, as the mean itself.
    let areas = values.windows(2).scan(0.0, |area, pair| {
        *area += 0.5 * (pair[0] + pair[1]);
        Some(*area)
    });
    let areas: Vec<f64> = std::iter::once(0.0).chain(areas).collect();
    let length = size - 1;
    let means: Vec<f64> = areas.iter().zip(areas.iter().skip(length)).map(|(a, b)| (b - a) / length as f64).collect();
    let compared = APART.iter().flat_map(|halves| {
        let apart = halves * size / 2;
        means.iter().zip(means.iter().skip(apart)).zip(means.iter().skip(2 * apart))
    });
    let mut differences: Vec<f64> =
        compared.map(|((before, here), after)| (after - 2.0 * here + before).abs()).collect();
    if differences.len() < COMPARISONS_MIN {
        return None;
    }
    let middle = differences.len() / 2;
    let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
    Some(median / MEDIAN_MAGNITUDE / 6f64.sqrt())
}
