//! The methods of the search beside each other, at equal evaluations over the 25 pairs of faults of section 7.2.

use serde::Serialize;

use super::ReproductionError;
use super::runs::{each, recipe};
use super::thesis::cases;
use crate::estimation::evaluate::{Evaluator, Proposal};
use crate::estimation::method::Method;
use crate::estimation::search::{Found, search};
use crate::estimation::{Settings, features, manoeuvre};
use crate::models::drive::Drive;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, simulate};
use crate::numeric::watch::Watch;

/// What every method may evaluate: the thesis's 40 candidates and 10 generations, whose elite of 2 is not evaluated again.
const EVALUATIONS: usize = 40 + 10 * 38;
/// Candidates and generations of the methods without an elite: as many evaluations.
const OTHERS: (usize, usize) = (42, 9);
/// Seeds of each search.
const SEEDS: u64 = 5;
/// A cost that counts as near: 0.1 mA or 10 kPa off.
const NEAR_COST: f64 = 1.0;

/// How one method did over all pairs and seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// The method.
    pub method: &'static str,
    /// Evaluations of the wide search, on the average.
    pub evaluations: f64,
    /// The median of the wide search's cost.
    pub cost_median: f64,
    /// The largest of it.
    pub cost_worst: f64,
    /// The share of the wide searches that ended within 0.1 mA or 10 kPa of what was measured.
    pub near_share: f64,
    /// The largest error of KGM after the wide search.
    pub kgm_error_worst: f64,
    /// The largest error of FDJ after the wide search, %.
    pub fdj_error_worst_percent: f64,
    /// Evaluations with the polish, on the average.
    pub polished_evaluations: f64,
    /// The largest error of KGM after the polish.
    pub polished_kgm_error_worst: f64,
    /// The largest error of FDJ after the polish, %.
    pub polished_fdj_error_worst_percent: f64,
}

/// Compares every method. The same set gives the same scores.
///
/// # Errors
/// A run that failed, or cancellation by `watch`.
pub fn compare(set: &ParameterSet, watch: &dyn Watch) -> Result<Vec<Score>, ReproductionError> {
    let searches = each(&cases(), watch, |&(kgm, fdj_n), quiet| {
        let recipe = recipe(ModelKind::Reference, Drive::Diagnostic, (kgm, fdj_n), 6.0, 1e3);
        let trace = simulate(&recipe, set, quiet)?;
        let found = manoeuvre::find(trace.time_s(), trace.position_command_m());
        let measured = features::measure(&trace, &found, &set.shared()).expect("a diagnostic run shows its features");
        let evaluator = Evaluator::new(&trace, &measured, set);
        let bias = &set.monitoring_model().bias;
        let mut searches = Vec::new();
        for method in Method::ALL {
            for seed in 1..=SEEDS {
                let settings = settings(method, seed);
                searches.push((method, (kgm, fdj_n), search(&evaluator, &measured, bias, &settings, quiet)?));
            }
        }
        Ok(searches)
    })?;
    let all: Vec<(Method, (f64, f64), Found)> = searches.into_iter().flatten().collect();
    Ok(Method::ALL.map(|method| score(method, &all)).into())
}

fn settings(method: Method, seed: u64) -> Settings {
    let thesis = Settings { method, seed, ..Settings::default() };
    let (population, generations) = OTHERS;
    match method {
        Method::Ga => thesis,
        _ => Settings { population, generations, ..thesis },
    }
}

fn score(method: Method, all: &[(Method, (f64, f64), Found)]) -> Score {
    let own: Vec<_> = all.iter().filter(|one| one.0 == method).collect();
    let mut costs: Vec<f64> = own.iter().map(|one| one.2.wide.cost).collect();
    costs.sort_by(f64::total_cmp);
    let mean = |of: fn(&Found) -> u64| own.iter().map(|one| of(&one.2) as f64).sum::<f64>() / own.len() as f64;
    let worst = |of: fn(&Found) -> Proposal, error: fn(Proposal, (f64, f64)) -> f64| {
        own.iter().map(|one| error(of(&one.2), one.1)).fold(0.0, f64::max)
    };
    let kgm = |found: Proposal, truth: (f64, f64)| (found.kgm - truth.0).abs();
    let fdj_percent = |found: Proposal, truth: (f64, f64)| (found.fdj_n / truth.1 - 1.0).abs() * 100.0;
    Score {
        method: method.name(),
        evaluations: mean(|found| found.wide.evaluations),
        cost_median: costs[costs.len() / 2],
        cost_worst: costs[costs.len() - 1],
        near_share: costs.iter().filter(|cost| **cost <= NEAR_COST).count() as f64 / costs.len() as f64,
        kgm_error_worst: worst(|found| found.wide.proposal, kgm),
        fdj_error_worst_percent: worst(|found| found.wide.proposal, fdj_percent),
        polished_evaluations: mean(|found| found.evaluations),
        polished_kgm_error_worst: worst(|found| found.proposal, kgm),
        polished_fdj_error_worst_percent: worst(|found| found.proposal, fdj_percent),
    }
}

/// What the scores are of, in a sentence.
#[must_use]
pub fn told() -> String {
    format!(
        "{EVALUATIONS} evaluations of the monitoring model each, on the 25 pairs of section 7.2, {SEEDS} seeds; the objective \
         counts 0.1 mA or 10 kPa as 1"
    )
}
