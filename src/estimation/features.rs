//! The two features of section 6.3: the steady current of the ramp and the pressure 1.1 s after the step. Beside them the
//! pressure of the ramp and the current after the step, by which a model can be told wrong.

use super::manoeuvre::{Jump, Manoeuvres, Window};
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, resolution, standard_error, window};

/// Parts into which a window is cut to judge how well its mean is known, and the fewest samples that it may have.
const BATCHES: (usize, usize) = (10, 5);

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

/// Measures the features of a trace.
///
/// # Errors
/// Every reason why the trace does not show them.
pub fn measure(trace: &Trace, manoeuvres: &Manoeuvres) -> Result<Measured, Vec<String>> {
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
    let other = |channel, window| mean(trace, channel, window).map_err(|reason| vec![reason]);
    let ramp_pressure = other(Channel::LoadPressure, &at_ramp)?;
    let step_current = other(Channel::ServovalveCurrent, &at_step)?;
    Ok(Measured {
        features: Features {
            servovalve_current_a: current.value,
            load_pressure_pa: pressure.value,
            ramp_pressure_pa: ramp_pressure.value,
            step_current_a: step_current.value,
        },
        standard_errors: StandardErrors { servovalve_current_a: current.error, load_pressure_pa: pressure.error },
        current_window: current.window,
        pressure_window: pressure.window,
        jump: manoeuvres.jump,
    })
}

/// The mean of a channel over a window.
struct Mean {
    value: f64,
    error: f64,
    window: Window,
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
    // A coarse sensor may be off by its quantum over the square root of twelve without any scatter.
    let error = scatter.hypot(resolution(values) / 12f64.sqrt());
    Ok(Mean { value, error, window: *at })
}
