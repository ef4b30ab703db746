//! The trace objective: the monitoring model, driven by what was recorded, is fitted to every recorded channel over the whole trace.
//!
//! The data's way: the trace becomes [`observed`] bins; the search proposes faults, which [`runs`] drives through the monitoring
//! model in lock-step; around the best a [`surface`] says how far the two models are apart; [`mod@fit`] finds the faults on it and how
//! well they are known, until neither moves; [`judged`] keeps back what should not be believed.

pub mod fit;
pub mod judged;
pub mod observed;
pub mod runs;
pub mod surface;

use super::request::{Fault, Objective};
use super::search::{Minimum, minimise};
use super::{Estimate, EstimationError, Settings};
use crate::models::fault::Faults;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::SimulationError;
use crate::models::trace::{Channel, Trace};
use crate::numeric::watch::{Stretch, Watch};
use crate::optimiser::polish::simplex;
use crate::optimiser::{Bounds, Candidate};
use fit::{Fitted, fit};
use observed::Observations;
use runs::{Runs, Wanted};
use surface::{Surface, spacing};

/// The part of a channel's scale that the monitoring model without correction is not trusted in.
const TRUST: f64 = 0.01;
/// Surfaces that are learnt, each around the best of the one before, until the best stays.
const SURFACES_MAX: usize = 12;
/// The best stays when it moves, and will move, by no more than this part of the levels' spacing.
const STAYS: f64 = 0.1;
/// Steps are taken to shrink at least so fast; without it two that are next to nothing would say that there is no end.
const SHRINKS_MIN: f64 = 0.95;
/// The polish of the search on the monitoring model alone: where the bias is not corrected yet, a thousandth is enough.
const POLISH: simplex::Settings = simplex::Settings { width: 0.05, width_min: 1e-3, iterations: 100, cost_enough: 0.0 };

