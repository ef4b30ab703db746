//! From a trace to its faults: the monitoring model is fitted to what was recorded.
//!
//! The data's way: the recorded command shows the [`manoeuvre`]s; there the two [`features`] are measured; the
//! [`search`] proposes faults, which [`evaluate`] runs through the model in lock-step; [`uncertainty`] says how well the
//! best is known; `plausibility` keeps back what should not be believed.

mod asked;
pub mod evaluate;
pub mod features;
pub mod manoeuvre;
pub mod method;
mod plausibility;
pub mod request;
pub mod search;
pub mod trace;
pub mod uncertainty;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use thiserror::Error;
use utoipa::ToSchema;

use crate::models::fault::Faults;
use crate::models::parameters::ParameterSet;
use crate::models::trace::Trace;
use crate::numeric::watch::Watch;

use evaluate::Evaluator;
use manoeuvre::Manoeuvres;
use method::{Choices, Method};
use plausibility::{misfits, objections};
use request::{Objective, Requested};

/// Whether a trace determined the faults. The features objective determines both or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The faults have figures.
    Conclusive,
    /// No fault has one; the reasons say why.
    Inconclusive,
}

impl Verdict {
    /// The verdict's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Conclusive => "conclusive",
            Self::Inconclusive => "inconclusive",
        }
    }
}

/// The largest standard deviation of KGM with which the two features are left alone.
const FEATURES_KGM_STD_MAX: f64 = 0.002;
/// How many candidates a generation may have.
pub const POPULATION: RangeInclusive<usize> = 4..=1000;
/// How many generations a search may breed.
pub const GENERATIONS: RangeInclusive<usize> = 0..=1000;

/// How to search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The method of the search, before the local polish.
    #[serde(default)]
    pub method: Method,
    /// What the genetic algorithm does at each stage; of no effect with another method.
    #[serde(default)]
    pub ga: Choices,
    /// Candidates in a generation, 4 to 1000; 40 in the thesis.
    pub population: usize,
    /// Generations, 0 to 1000; 10 in the thesis.
    pub generations: usize,
    /// Seed of every random draw.
    pub seed: u64,
    /// What is minimised.
    #[serde(default)]
    pub objective: Objective,
    /// The faults that are asked for.
    #[serde(default)]
    pub faults: Requested,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Ga,
            ga: Choices::THESIS,
            population: 40,
            generations: 10,
            seed: 1,
            objective: Objective::Auto,
            faults: Requested::KGM_AND_FDJ,
        }
    }
}

/// What an estimation found. A figure that the trace does not determine is `None`, and `reasons` says why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Estimate {
    /// Torque-motor demagnetisation KGM, 0 to 1.
    pub kgm: Option<f64>,
    /// Its standard deviation.
    pub kgm_std: Option<f64>,
    /// Dynamic jack friction FDJ, N.
    pub fdj_n: Option<f64>,
    /// Its standard deviation, N.
    pub fdj_n_std: Option<f64>,
    /// The objective at the best candidate (dimensionless, section 7.2); `None` when no search was made.
    pub cost: Option<f64>,
    /// Monitoring-model runs that the search made.
    pub evaluations: u64,
    /// The search method; `ga(...)` with choices that are not the thesis's.
    pub method: String,
    /// The seed of the search.
    pub seed: u64,
    /// The objective that was minimised.
    pub objective: String,
    /// Whether at least one fault was determined.
    pub verdict: Verdict,
    /// Why a figure is missing, or what to know of one that is there.
    pub reasons: Vec<String>,
    /// Other faults that were asked for, by their names with units, and their standard deviations under `..._std`.
    pub faults: BTreeMap<String, Option<f64>>,
    /// SHA-256 of the parameter set.
    pub parameter_set_hash: String,
    /// The elevon version.
    pub version: String,
}

/// Why an estimation could not be made at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EstimationError {
    /// A setting is out of its range.
    #[error("{name}: found {found}, expected {min} to {max}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        found: usize,
        /// The least allowed.
        min: usize,
        /// The most allowed.
        max: usize,
    },
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

