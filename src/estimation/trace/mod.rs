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
use crate::models::trace::Trace;
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
const SURFACES_MAX: usize = 6;
/// The best stays when it moves by no more than this part of the levels' spacing.
const STAYS: f64 = 0.1;
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
    let mut fitted = None;
    for round in 0..SURFACES_MAX {
        let (from, to) = (round as f64, (round + 1) as f64);
        let part = |round: f64| 0.5 + 0.5 * round / SURFACES_MAX as f64;
        let surface =
            Surface::learn(&at, faults, runs, observations, set, &Stretch { watch, from: part(from), to: part(to) })?;
        let Some(found) = fit(&at, faults, runs, observations, &surface) else { return Ok(None) };
        let moved = |fault: &Fault| (fault.of(&found.faults) - fault.of(&at)).abs() / spacing(*fault, fault.of(&at));
        let stays = faults.iter().all(|fault| moved(fault) <= STAYS);
        at = found.faults;
        fitted = Some(found);
        if stays {
            break;
        }
    }
    Ok(fitted)
}
