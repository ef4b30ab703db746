//! Table 6.3: the two features at every pair of faults.

use super::claims::Claim;
use super::runs::{each, recipe, values};
use super::table::{Comparison, Row, Table};
use super::thesis::{FDJ_LEVELS_N, TABLE_6_3, cases};
use super::{Name, ReproductionError};
use crate::models::drive::Drive;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, simulate};
use crate::models::trace::Channel;
use crate::numeric::statistics::{mean_between, range, window};
use crate::numeric::watch::Watch;

/// The model's own rate, as the thesis's means over its samples are.
const SAMPLE_RATE_HZ: f64 = 1e5;
/// Up to the end of the pressure's window.
const DURATION_S: f64 = 5.11;
/// The end of the ramp, s, where the current is steady.
const RAMP_S: (f64, f64) = (1.8, 1.9);
/// 1.1 s after the step, s.
const STEP_S: (f64, f64) = (5.09, 5.11);

/// What one pair of faults shows.
struct Steady {
    current_ma: f64,
    pressure_kpa: f64,
    /// Between the least and the greatest current, mA.
    oscillation_ma: f64,
}

/// Makes the table.
pub fn table(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let cases = cases();
    let found = each(&cases, watch, |&faults, quiet| {
        let trace =
            simulate(&recipe(ModelKind::Reference, Drive::Diagnostic, faults, DURATION_S, SAMPLE_RATE_HZ), set, quiet)?;
        let current_a = values(&trace, Channel::ServovalveCurrent);
        let mean = |values, (from_s, to_s)| {
            mean_between(trace.time_s(), values, from_s, to_s).expect("the run covers both windows")
        };
        Ok(Steady {
            current_ma: mean(current_a, RAMP_S) * 1e3,
            pressure_kpa: mean(values(&trace, Channel::LoadPressure), STEP_S) * 1e-3,
            oscillation_ma: range(&current_a[window(trace.time_s(), RAMP_S.0, RAMP_S.1)]) * 1e3,
        })
    })?;
    let rows = found.iter().zip(cases).zip(TABLE_6_3).enumerate();
    let rows = rows.map(|(i, ((ours, (kgm, fdj_n)), thesis))| Row {
        heading: String::new(),
        case: i + 1,
        labels: Vec::new(),
        kgm,
        fdj_n,
        quantities: vec![
            Comparison::feature("current_ma", Some(thesis.0), ours.current_ma),
            Comparison::feature("pressure_kpa", Some(thesis.1), ours.pressure_kpa),
        ],
    });
    let notes = vec![
        "Reference model, diagnostic command, sampled at 100 kHz. Current: mean over 1.8 to 1.9 s of the ramp; pressure: mean \
         over 20 ms around 1.1 s after the step. The thesis prints the pressure as MPa; it is kPa."
            .into(),
    ];
    let mut table =
        Table::new(Name::Table63, "Steady current and pressure at 25 pairs of faults", rows.collect(), notes);
    table.claims = vec![oscillation(&found), separation(&found)];
    Ok(table)
}

/// How much a current must swing to be called an oscillation, as a part of the swing at the largest friction.
const VISIBLE: f64 = 0.1;

fn oscillation(found: &[Steady]) -> Claim {
    let largest = |level: usize| found.iter().skip(level).step_by(5).map(|s| s.oscillation_ma).fold(0.0, f64::max);
    let levels: [f64; 5] = std::array::from_fn(largest);
    let visible = levels.map(|swing_ma| swing_ma > VISIBLE * levels[4]);
    let told = levels.iter().zip(FDJ_LEVELS_N).map(|(ma, n)| format!("{ma:.3} at {n} N")).collect::<Vec<_>>();
    Claim {
        section: "6.3",
        thesis: "Above 600 N of friction the current oscillates a little, and a mean is taken",
        ours: format!("The largest swing of the steady current over KGM, mA: {}.", told.join(", ")),
        agrees: visible == [false, false, false, true, true],
        why: None,
    }
}

fn separation(found: &[Steady]) -> Claim {
    let change = |from: f64, to: f64| (to / from - 1.0).abs() * 100.0;
    let (mut own, mut other) = ([f64::INFINITY; 2], [0.0_f64; 2]);
    for level in 0..5 {
        // Along FDJ at one level of KGM, and along KGM at one level of FDJ.
        let (over_fdj, over_kgm) = ((&found[5 * level], &found[5 * level + 4]), (&found[level], &found[20 + level]));
        own[0] = own[0].min(change(over_kgm.0.current_ma, over_kgm.1.current_ma));
        own[1] = own[1].min(change(over_fdj.0.pressure_kpa, over_fdj.1.pressure_kpa));
        other[0] = other[0].max(change(over_fdj.0.current_ma, over_fdj.1.current_ma));
        other[1] = other[1].max(change(over_kgm.0.pressure_kpa, over_kgm.1.pressure_kpa));
    }
    Claim {
        section: "6.3",
        thesis: "Neither fault influences significantly the quantity that was chosen for the other",
        ours: format!(
            "From the least fault to the largest the current grows by {:.1} % with KGM and changes by at most {:.1} % with FDJ; \
             the pressure grows by {:.0} % with FDJ and changes by at most {:.1} % with KGM. Whoever took the current alone \
             would still read the largest friction as a KGM of {:.3}.",
            own[0],
            other[0],
            own[1],
            other[1],
            1.0 - found[0].current_ma / found[4].current_ma
        ),
        agrees: other[0] < 0.1 * own[0] && other[1] < 0.1 * own[1],
        why: None,
    }
}
