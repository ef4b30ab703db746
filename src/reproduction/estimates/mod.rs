//! The estimation tables of section 7.2: traces of the reference model, their faults found by the monitoring model.

mod hampered;

pub use hampered::{through_noise, with_clearance};

use super::claims::Claim;
use super::runs::{each, recipe};
use super::table::{Comparison, Row, Table};
use super::thesis::{FDJ_LEVELS_N, KGM_LEVELS, Pair, SINGLE_FDJ_N, SINGLE_KGM, TABLE_7_2, cases};
use super::{Name, ReproductionError};
use crate::estimation::request::Requested;
use crate::estimation::{Settings, estimate};
use crate::models::drive::Drive;
use crate::models::fault::{FDJ_NOMINAL_N, Faults};
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, Simulation, simulate};
use crate::models::trace::{Channel, Trace};
use crate::numeric::watch::Watch;

/// Samples per second of a trace: what a bench or a flight recorder gives, a hundredth of the model's own rate.
const SAMPLE_RATE_HZ: f64 = 1e3;
/// The length of the diagnostic command, s (section 6.3).
const DURATION_S: f64 = 6.0;
/// What a printed bound may be exceeded by through rounding.
const ROUNDING: f64 = 1.0 + 1e-9;
/// One trace to estimate.
#[derive(Debug, Clone, Copy)]
struct Case {
    faults: Pair,
    clearance_m: f64,
    noise_power_ma2_s: f64,
    seed: u64,
    sample_rate_hz: f64,
}

/// What was found in it, or why nothing was.
type Found = Result<Pair, String>;

fn clean(faults: Pair) -> Case {
    Case { faults, clearance_m: 0.0, noise_power_ma2_s: 0.0, seed: 1, sample_rate_hz: SAMPLE_RATE_HZ }
}

/// Makes the traces and estimates their faults, all with the same settings.
fn find(cases: &[Case], set: &ParameterSet, watch: &dyn Watch) -> Result<Vec<Found>, ReproductionError> {
    each(cases, watch, |case, quiet| {
        let Case { faults, clearance_m, noise_power_ma2_s, seed, sample_rate_hz } = *case;
        let plain = recipe(ModelKind::Reference, Drive::Diagnostic, faults, DURATION_S, sample_rate_hz);
        let faults = Faults { clearance_m, ..plain.faults };
        let trace = simulate(&Simulation { faults, noise_power_ma2_s, seed, ..plain }, set, quiet)?;
        // Where the valve leaks the leak is searched too; from what the thesis records, without the spool.
        let faults = if clearance_m > 0.0 { with_clearance_asked() } else { Requested::KGM_AND_FDJ };
        let found = estimate(&without_spool(&trace), set, &Settings { faults, ..Settings::default() }, quiet)?;
        Ok(found.kgm.zip(found.fdj_n).ok_or_else(|| found.reasons.join("; ")))
    })
}

fn with_clearance_asked() -> Requested {
    "kgm,fdj,clearance".parse().expect("these are names of faults")
}

fn without_spool(trace: &Trace) -> Trace {
    let channels = Channel::ALL.into_iter().filter(|channel| *channel != Channel::SpoolPosition);
    let channels = channels.filter_map(|channel| Some((channel, trace.channel(channel)?.to_vec()))).collect();
    Trace::try_new(trace.time_s().to_vec(), channels, Vec::new()).expect("a part of a trace is a trace")
}

/// KGM alone.
pub fn single_kgm(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let cases = KGM_LEVELS.map(|kgm| clean((kgm, FDJ_NOMINAL_N)));
    let found = find(&cases, set, watch)?;
    let thesis = SINGLE_KGM.map(|kgm| (Some(kgm), None));
    let mut table = table(Name::SingleKgm, "Demagnetisation alone", &cases, &found, &thesis);
    table.notes.push(SINGLE.into());
    table.claims = vec![below(
        "The error of KGM is below 1 %, except 1.45 % at KGM 0.4",
        &table,
        ("kgm_estimated", &[1.0, 1.0, 1.0, 1.0, 1.45]),
    )];
    Ok(table)
}

/// FDJ alone.
pub fn single_fdj(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let cases = FDJ_LEVELS_N.map(|fdj_n| clean((0.0, fdj_n)));
    let found = find(&cases, set, watch)?;
    let thesis = SINGLE_FDJ_N.map(|fdj_n| (None, Some(fdj_n)));
    let mut table = table(Name::SingleFdj, "Friction alone", &cases, &found, &thesis);
    table.notes.push(SINGLE.into());
    table.claims =
        vec![below("The error of FDJ is below 0.006 % in all cases", &table, ("fdj_estimated_n", &[0.006; 5]))];
    Ok(table)
}

