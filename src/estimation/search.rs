//! The search for the faults: the thesis's objective, a wide search (the genetic algorithm or another), a local polish.

use super::evaluate::{Evaluator, Proposal};
use super::features::{Features, Measured};
use super::method::Method;
use super::{EstimationError, Settings};
use crate::models::fault::{FDJ_MAX_N, FDJ_NOMINAL_N};
use crate::models::monitoring::Bias;
use crate::numeric::watch::Watch;
use crate::optimiser::polish::simplex::{self, Simplex};
use crate::optimiser::{Best, Bounds, Candidate, Search};

/// Weight of the current in the objective, 1/mA (section 7.2).
const CURRENT_WEIGHT_PER_MA: f64 = 10.0;
/// Weight of the pressure in the objective, 1/Pa (section 7.2).
const PRESSURE_WEIGHT_PER_PA: f64 = 1e-4;
/// The polish: it ends within 1e-6 of the ranges, or at a cost that stands for 1e-5 mA or 1 Pa.
const POLISH: simplex::Settings =
    simplex::Settings { width: 0.02, width_min: 1e-6, iterations: 200, cost_enough: 1e-4 };
/// The share of the progress that the wide search makes; the polish makes the rest.
const WIDE_PROGRESS: f64 = 0.7;

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The best candidate.
    pub proposal: Proposal,
    /// Its objective.
    pub cost: f64,
    /// Model runs made.
    pub evaluations: u64,
    /// What the wide search had found, before the polish.
    pub wide: Wide,
}

/// What the wide search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wide {
    /// The best candidate.
    pub proposal: Proposal,
    /// Its objective.
    pub cost: f64,
    /// Model runs made.
    pub evaluations: u64,
}

/// The thesis's objective (figure 7.16), of a model that is corrected by more than its 0.15 mA.
#[must_use]
pub fn objective(measured: &Features, modelled: &Features) -> f64 {
    let current_a = measured.servovalve_current_a - modelled.servovalve_current_a;
    let pressure_pa = measured.load_pressure_pa - modelled.load_pressure_pa;
    PRESSURE_WEIGHT_PER_PA * pressure_pa.abs() + CURRENT_WEIGHT_PER_MA * (current_a * 1e3).abs()
}

/// The features of each proposal, corrected by the known difference between the models.
#[must_use]
pub fn corrected(evaluator: &Evaluator, bias: &Bias, proposals: &[Proposal]) -> Vec<Features> {
    let features = evaluator.features(proposals);
    proposals.iter().zip(features).map(|(p, modelled)| modelled.corrected(&bias.at(p.kgm, p.fdj_n))).collect()
}

/// Searches the thesis's bounds: KGM 0 to 1, FDJ 200 to 2000 N.
///
/// # Errors
/// Cancellation by `watch`.
pub fn search(
    evaluator: &Evaluator,
    measured: &Measured,
    bias: &Bias,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Found, EstimationError> {
    let bounds = Bounds::new(&[(0.0, 1.0), (FDJ_NOMINAL_N, FDJ_MAX_N)]);
    let costs = |candidates: &[Candidate]| -> Vec<f64> {
        let proposals: Vec<Proposal> = candidates.iter().map(|c| Proposal { kgm: c[0], fdj_n: c[1] }).collect();
        let features = corrected(evaluator, bias, &proposals);
        features.iter().map(|modelled| objective(&measured.features, modelled)).collect()
    };
    let found = minimise(&bounds, POLISH, &costs, settings, watch)?;
    let proposal = |candidate: &Candidate| Proposal { kgm: candidate[0], fdj_n: candidate[1] };
    let (best, wide) = (&found.best, &found.wide);
    let wide = Wide { proposal: proposal(&wide.candidate), cost: wide.cost, evaluations: found.wide_evaluations };
    Ok(Found { proposal: proposal(&best.candidate), cost: best.cost, evaluations: found.evaluations, wide })
}

/// What a wide search and its polish found.
pub(super) struct Minimum {
    /// The best candidate.
    pub best: Best,
    /// The best before the polish.
    pub wide: Best,
    /// Model runs made until then.
    pub wide_evaluations: u64,
    /// Model runs made in all.
    pub evaluations: u64,
}

/// A wide search by the method of the settings, then a local polish of its best.
pub(super) fn minimise(
    bounds: &Bounds,
    polish: simplex::Settings,
    costs: &impl Fn(&[Candidate]) -> Vec<f64>,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Minimum, EstimationError> {
    let rounds = settings.generations + 1;
    let mut evaluations = 0;
    let mut method = Method::search(settings, bounds);
    let wide =
        drive(method.as_mut(), costs, &mut evaluations, watch, |round| WIDE_PROGRESS * round as f64 / rounds as f64)?;
    let wide_evaluations = evaluations;
    let mut simplex = Simplex::new(bounds, &wide.candidate, polish);
    let polished = drive(&mut simplex, costs, &mut evaluations, watch, |round| {
        WIDE_PROGRESS + (1.0 - WIDE_PROGRESS) * round as f64 / polish.iterations as f64
    })?;
    let best = if polished.cost < wide.cost { polished } else { wide.clone() };
    Ok(Minimum { best, wide, wide_evaluations, evaluations })
}

/// Runs a search to its end.
fn drive(
    search: &mut dyn Search,
    costs: &impl Fn(&[Candidate]) -> Vec<f64>,
    evaluations: &mut u64,
    watch: &dyn Watch,
    fraction: impl Fn(usize) -> f64,
) -> Result<Best, EstimationError> {
    for round in 1.. {
        if search.stop().is_some() {
            break;
        }
        if watch.cancelled() {
            return Err(EstimationError::Cancelled);
        }
        let asked = search.ask();
        *evaluations += asked.len() as u64;
        let told = costs(asked);
        search.tell(&told);
        watch.progress(fraction(round).min(1.0));
    }
    Ok(search.best().clone())
}
