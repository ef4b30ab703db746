//! The fourth and the fifth table of section 7.2: traces that hold what the monitoring model does not have.

use super::{Case, Found, clean, find, of_both, table};
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::{Stretch, Watch};
use crate::reproduction::claims::Claim;
use crate::reproduction::table::{Comparison, Row, Table};
use crate::reproduction::thesis::{KGM_LEVELS, Pair, TABLE_7_2, TABLE_CLEARANCE, TABLE_NOISE, cases};
use crate::reproduction::{Name, ReproductionError};

/// Power of the noise of the fourth table, mA² s.
const NOISE_POWER_MA2_S: f64 = 5e-6;
/// Seeds of the noise; the first one makes the rows.
const SEEDS: u64 = 10;
/// The model's own rate, Hz, for a look at what sampling costs.
const FULL_RATE_HZ: f64 = 1e5;
/// The clearance of the fifth table, taken as radial and added, m.
const CLEARANCE_M: f64 = 30e-6;

/// Both faults through the thesis's noise.
pub fn through_noise(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let noisy = |seed: u64| {
        cases().into_iter().map(move |faults| Case { noise_power_ma2_s: NOISE_POWER_MA2_S, seed, ..clean(faults) })
    };
    let all: Vec<Case> = (1..=SEEDS).flat_map(noisy).collect();
    // At the full rate the least friction is enough: the noise comes with the current, which tells KGM.
    let is_least = |case: &&Case| KGM_LEVELS.iter().any(|&kgm| case.faults == (kgm, cases()[0].1));
    let full: Vec<Case> =
        all.iter().filter(is_least).map(|case| Case { sample_rate_hz: FULL_RATE_HZ, ..*case }).collect();
    let found = find(&all, set, &Stretch { watch, from: 0.0, to: 0.76 })?;
    let found_full = find(&full, set, &Stretch { watch, from: 0.76, to: 0.92 })?;
    let without = find(&cases().map(clean), set, &Stretch { watch, from: 0.92, to: 1.0 })?;
    let first = &all[..cases().len()];
    let plain =
        table(Name::TableNoise, "Both faults through noise on the current", first, &found, &of_both(&TABLE_NOISE));
    let rows = plain
        .rows
        .into_iter()
        .enumerate()
        .map(|(i, row)| with_worst_seed(row, found.iter().skip(i).step_by(first.len())));
    let mut table = Table::new(plain.name, plain.title, rows.collect(), plain.notes);
    table.notes.push(format!(
        "White noise of {NOISE_POWER_MA2_S:e} mA² s on the current, before the torque motor. The rows are those of seed 1; beside \
         them stands the estimate of seeds 1 to {SEEDS} that is furthest off. Over all {} traces KGM is off by at most {:.4}, {}.",
        all.len(),
        furthest_off(&all, &found).abs(),
        inconclusive(&found)
    ));
    table.notes.push(format!(
        "The thesis averages 10 000 samples of the noisy current, a trace at 1 kHz has 101 of them. Of the {} traces with the least \
         friction KGM is off by at most {:.4} at 1 kHz, and by at most {:.4} when the same runs are sampled at 100 kHz.",
        full.len(),
        furthest_off(&full, &at_least_friction(&all, &found)).abs(),
        furthest_off(&full, &found_full).abs()
    ));
    let tables = (&TABLE_7_2, &TABLE_NOISE);
    table.claims = vec![
        Claim {
            section: "7.2, noise",
            thesis: "Noise raises the error of KGM by about 2 to 3 points in general",
            why: Some("The mean current is taken from the jack's position too, which the noise hardly reaches"),
            ..mean_errors(KGM, tables, (&without, &found), |before, after| (1.5..=3.5).contains(&(after - before)))
        },
        Claim {
            section: "7.2, noise",
            thesis: "Noise does not visibly change the error of FDJ, but for case 12",
            ..mean_errors(FDJ, tables, (&without, &found), |before, after| after - before < 0.1)
        },
    ];
    Ok(table)
}

