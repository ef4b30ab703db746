//! The bias between the models as a surface over both faults.
//!
//! Source: section 7.2, where it is a constant 0.15 mA; our Table 6.3, where it is a ratio that leaps with the stick-slip.
//! Signs: reference minus monitoring model.
//! Range: KGM 0.02 to 0.62, FDJ 210 to 1990 N.
//! Limits: where a run does not show a feature, the value of the next level with less friction stands for it.
//!
//! No level is one of the thesis's tables', in the surface or in its check. Where the ratio leaps between two frictions, which is
//! where the reference model begins to stick and slip, the interval is halved until it is short. The spread is that of further
//! runs about the surface, for each friction the larger one of the two intervals that it ends, and what the spool's own friction
//! leaves open: a spool at rest stays there while the flapper pushes it less than that holds, so that a quiet run ends anywhere
//! in this range of current. Noise or vibration frees it, so the ratio is taken of runs with as little noise as does so.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::diagnostic::{self, Level, LevelError};
use super::fit::FitError;
use crate::models::monitoring::Model;
use crate::models::monitoring::bias::{Bias, Surface};
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::Watch;

/// Demagnetisations of the surface: beyond the last one the built-in actuator's current saturates.
const KGM: [f64; 5] = [0.02, 0.17, 0.32, 0.47, 0.62];
/// Dynamic frictions of the surface, N, before any interval is halved; no half of an interval is a table's level.
const FDJ_N: [f64; 14] =
    [210.0, 310.0, 410.0, 510.0, 610.0, 710.0, 810.0, 910.0, 1010.0, 1110.0, 1310.0, 1510.0, 1710.0, 1990.0];
/// Demagnetisations of the check, between those of the surface.
const CHECK_KGM: [f64; 3] = [0.09, 0.25, 0.38];
/// Where in each interval of friction the check looks: so an interval with a leap in it shows at least a third of the leap.
const CHECK_PARTS: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// The least change of the ratio between two frictions that is a leap, and the shortest interval that is halved, N.
const LEAP: f64 = 5e-4;
const SHORT_N: f64 = 12.5;
/// How often intervals are halved at most: 280 N become 9 N.
const HALVINGS_MAX: usize = 5;
/// Pressures that differ by more than this part are not of the same creep: the reference model's jack rests or slips.
const SAME_CREEP: f64 = 0.01;
/// Runs that are expected, for the progress.
const RUNS_EXPECTED: f64 = 570.0;

/// What a level shows: the ratio of the currents and the difference of the pressures, Pa.
type Shown = Result<(f64, f64), Option<LevelError>>;

/// The levels of one friction, KGM after KGM.
#[derive(Debug, Clone)]
struct Column {
    fdj_n: f64,
    shown: Vec<Shown>,
}

/// Runs both models at whatever levels are asked for.
struct Runs<'a> {
    set: &'a ParameterSet,
    model: &'a Model,
    watch: &'a dyn Watch,
    done: AtomicUsize,
}

/// Learns the surface from runs of a set's reference model beside a monitoring model with the developed fluid.
///
/// # Errors
/// A reference model that does not show the features at the least friction, or cancellation by `watch`.
pub fn learn(set: &ParameterSet, model: &Model, watch: &dyn Watch) -> Result<Surface, FitError> {
    let runs = Runs { set, model, watch, done: AtomicUsize::new(0) };
    let columns = runs.halved(runs.columns(&FDJ_N)?)?;
    let mut surface = held(&columns)?;
    let (ratio_std, pressure_std_pa) = runs.spreads(&surface)?;
    surface.current_ratio_std = ratio_std;
    surface.load_pressure_std_pa = pressure_std_pa;
    Ok(surface)
}