/// Estimates the faults that are asked for from the whole trace.
///
/// # Errors
/// Cancellation by `watch`.
pub fn estimate(
    trace: &Trace,
    set: &ParameterSet,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Estimate, EstimationError> {
    let inconclusive = |reasons| Estimate {
        objective: Objective::Trace.name().into(),
        faults: judged::unknown(&settings.faults.faults()),
        ..Estimate::inconclusive(set, settings, reasons)
    };
    let mut observations = match Observations::new(trace, set) {
        Ok(observations) => observations,
        Err(reason) => return Ok(inconclusive(vec![reason])),
    };
    let reasons = judged::objections(trace, &observations, set);
    if !reasons.is_empty() {
        return Ok(inconclusive(reasons));
    }
    let faults = settings.faults.faults();
    let wide = search(&observations, &faults, set, settings, watch)?;
    let mut estimate = inconclusive(Vec::new());
    estimate.evaluations = wide.evaluations;
    let start = proposal(&faults, &wide.best.candidate);
    let refined =
        surface::feel_noise(&mut observations, &start, set, settings.seed, &Stretch { watch, from: 0.5, to: 0.5 })
            .and_then(|()| refine(start, &faults, &observations, set, watch));
    match refined {
        Ok(Some(fitted)) => {
            estimate.cost = Some(fitted.cost);
            judged::judge(&mut estimate, &fitted, &faults, &observations);
        }
        Ok(None) => estimate.reasons.push("the trace does not tell the faults that were asked for apart".into()),
        Err(SimulationError::Cancelled) => return Err(EstimationError::Cancelled),
        Err(error) => estimate.reasons.push(format!("the reference model cannot follow this trace: {error}")),
    }
    Ok(estimate)
}

/// Whether a trace departs from the monitoring model at some faults by more than the models' known bias: one uncorrected run is held
/// against it.
#[must_use]
pub fn departs(trace: &Trace, set: &ParameterSet, faults: &Faults) -> bool {
    let Ok(observations) = Observations::new(trace, set) else { return false };
    let shown = Runs::new(&observations, set).shown(&[*faults]).remove(0);
    let block_s = observations.block_s();
    observations.channels.iter().any(|channel| {
        let modelled = observations.means(&shown[channel.place]);
        let off: Vec<f64> = channel.values.iter().zip(&modelled).map(|(y, m)| y - m).collect();
        channel.left(&off, channel.noise_mean_square(block_s), block_s) > departure_max(channel.channel)
    })
}

/// The part of a channel that the uncorrected model may leave. Over 80 diagnostic traces of the reference model, quiet and noisy (KGM 0 to
/// 0.6, FDJ 200 to 2000 N), it leaves at most 0.024 of the current, 0.034 of the pressure and 0.013 of the position. Beyond these
/// limits nothing is refused: the whole trace is fitted.
const fn departure_max(channel: Channel) -> f64 {
    match channel {
        Channel::JackPosition => 0.016,
        Channel::LoadPressure => 0.05,
        _ => 0.03,
    }
}

/// The best of the monitoring model alone.
fn search(
    observations: &Observations,
    faults: &[Fault],
    set: &ParameterSet,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Minimum, EstimationError> {
    let runs = Runs::new(observations, set);
    let wanted = wanted(observations);
    let bounds = Bounds::new(&faults.iter().map(|fault| fault.range()).collect::<Vec<_>>());
    let informative: f64 =
        wanted.iter().map(|channel| channel.iter().filter(|(_, weight)| *weight > 0.0).count() as f64).sum();
    let costs = |candidates: &[Candidate]| -> Vec<f64> {
        let levels: Vec<Faults> = candidates.iter().map(|candidate| proposal(faults, candidate)).collect();
        runs.costs(&levels, &wanted)
            .into_iter()
            .map(|cost| if cost.is_finite() { cost / informative } else { f64::MAX })
            .collect()
    };
    minimise(&bounds, POLISH, &costs, settings, &Stretch { watch, from: 0.0, to: 0.5 })
}

fn wanted(observations: &Observations) -> Wanted {
    let weights = fit::weights(&observations.binned, None, TRUST);
    let mut wanted: Wanted = std::array::from_fn(|_| Vec::new());
    for (channel, weights) in observations.binned.iter().zip(weights) {
        wanted[channel.place] = channel.values.iter().copied().zip(weights).collect();
    }
    wanted
}

/// The faults that a candidate of the search stands for; those that are not asked for are healthy.
fn proposal(faults: &[Fault], candidate: &[f64]) -> Faults {
    let mut proposal = Faults::default();
    for (fault, value) in faults.iter().zip(candidate) {
        *fault.of_mut(&mut proposal) = *value;
    }
    proposal
}

/// How far a fault will still move after a step, when its steps go on shrinking as from the one before: where two faults look alike
/// they shrink so slowly that many small ones make a long way.
fn to_come(step: f64, before: f64) -> f64 {
    let ratio = (step / before).min(SHRINKS_MIN);
    step * ratio / (1.0 - ratio)
}

/// The best of the corrected model: on surface after surface, until it stays.
fn refine(
    start: Faults,
    faults: &[Fault],
    observations: &Observations,
    set: &ParameterSet,
    watch: &dyn Watch,
) -> Result<Option<Fitted>, SimulationError> {
    let runs = &Runs::new(observations, set);
    let mut at = start;
    let mut before = vec![f64::INFINITY; faults.len()];
    let mut fitted = None;
    for round in 0..SURFACES_MAX {
        let (from, to) = (round as f64, (round + 1) as f64);
        let part = |round: f64| 0.5 + 0.5 * round / SURFACES_MAX as f64;
        let surface =
            Surface::learn(&at, faults, runs, observations, set, &Stretch { watch, from: part(from), to: part(to) })?;
        let Some(mut found) = fit(&at, faults, runs, observations, &surface) else { return Ok(None) };
        let moved = |fault: &Fault| (fault.of(&found.faults) - fault.of(&at)).abs() / spacing(*fault, fault.of(&at));
        let steps: Vec<f64> = faults.iter().map(moved).collect();
        found.settled =
            steps.iter().zip(&before).map(|(step, before)| step.max(to_come(*step, *before)) <= STAYS).collect();
        let stays = found.settled.iter().all(|settled| *settled);
        (at, before) = (found.faults, steps);
        fitted = Some(found);
        if stays {
            break;
        }
    }
    Ok(fitted)
}

#[cfg(test)]
mod tests {
    use super::to_come;

    #[test]
    fn what_is_to_come_is_the_sum_of_the_steps_that_follow() {
        let follow: f64 = (1..200).map(|k| 0.1 * 0.8f64.powi(k)).sum();
        assert!((to_come(0.1, 0.125) - follow).abs() < 1e-12, "{follow}");
        assert_eq!(to_come(0.1, f64::INFINITY), 0.0);
        assert!((to_come(1e-3, 1e-3) - 0.019).abs() < 1e-12, "no end is not taken for one of next to nothing");
    }
}