/// Estimates the faults of the actuator that made `trace`.
///
/// # Errors
/// Settings out of range, or cancellation by `watch`. A trace that tells nothing is not an error but an
/// inconclusive estimate.
pub fn estimate(
    trace: &Trace,
    set: &ParameterSet,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Estimate, EstimationError> {
    settings.check()?;
    if settings.objective == Objective::Trace {
        return trace::estimate(trace, set, settings, watch);
    }
    let found = manoeuvre::find(trace.time_s(), trace.position_command_m());
    match settings.objective {
        Objective::Auto if !plausibility::features_suffice(trace, &found, set, settings.faults) => {
            trace::estimate(trace, set, settings, watch)
        }
        Objective::Auto => {
            let estimate = by_features(trace, &found, set, settings, watch)?;
            // In noise the whole trace knows more; and a spool that stands elsewhere than the current would put it, or a trace that
            // departs from the model elsewhere, shows what two features cannot: a leak, another actuator, another supply.
            let departs = |estimate: &Estimate| {
                let found = estimate.kgm.zip(estimate.fdj_n);
                found
                    .is_some_and(|(kgm, fdj_n)| trace::departs(trace, set, &Faults { kgm, fdj_n, ..Faults::default() }))
            };
            let noisy = estimate.kgm_std.is_some_and(|std| std > FEATURES_KGM_STD_MAX);
            if noisy
                || estimate.kgm.is_some_and(|kgm| plausibility::spool_contradicts(trace, &found, set, kgm))
                || departs(&estimate)
            {
                return trace::estimate(trace, set, settings, watch);
            }
            Ok(estimate)
        }
        Objective::Features | Objective::Trace => by_features(trace, &found, set, settings, watch),
    }
}

/// Estimates demagnetisation and friction from the two features.
fn by_features(
    trace: &Trace,
    found: &Manoeuvres,
    set: &ParameterSet,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Estimate, EstimationError> {
    let measured = match features::measure(trace, found, &set.shared()) {
        Ok(measured) => measured,
        Err(reasons) => return Ok(Estimate::inconclusive(set, settings, reasons)),
    };
    let reasons = objections(trace, &measured, set);
    if !reasons.is_empty() {
        return Ok(Estimate::inconclusive(set, settings, reasons));
    }
    let bias = &set.monitoring_model().bias;
    let evaluator = Evaluator::new(trace, &measured, set);
    let found = search::search(&evaluator, &measured, bias, settings, watch)?;
    let modelled = search::corrected(&evaluator, bias, &[found.proposal])[0];
    let mut estimate = Estimate::inconclusive(set, settings, misfits(&measured.features, &modelled));
    estimate.cost = Some(found.cost);
    estimate.evaluations = found.evaluations;
    if !estimate.reasons.is_empty() {
        return Ok(estimate);
    }
    match uncertainty::standard_deviations(&evaluator, found.proposal, &measured, bias) {
        Some(std) => {
            estimate.kgm = Some(found.proposal.kgm);
            estimate.kgm_std = Some(std.kgm);
            estimate.fdj_n = Some(found.proposal.fdj_n);
            estimate.fdj_n_std = Some(std.fdj_n);
            estimate.verdict = Verdict::Conclusive;
        }
        None => estimate
            .reasons
            .push("the trace does not tell the faults well enough: a standard deviation is too large".into()),
    }
    Ok(estimate)
}

impl Settings {
    /// The method, with the genetic algorithm's choices where they are not the thesis's.
    fn method_told(&self) -> String {
        match self.method {
            Method::Ga if self.ga != Choices::THESIS => format!("ga({})", self.ga),
            method => method.name().into(),
        }
    }

    fn check(&self) -> Result<(), EstimationError> {
        let expect = |name, found: usize, range: RangeInclusive<usize>| {
            let (min, max) = (*range.start(), *range.end());
            if range.contains(&found) { Ok(()) } else { Err(EstimationError::Setting { name, found, min, max }) }
        };
        expect("population", self.population, POPULATION)?;
        expect("generations", self.generations, GENERATIONS)
    }
}

impl Estimate {
    /// An estimate without figures.
    fn inconclusive(set: &ParameterSet, settings: &Settings, reasons: Vec<String>) -> Self {
        Self {
            kgm: None,
            kgm_std: None,
            fdj_n: None,
            fdj_n_std: None,
            cost: None,
            evaluations: 0,
            method: settings.method_told(),
            seed: settings.seed,
            objective: "features".into(),
            verdict: Verdict::Inconclusive,
            reasons,
            faults: BTreeMap::new(),
            parameter_set_hash: set.hash().to_owned(),
            version: crate::VERSION.into(),
        }
    }
}