impl Runs<'_> {
    fn shown(&self, levels: &[Level]) -> Result<Vec<Shown>, FitError> {
        if self.watch.cancelled() {
            return Err(FitError::Cancelled);
        }
        let tell = || {
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            self.watch.progress((done as f64 / RUNS_EXPECTED).min(1.0));
        };
        let reference = diagnostic::reference_each(self.set, levels, tell);
        let freed_a = diagnostic::freed_current_a(self.set, levels, tell);
        let monitoring = diagnostic::monitoring_fast(self.model, levels);
        let compared = reference.into_iter().zip(freed_a).zip(monitoring).map(|((reference, freed_a), own)| {
            let reference = reference.map_err(Some)?;
            let off_pa = reference.load_pressure_pa - own.load_pressure_pa;
            let ratio = freed_a.unwrap_or(reference.servovalve_current_a) / own.servovalve_current_a;
            let comparable = ratio.is_finite() && off_pa.abs() <= SAME_CREEP * own.load_pressure_pa.abs();
            if comparable { Ok((ratio, off_pa)) } else { Err(None) }
        });
        Ok(compared.collect())
    }

    fn columns(&self, fdj_n: &[f64]) -> Result<Vec<Column>, FitError> {
        let levels: Vec<Level> = fdj_n.iter().flat_map(|&fdj_n| KGM.map(|kgm| Level { kgm, fdj_n })).collect();
        let shown = self.shown(&levels)?;
        let columns = fdj_n.iter().zip(shown.chunks(KGM.len()));
        Ok(columns.map(|(&fdj_n, shown)| Column { fdj_n, shown: shown.to_vec() }).collect())
    }

    /// The columns with more of them where the ratio leaps.
    fn halved(&self, mut columns: Vec<Column>) -> Result<Vec<Column>, FitError> {
        for _ in 0..HALVINGS_MAX {
            let long_leaps = columns.windows(2).filter(|pair| {
                let leaps = pair[0]
                    .shown
                    .iter()
                    .zip(&pair[1].shown)
                    .any(|both| matches!(both, (Ok((before, _)), Ok((after, _))) if (after - before).abs() > LEAP));
                leaps && pair[1].fdj_n - pair[0].fdj_n > SHORT_N
            });
            let halves: Vec<f64> = long_leaps.map(|pair| pair[0].fdj_n.midpoint(pair[1].fdj_n)).collect();
            if halves.is_empty() {
                break;
            }
            columns.extend(self.columns(&halves)?);
            columns.sort_by(|a, b| a.fdj_n.total_cmp(&b.fdj_n));
        }
        Ok(columns)
    }

    /// How far further runs are from a surface, for each of its frictions: of the ratio and of the pressure, Pa.
    fn spreads(&self, surface: &Surface) -> Result<(Vec<f64>, Vec<f64>), FitError> {
        let intervals = surface.fdj_n.windows(2);
        let parts = intervals.flat_map(|ends| CHECK_PARTS.map(|part| ends[0] + part * (ends[1] - ends[0])));
        let levels: Vec<Level> = parts.flat_map(|fdj_n| CHECK_KGM.map(|kgm| Level { kgm, fdj_n })).collect();
        let bias = Bias {
            current_ratio: 1.0,
            current_ratio_std: 0.0,
            load_pressure_std_pa: 0.0,
            surface: Some(surface.clone()),
        };
        let off = |(level, shown): (&Level, Shown)| {
            let (ratio, pressure_pa) = shown.ok()?;
            let known = bias.at(level.kgm, level.fdj_n);
            Some((ratio - known.current_ratio, pressure_pa - known.load_pressure_pa))
        };
        let off: Vec<Option<(f64, f64)>> = levels.iter().zip(self.shown(&levels)?).map(off).collect();
        let per_interval = CHECK_KGM.len() * CHECK_PARTS.len();
        let spread = |of: fn(&(f64, f64)) -> f64| -> Vec<f64> {
            at_ends(
                &off.chunks(per_interval).map(|off| root_mean_square(off.iter().flatten().map(of))).collect::<Vec<_>>(),
            )
        };
        let open = self.left_open(&surface.fdj_n);
        let ratio_std =
            spread(|off| off.0).into_iter().zip(open).map(|(std, open)| rounded(std.hypot(open), RATIO_DIGITS));
        let ratio_std = ratio_std.collect();
        let pressure_std = spread(|off| off.1).into_iter().map(|std| rounded(std, PRESSURE_DIGITS)).collect();
        Ok((ratio_std, pressure_std))
    }
}

impl Runs<'_> {
    /// The standard deviation of the ratio, for each friction, that comes of the spool's static friction FSS: it holds while
    /// ASV GPF XF is less, which is (KF + KSF) FSS / (ASV GPF GM (1 - KGM)) of current on either side, evenly.
    fn left_open(&self, fdj_n: &[f64]) -> Vec<f64> {
        let own = self.set.reference_model();
        let (spool, flapper) = (&own.second_stage, &own.first_stage);
        let held_m = spool.friction_static_n / (spool.end_area_m2 * spool.pressure_gain_pa_per_m);
        let stiffness_n_per_m = flapper.armature_stiffness_n_per_m + flapper.feedback_spring_stiffness_n_per_m;
        let kgm = KGM[0];
        let gain_n_per_a = self.set.shared().torque_motor.force_gain_n_per_a * (1.0 - kgm);
        let held_a = stiffness_n_per_m * held_m / gain_n_per_a;
        let levels: Vec<Level> = fdj_n.iter().map(|&fdj_n| Level { kgm, fdj_n }).collect();
        let modelled = diagnostic::monitoring_fast(self.model, &levels);
        modelled.iter().map(|features| held_a / features.servovalve_current_a / 3f64.sqrt()).collect()
    }
}