/// Both faults.
pub fn both(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let cases = cases().map(clean);
    let found = find(&cases, set, watch)?;
    let mut table = table(Name::Table72, "Both faults", &cases, &found, &of_both(&TABLE_7_2));
    table.claims = vec![
        below("The error of KGM is at most 4.7 %", &table, ("kgm_estimated", &[4.7; 25])),
        below("The error of FDJ is at most 1.74 %", &table, ("fdj_estimated_n", &[1.741; 25])),
    ];
    Ok(table)
}

const SINGLE: &str = "The thesis searches this fault with the other one known; ours searches both in every case.";

fn of_both(thesis: &[Pair; 25]) -> [(Option<f64>, Option<f64>); 25] {
    thesis.map(|(kgm, fdj_n)| (Some(kgm), Some(fdj_n)))
}

/// A table of the first traces, one to a row of the thesis.
fn table(
    name: Name,
    title: &'static str,
    cases: &[Case],
    found: &[Found],
    thesis: &[(Option<f64>, Option<f64>)],
) -> Table {
    let row = |(i, (case, (found, thesis)))| {
        let (case, found, thesis): (&Case, &Found, &(Option<f64>, Option<f64>)) = (case, found, thesis);
        let (kgm, fdj_n) = case.faults;
        let ours = found.as_ref().ok();
        Row {
            heading: String::new(),
            case: i + 1,
            labels: Vec::new(),
            kgm,
            fdj_n,
            quantities: vec![
                Comparison::estimate("kgm_estimated", thesis.0, ours.map(|found| found.0), kgm),
                Comparison::estimate("fdj_estimated_n", thesis.1, ours.map(|found| found.1), fdj_n),
            ],
        }
    };
    let rows: Vec<Row> = cases.iter().zip(found.iter().zip(thesis)).enumerate().map(row).collect();
    let Settings { population, generations, seed, .. } = Settings::default();
    let mut notes = vec![format!(
        "Diagnostic command, reference model, {DURATION_S} s at 1 kHz; the faults found with a population of {population} and \
         {generations} generations, seed {seed}, the same for every case."
    )];
    notes.extend(where_there_is_none(&rows));
    for (row, found) in rows.iter().zip(found) {
        if let Err(reasons) = found {
            notes.push(format!("Case {} is inconclusive: {reasons}.", row.case));
        }
    }
    Table::new(name, title, rows, notes)
}

/// What stands for the error of KGM in per cent where the true KGM is 0.
fn where_there_is_none(rows: &[Row]) -> Option<String> {
    let healthy = || rows.iter().filter(|row| row.kgm == 0.0).map(|row| &row.quantities[0]);
    let ours = healthy().filter_map(|kgm| kgm.ours).reduce(f64::max)?;
    let thesis = healthy().filter_map(|kgm| kgm.thesis).reduce(f64::max);
    let thesis = thesis.map_or_else(String::new, |thesis| format!(", in the thesis {thesis:.4}"));
    Some(format!(
        "Where the true KGM is 0 there is no error in per cent; there KGM is found as at most {ours:.4}{thesis}."
    ))
}

/// Whether no error of a quantity is larger than the thesis says, case by case.
fn below(thesis: &'static str, table: &Table, (quantity, most): (&'static str, &[f64])) -> Claim {
    let pairs = || table.of(quantity).zip(most);
    let thesis_holds =
        pairs().all(|(c, &most)| c.thesis_error_percent.flatten().is_none_or(|error| error <= most * ROUNDING));
    let [of_thesis, ours] = [table.thesis_max_error_percent(quantity), table.max_error_percent[quantity]];
    let told = |error: Option<f64>| error.map_or_else(|| "none".into(), |error| format!("{error:.5} %"));
    let slip = if thesis_holds { "" } else { " Its own table does not keep to what it says." };
    Claim {
        section: "7.2",
        thesis,
        ours: format!("At most {}; the thesis's table: {}.{slip}", told(ours), told(of_thesis)),
        agrees: pairs()
            .all(|(c, &most)| c.ours.is_some() && c.error_percent.is_none_or(|error| error <= most * ROUNDING)),
        why: None,
    }
}
