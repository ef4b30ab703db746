//! How honest the standard deviations are: noisy traces of faults drawn at random, and how often the truth lies within the interval.
//!
//! No table of the thesis: it gives no standard deviations.

use rand::RngExt;

use super::runs::{each, recipe};
use super::table::{Comparison, Row, Table};
use super::thesis::Pair;
use super::{Name, ReproductionError};
use crate::estimation::{Settings, estimate};
use crate::models::drive::Drive;
use crate::models::fault::FDJ_NOMINAL_N;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, Simulation, simulate};
use crate::numeric::rng::Seed;
use crate::numeric::watch::Watch;

/// Traces.
const TRACES: u64 = 200;
/// The most demagnetisation, and the most friction, N; drawn evenly from zero and from the nominal friction.
const KGM_MAX: f64 = 0.45;
const FDJ_MAX_N: f64 = 1100.0;
/// Power of the noise on the current, mA² s (section 7.2).
const NOISE_POWER_MA2_S: f64 = 5e-6;
const SAMPLE_RATE_HZ: f64 = 1e3;
const DURATION_S: f64 = 6.0;
/// Standard deviations on either side of an estimate that hold the truth nine times in ten.
pub const NINE_IN_TEN: f64 = 1.645;
/// The root of the draws; the noise of trace k has the seed `NOISE_SEED + k`.
const SEED: Seed = Seed(20);
const NOISE_SEED: u64 = 20_000;

/// An estimate with its standard deviations, or why there is none.
type Found = Result<(Pair, Pair), String>;

/// The traces, their estimates, and how often the interval holds the truth.
pub fn table(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let cases: Vec<(u64, Pair)> = (0..TRACES).map(|trace| (trace, drawn(trace))).collect();
    let found: Vec<Found> = each(&cases, watch, |&(trace, faults), quiet| {
        let plain = recipe(ModelKind::Reference, Drive::Diagnostic, faults, DURATION_S, SAMPLE_RATE_HZ);
        let noisy = Simulation { noise_power_ma2_s: NOISE_POWER_MA2_S, seed: NOISE_SEED + trace, ..plain };
        let found = estimate(&simulate(&noisy, set, quiet)?, set, &Settings::default(), quiet)?;
        let both = found.kgm.zip(found.fdj_n).zip(found.kgm_std.zip(found.fdj_n_std));
        Ok(both.ok_or_else(|| found.reasons.join("; ")))
    })?;
    let rows = cases.iter().zip(&found).map(|(&(trace, truth), found)| row(trace as usize + 1, truth, found)).collect();
    Ok(Table::new(Name::Coverage, "Standard deviations against the truth", rows, notes(&cases, &found)))
}

/// The faults of a trace.
fn drawn(trace: u64) -> Pair {
    let mut stream = SEED.stream("coverage", trace);
    let (kgm, fdj): (f64, f64) = (stream.random(), stream.random());
    (KGM_MAX * kgm, FDJ_NOMINAL_N + (FDJ_MAX_N - FDJ_NOMINAL_N) * fdj)
}

fn row(case: usize, truth: Pair, found: &Found) -> Row {
    let found = found.as_ref().ok();
    let spread = |quantity, of: fn(&Pair) -> f64| Comparison {
        quantity,
        thesis: None,
        ours: found.map(|(_, std)| of(std)),
        error_percent: None,
        thesis_error_percent: None,
    };
    let (kgm, fdj_n) = truth;
    let quantities = vec![
        Comparison::estimate("kgm_estimated", None, found.map(|(estimate, _)| estimate.0), kgm),
        spread("kgm_std", |std| std.0),
        Comparison::estimate("fdj_estimated_n", None, found.map(|(estimate, _)| estimate.1), fdj_n),
        spread("fdj_std_n", |std| std.1),
    ];
    Row { heading: String::new(), case, labels: Vec::new(), kgm, fdj_n, quantities }
}

fn notes(cases: &[(u64, Pair)], found: &[Found]) -> Vec<String> {
    let known: Vec<(&Pair, &Pair, &Pair)> = cases
        .iter()
        .zip(found)
        .filter_map(|((_, truth), found)| found.as_ref().ok().map(|(estimate, std)| (truth, estimate, std)))
        .collect();
    let told = |of: fn(&Pair) -> f64| {
        let scores: Vec<f64> =
            known.iter().map(|(truth, found, std)| ((of(found) - of(truth)) / of(std)).abs()).collect();
        let within = scores.iter().filter(|score| **score <= NINE_IN_TEN).count();
        (within, 100.0 * within as f64 / scores.len() as f64, scores.iter().copied().fold(0.0, f64::max))
    };
    let (kgm, fdj) = (told(|pair| pair.0), told(|pair| pair.1));
    let off = known.iter().map(|(truth, found, _)| (found.0 - truth.0).abs()).fold(0.0, f64::max);
    vec![
        format!(
            "Diagnostic command, reference model, {DURATION_S} s at 1 kHz through white noise of {NOISE_POWER_MA2_S:e} mA² s on the \
             current; KGM drawn evenly from 0 to {KGM_MAX}, FDJ from {FDJ_NOMINAL_N} to {FDJ_MAX_N} N. Of {} traces {} are conclusive.",
            found.len(),
            known.len()
        ),
        format!(
            "The truth lies within {NINE_IN_TEN} standard deviations of the estimate, which nine in ten should, in {} traces for KGM \
             ({:.1} %) and in {} for FDJ ({:.1} %). It is at most {:.2} of them away for KGM, {:.2} for FDJ. KGM is off by at most \
             {off:.4}.",
            kgm.0, kgm.1, fdj.0, fdj.1, kgm.2, fdj.2
        ),
    ]
}