/// More decimals of a ratio, and of a pressure in Pa, are not known.
const RATIO_DIGITS: i32 = 6;
const PRESSURE_DIGITS: i32 = 1;

fn rounded(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powi(digits);
    (value * unit).round() / unit
}

/// A surface without its spreads. A level that shows nothing takes the value of the one with less friction.
fn held(columns: &[Column]) -> Result<Surface, FitError> {
    let first = &columns[0].shown;
    let errors: Vec<LevelError> = first.iter().filter_map(|shown| shown.clone().err().flatten()).collect();
    if !errors.is_empty() {
        return Err(FitError::Levels(errors));
    }
    if first.iter().any(Result::is_err) {
        let reason = "at the least friction the pressures of the two models differ by more than 1 %";
        return Err(FitError::NoValue { parameter: "monitoring.bias.surface", reason });
    }
    let row = |row: usize, of: fn(&(f64, f64)) -> f64, digits: i32| -> Vec<f64> {
        let keep = |last: &mut f64, column: &Column| {
            *last = column.shown[row].as_ref().map_or(*last, |shown| rounded(of(shown), digits));
            Some(*last)
        };
        columns.iter().scan(f64::NAN, keep).collect()
    };
    let rows = |of, digits| (0..KGM.len()).map(|at| row(at, of, digits)).collect();
    Ok(Surface {
        kgm: KGM.to_vec(),
        fdj_n: columns.iter().map(|column| column.fdj_n).collect(),
        current_ratio: rows(|shown| shown.0, RATIO_DIGITS),
        load_pressure_difference_pa: rows(|shown| shown.1, PRESSURE_DIGITS),
        current_ratio_std: vec![0.0; columns.len()],
        load_pressure_std_pa: vec![0.0; columns.len()],
    })
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    let squares: Vec<f64> = values.map(|value| value * value).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// From intervals to their ends: the larger one of the two beside each. An interval of which nothing is known counts as the widest.
fn at_ends(intervals: &[Option<f64>]) -> Vec<f64> {
    let widest = intervals.iter().flatten().copied().fold(0.0, f64::max);
    let of = |at: usize| intervals.get(at).map(|spread| spread.unwrap_or(widest));
    (0..=intervals.len())
        .map(|end| of(end).into_iter().chain(end.checked_sub(1).and_then(of)).fold(0.0, f64::max))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_level_is_one_of_the_thesis_s_tables() {
        let in_tables = |fdj_n: f64| fdj_n % 200.0 == 0.0 && fdj_n <= 1000.0;
        assert!(KGM.iter().chain(&CHECK_KGM).all(|kgm| ![0.0, 0.1, 0.2, 0.3, 0.4].contains(kgm)));
        for ends in FDJ_N.windows(2) {
            let parts = (0..=64).map(|part| ends[0] + (ends[1] - ends[0]) * f64::from(part) / 64.0);
            assert!(
                parts
                    .chain(CHECK_PARTS.map(|part| ends[0] + part * (ends[1] - ends[0])))
                    .all(|fdj_n| !in_tables(fdj_n))
            );
        }
    }

    #[test]
    fn a_level_that_shows_nothing_takes_what_less_friction_shows_and_the_least_must_show_something() {
        let column = |fdj_n, ratio| Column { fdj_n, shown: vec![ratio; KGM.len()] };
        let columns = [column(300.0, Ok((1.01, 5.0))), column(400.0, Err(None)), column(500.0, Ok((1.03, 7.0)))];
        let surface = held(&columns).unwrap();
        assert_eq!(surface.current_ratio[2], [1.01, 1.01, 1.03]);
        assert_eq!(surface.load_pressure_difference_pa[4], [5.0, 5.0, 7.0]);
        assert!(matches!(held(&columns[1..]), Err(FitError::NoValue { .. })));
    }

    #[test]
    fn an_end_has_the_larger_spread_of_its_two_intervals() {
        assert_eq!(at_ends(&[Some(1.0), Some(3.0), Some(2.0)]), [1.0, 3.0, 3.0, 2.0]);
        assert_eq!(at_ends(&[Some(1.0), None, Some(2.0)]), [1.0, 2.0, 2.0, 2.0]);
    }
}