/// A row with the estimates that are furthest off among several of the same faults.
fn with_worst_seed<'a>(mut row: Row, seeds: impl Iterator<Item = &'a Found> + Clone) -> Row {
    let furthest = |of: fn(&Pair) -> f64, truth: f64| {
        let all = seeds.clone().filter_map(|found| found.as_ref().ok()).map(of);
        all.max_by(|a, b| (a - truth).abs().total_cmp(&(b - truth).abs()))
    };
    let (kgm, fdj_n) = (furthest(|found| found.0, row.kgm), furthest(|found| found.1, row.fdj_n));
    row.quantities.push(Comparison::estimate("kgm_estimated_worst_seed", None, kgm, row.kgm));
    row.quantities.push(Comparison::estimate("fdj_estimated_worst_seed_n", None, fdj_n, row.fdj_n));
    row
}

fn at_least_friction(cases: &[Case], found: &[Found]) -> Vec<Found> {
    let least_n = super::FDJ_LEVELS_N[0];
    let of = cases.iter().zip(found).filter(|(case, _)| case.faults.1 == least_n);
    of.map(|(_, found)| found.clone()).collect()
}

/// Both faults with a clearance.
pub fn with_clearance(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let tight = cases().map(clean);
    let worn = tight.map(|case| Case { clearance_m: CLEARANCE_M, ..case });
    let found = find(&worn, set, &Stretch { watch, from: 0.0, to: 0.5 })?;
    let without = find(&tight, set, &Stretch { watch, from: 0.5, to: 1.0 })?;
    let title = "Both faults with a worn sleeve";
    let mut table = table(Name::TableClearance, title, &worn, &found, &of_both(&TABLE_CLEARANCE));
    table.notes.push(format!(
        "{:.0} µm more of radial clearance between spool and sleeve, estimated with KGM and FDJ from the whole trace (command, \
         current, pressure, jack position). KGM is off by up to {:+.4}, without the clearance by up to {:+.4}: the holding current \
         after the step tells a leak from a weaker torque motor.",
        CLEARANCE_M * 1e6,
        furthest_off(&worn, &found),
        furthest_off(&tight, &without)
    ));
    let tables = (&TABLE_7_2, &TABLE_CLEARANCE);
    table.claims = vec![
        Claim {
            section: "7.2, clearance",
            thesis: "With the clearance the error of KGM becomes smaller",
            why: Some(
                "The leak is estimated too; the thesis says neither whether its clearance is radial nor whether it is added to the \
                 nominal one",
            ),
            ..mean_errors(KGM, tables, (&without, &found), |before, after| after < before)
        },
        Claim {
            section: "7.2, clearance",
            thesis: "With the clearance the error of FDJ becomes larger",
            why: Some("The pressure 1.1 s after the step follows the friction, whatever leaks"),
            ..mean_errors(FDJ, tables, (&without, &found), |before, after| after > before)
        },
    ];
    Ok(table)
}

/// By how much KGM is off where it is furthest off, with its sign.
fn furthest_off(cases: &[Case], found: &[Found]) -> f64 {
    let off = cases.iter().zip(found).filter_map(|(case, found)| Some(found.as_ref().ok()?.0 - case.faults.0));
    off.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
}

fn inconclusive(found: &[Found]) -> String {
    match found.iter().filter(|found| found.is_err()).count() {
        0 => "and all are conclusive".into(),
        missing => format!("and {missing} are inconclusive"),
    }
}

/// A fault: its name and its place in a pair.
type Fault = (&'static str, fn(&Pair) -> f64);
const KGM: Fault = ("KGM", |pair| pair.0);
const FDJ: Fault = ("FDJ", |pair| pair.1);

/// How the mean error of a fault changes when something is added to the traces; a KGM of 0 has none.
fn mean_errors(
    (name, of): Fault,
    (printed_before, printed_after): (&[Pair; 25], &[Pair; 25]),
    (before, after): (&[Found], &[Found]),
    holds: fn(f64, f64) -> bool,
) -> Claim {
    let mean = |found: &[Found]| {
        let error = |(truth, found): (&Pair, &Found)| {
            let (truth, found) = (of(truth), of(found.as_ref().ok()?));
            (truth != 0.0).then(|| ((found - truth) / truth).abs() * 100.0)
        };
        let errors: Vec<f64> = cases().iter().cycle().zip(found).filter_map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    let [was, became] = [printed_before, printed_after].map(|printed| mean(&printed.map(Ok)));
    let [before, after] = [before, after].map(mean);
    Claim {
        section: "",
        thesis: "",
        ours: format!(
            "The mean error of {name} goes from {before:.3} % to {after:.3} %; in the thesis's tables from {was:.3} % to {became:.3} %."
        ),
        agrees: holds(before, after),
        why: None,
    }
}
