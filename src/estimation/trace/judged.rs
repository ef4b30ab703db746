//! What of a fit should be believed.

use std::collections::BTreeMap;

use super::fit::Fitted;
use super::observed::Observations;
use crate::estimation::request::Fault;
use crate::estimation::{Estimate, Verdict};
use crate::models::parameters::ParameterSet;
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::range;

/// The least time in which a channel tells something, s.
const INFORMATIVE_MIN_S: f64 = 0.3;
/// The least motion of the command and, as a part of it, of the jack.
const MOTION_MIN_M: f64 = 1e-4;
const FOLLOWED_MIN: f64 = 0.05;
/// Two faults whose errors are correlated like this look alike.
const ALIKE: f64 = 0.98;

/// The largest standard deviation with which a fault counts as known.
fn known(fault: Fault, value: f64) -> f64 {
    match fault {
        Fault::Kgm => 0.03,
        Fault::Fdj => 0.1 * value,
        Fault::Clearance => 5e-6,
        Fault::Clogging => 0.1,
        Fault::FeedbackBacklash => 3e-6,
        Fault::CurrentOffset => 5e-4,
    }
}

/// Why no fit should be made.
#[must_use]
pub fn objections(trace: &Trace, observations: &Observations, set: &ParameterSet) -> Vec<String> {
    let mut reasons = Vec::new();
    let moved_m = range(trace.position_command_m());
    if moved_m < MOTION_MIN_M {
        reasons.push(format!(
            "the command moves by {:.3} mm, expected at least {:.1} mm",
            1e3 * moved_m,
            1e3 * MOTION_MIN_M
        ));
    }
    if let Some(position_m) = trace.channel(Channel::JackPosition) {
        let jack_m = range(position_m);
        if jack_m < FOLLOWED_MIN * moved_m {
            let (jack_mm, moved_mm) = (1e3 * jack_m, 1e3 * moved_m);
            reasons.push(format!(
                "the jack does not follow: it moved {jack_mm:.3} mm while the command moved {moved_mm:.3} mm"
            ));
        }
    }
    let max_ma = 1e3 * set.shared().torque_motor.current_max_a;
    for channel in &observations.channels {
        let informative_s = channel.informative.iter().filter(|told| **told).count() as f64 * observations.block_s();
        let column = channel.channel.column();
        if informative_s < INFORMATIVE_MIN_S {
            reasons.push(format!(
                "{column} tells something for {informative_s:.2} s, expected at least {INFORMATIVE_MIN_S} s: the rest is at rest or at \
                 the current's limit of {max_ma:.1} mA"
            ));
        } else if channel.scale == 0.0 {
            reasons.push(format!("{column} does not change: a sensor that is stuck"));
        }
    }
    reasons
}

/// Writes what a fit found into an estimate, and why where it found nothing.
pub fn judge(estimate: &mut Estimate, fitted: &Fitted, faults: &[Fault], observations: &Observations) {
    estimate.reasons.extend(misfits(fitted, observations));
    let explained = estimate.reasons.is_empty();
    let std = |place: usize| fitted.covariance[(place, place)].sqrt();
    for (place, fault) in faults.iter().enumerate() {
        let value = fault.of(&fitted.faults);
        let determined = explained && fitted.settled[place] && std(place) < known(*fault, value);
        if explained && !determined {
            estimate.reasons.push(undetermined(place, faults, fitted));
        }
        let figures = determined.then_some((value, std(place)));
        put(estimate, *fault, figures);
        if determined {
            estimate.verdict = Verdict::Conclusive;
        }
    }
}

/// The faults beside the two main ones, before anything is known of them.
#[must_use]
pub fn unknown(faults: &[Fault]) -> BTreeMap<String, Option<f64>> {
    let others = faults.iter().filter(|fault| !matches!(fault, Fault::Kgm | Fault::Fdj));
    others.flat_map(|fault| [fault.key().into(), format!("{}_std", fault.key())]).map(|key| (key, None)).collect()
}

fn put(estimate: &mut Estimate, fault: Fault, figures: Option<(f64, f64)>) {
    let (value, std) = (figures.map(|f| f.0), figures.map(|f| f.1));
    match fault {
        Fault::Kgm => (estimate.kgm, estimate.kgm_std) = (value, std),
        Fault::Fdj => (estimate.fdj_n, estimate.fdj_n_std) = (value, std),
        other => {
            estimate.faults.insert(other.key().into(), value);
            estimate.faults.insert(format!("{}_std", other.key()), std);
        }
    }
}

fn undetermined(place: usize, faults: &[Fault], fitted: &Fitted) -> String {
    let c = &fitted.covariance;
    let alike = (0..faults.len())
        .filter(|other| *other != place)
        .find(|other| (c[(place, *other)] / (c[(place, place)] * c[(*other, *other)]).sqrt()).abs() > ALIKE);
    let (key, std) = (faults[place].key(), c[(place, place)].sqrt());
    if !fitted.settled[place] {
        return format!(
            "this trace does not tell {key} beside the other faults that were asked for: the fit does not settle"
        );
    }
    let most = known(faults[place], faults[place].of(&fitted.faults));
    match alike {
        Some(other) => format!(
            "{key} cannot be told from {} in this trace: its standard deviation is {std:.2e}, at most {most:.2e} is asked for",
            faults[other].key()
        ),
        None => format!(
            "this trace does not tell {key}: its standard deviation is {std:.2e}, at most {most:.2e} is asked for"
        ),
    }
}

/// The part of a channel that may remain unexplained, beside its noise. The pressure shows every jerk of the stick and slip.
const fn misfit_max(channel: Channel) -> f64 {
    match channel {
        Channel::LoadPressure => 0.06,
        _ => 0.02,
    }
}

/// The channels that the best candidate does not explain.
fn misfits(fitted: &Fitted, observations: &Observations) -> Vec<String> {
    let bin_s = observations.block_s();
    let mut reasons = Vec::new();
    for ((channel, residuals), variances) in observations.channels.iter().zip(&fitted.residuals).zip(&fitted.expected) {
        // The white noise is averaged out in a block; what it moves and what the surface leaves is not.
        let slow: Vec<f64> = variances.iter().map(|v| (v - channel.noise * channel.noise).max(0.0).sqrt()).collect();
        let expected = channel.noise_mean_square(bin_s) + channel.block_mean_square(&slow, bin_s);
        let left = channel.left(residuals, expected, bin_s);
        let most = misfit_max(channel.channel);
        if left > most {
            reasons.push(format!(
                "the faults that were asked for do not explain {}: {:.1} % of it is left, at most {:.0} % is accepted; another actuator \
                 type, another fault, or a faulty sensor",
                channel.channel.column(),
                100.0 * left,
                100.0 * most
            ));
        }
    }
    reasons
}
