//! The two features of section 6.3: the steady current of the ramp and the pressure 1.1 s after the step.

use super::manoeuvre::{Manoeuvres, Window};
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, standard_error, window};

/// Parts into which a window is cut to judge how well its mean is known.
const BATCHES: usize = 10;

/// A pair of features.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// Steady current, A.
    pub servovalve_current_a: f64,
    /// Steady load pressure, Pa.
    pub load_pressure_pa: f64,
}

/// The features of a trace, with how well it knows them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The features.
    pub features: Features,
    /// Standard errors of the two means.
    pub standard_errors: Features,
    /// The largest current magnitude in its window, A.
    pub current_peak_a: f64,
    /// Where the current was taken.
    pub current_window: Window,
    /// Where the pressure was taken.
    pub pressure_window: Window,
}

/// Measures the features of a trace.
///
/// # Errors
/// Every reason why the trace does not show them.
pub fn measure(trace: &Trace, manoeuvres: &Manoeuvres) -> Result<Measured, Vec<String>> {
    let current = sampled(trace, Channel::ServovalveCurrent, manoeuvres.current, "a ramp of at least 1 s (KGM)");
    let pressure =
        sampled(trace, Channel::LoadPressure, manoeuvres.pressure, "a step that is held for at least 1.11 s (FDJ)");
    match (current, pressure) {
        (Ok(current), Ok(pressure)) => Ok(Measured {
            features: Features { servovalve_current_a: current.mean, load_pressure_pa: pressure.mean },
            standard_errors: Features { servovalve_current_a: current.error, load_pressure_pa: pressure.error },
            current_peak_a: current.peak,
            current_window: current.window,
            pressure_window: pressure.window,
        }),
        (current, pressure) => Err([current.err(), pressure.err()].into_iter().flatten().collect()),
    }
}

/// One feature.
struct Sampled {
    mean: f64,
    error: f64,
    peak: f64,
    window: Window,
}

fn sampled(trace: &Trace, channel: Channel, at: Option<Window>, needs: &str) -> Result<Sampled, String> {
    let column = channel.column();
    let values = trace.channel(channel).ok_or_else(|| format!("{column} was not recorded"))?;
    let at = at.ok_or_else(|| format!("the command has no manoeuvre that shows {column}: {needs}"))?;
    let inside = &values[window(trace.time_s(), at.from_s, at.to_s)];
    let known = mean_between(trace.time_s(), values, at.from_s, at.to_s)
        .zip(standard_error(inside, BATCHES.min(inside.len() / 2)));
    let (mean, error) = known.ok_or_else(|| {
        format!("{column} has {} samples from {:.3} to {:.3} s, expected at least 4", inside.len(), at.from_s, at.to_s)
    })?;
    let peak = inside.iter().fold(0.0_f64, |peak, v| peak.max(v.abs()));
    Ok(Sampled { mean, error, peak, window: at })
}
