//! The known difference between the two models' features, and how well it is known.
//!
//! Source: section 7.2 takes a constant 0.15 mA; in its own Table 6.3 the current times (1 - KGM) is constant, so here it is a
//! ratio, which moreover follows the faults where the other model sticks and slips.
//! Signs: differences are the detailed model's feature minus this model's.
//! Range: any faults; beyond the surface's edges its values there hold.
//! Limits: known for the diagnostic ramp of 0.1 m/s and step of 0.1 m.

use serde::{Deserialize, Serialize};

use crate::models::checks::{Checks, ParamsError};

/// The most levels on one axis of a surface (chosen).
const LEVELS_MAX: usize = 200;
/// The ranges of a ratio, of its standard deviation, and of a pressure difference, Pa, or its standard deviation.
const RATIO: (f64, f64) = (0.5, 2.0);
const RATIO_STD: (f64, f64) = (0.0, 0.5);
const PRESSURE_PA: f64 = 1e6;

/// The known difference between the two models' features, with its spread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bias {
    /// Steady current of the reference model over this model's, dimensionless; a mean over the fault levels.
    pub current_ratio: f64,
    /// Standard deviation of that ratio over the fault levels.
    pub current_ratio_std: f64,
    /// Standard deviation of the difference of the pressure features, Pa.
    pub load_pressure_std_pa: f64,
    /// What takes the place of these three where the difference was learnt level by level.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<Surface>,
}

/// The difference over levels of both faults. Between levels it is bilinear; beyond the first and the last it stays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// Demagnetisations KGM of the levels, rising.
    pub kgm: Vec<f64>,
    /// Dynamic frictions FDJ of the levels, N, rising.
    pub fdj_n: Vec<f64>,
    /// Steady current of the reference model over this model's: for each KGM a row over FDJ.
    pub current_ratio: Vec<Vec<f64>>,
    /// Load pressure after the step of the reference model minus this model's, Pa: for each KGM a row over FDJ.
    pub load_pressure_difference_pa: Vec<Vec<f64>>,
    /// Standard deviation of the ratio about the surface, for each FDJ.
    pub current_ratio_std: Vec<f64>,
    /// Standard deviation of the pressure difference about the surface, Pa, for each FDJ.
    pub load_pressure_std_pa: Vec<f64>,
}

/// The difference at one pair of faults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Steady current of the reference model over this model's, dimensionless.
    pub current_ratio: f64,
    /// Its standard deviation.
    pub current_ratio_std: f64,
    /// Load pressure after the step of the reference model minus this model's, Pa.
    pub load_pressure_pa: f64,
    /// Its standard deviation, Pa.
    pub load_pressure_std_pa: f64,
}

impl Bias {
    /// The difference at a demagnetisation KGM and a dynamic friction FDJ, N.
    #[must_use]
    pub fn at(&self, kgm: f64, fdj_n: f64) -> Difference {
        self.surface.as_ref().map_or(
            Difference {
                current_ratio: self.current_ratio,
                current_ratio_std: self.current_ratio_std,
                load_pressure_pa: 0.0,
                load_pressure_std_pa: self.load_pressure_std_pa,
            },
            |surface| surface.at(kgm, fdj_n),
        )
    }

    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("monitoring.bias.current_ratio", self.current_ratio, RATIO.0, RATIO.1, "");
        checks.within("monitoring.bias.current_ratio_std", self.current_ratio_std, RATIO_STD.0, RATIO_STD.1, "");
        checks.within("monitoring.bias.load_pressure_std_pa", self.load_pressure_std_pa, 0.0, PRESSURE_PA, "Pa");
        if let Some(surface) = &self.surface {
            surface.check(checks);
        }
    }
}

impl Surface {
    fn at(&self, kgm: f64, fdj_n: f64) -> Difference {
        let (row, down) = place(&self.kgm, kgm);
        let (column, along) = place(&self.fdj_n, fdj_n);
        let on = |values: &[f64]| values[column] + along * (values[column + 1] - values[column]);
        let over = |rows: &[Vec<f64>]| {
            let (above, below) = (on(&rows[row]), on(&rows[row + 1]));
            above + down * (below - above)
        };
        Difference {
            current_ratio: over(&self.current_ratio),
            current_ratio_std: on(&self.current_ratio_std),
            load_pressure_pa: over(&self.load_pressure_difference_pa),
            load_pressure_std_pa: on(&self.load_pressure_std_pa),
        }
    }

    fn check(&self, checks: &mut Checks) {
        axis(checks, "monitoring.bias.surface.kgm", &self.kgm, 0.0, 1.0, "");
        axis(checks, "monitoring.bias.surface.fdj_n", &self.fdj_n, 0.0, 1e6, "N");
        let (rows, columns) = (self.kgm.len(), self.fdj_n.len());
        let ratio = "monitoring.bias.surface.current_ratio";
        sized(checks, ratio, rows, &sizes(&self.current_ratio), columns);
        all(checks, ratio, self.current_ratio.iter().flatten(), RATIO, "");
        let pressure = "monitoring.bias.surface.load_pressure_difference_pa";
        sized(checks, pressure, rows, &sizes(&self.load_pressure_difference_pa), columns);
        let values = self.load_pressure_difference_pa.iter().flatten();
        all(checks, pressure, values, (-PRESSURE_PA, PRESSURE_PA), "Pa");
        let ratio_std = "monitoring.bias.surface.current_ratio_std";
        sized(checks, ratio_std, 1, &[self.current_ratio_std.len()], columns);
        all(checks, ratio_std, self.current_ratio_std.iter(), RATIO_STD, "");
        let pressure_std = "monitoring.bias.surface.load_pressure_std_pa";
        sized(checks, pressure_std, 1, &[self.load_pressure_std_pa.len()], columns);
        all(checks, pressure_std, self.load_pressure_std_pa.iter(), (0.0, PRESSURE_PA), "Pa");
    }
}

/// The interval of a rising axis that holds a value, or is nearest to it, and the part of it that lies before the value.
fn place(axis: &[f64], value: f64) -> (usize, f64) {
    let interval = axis.partition_point(|&level| level <= value).clamp(1, axis.len() - 1) - 1;
    let (low, high) = (axis[interval], axis[interval + 1]);
    (interval, ((value - low) / (high - low)).clamp(0.0, 1.0))
}

/// An axis has two levels or more, in their range and rising.
fn axis(checks: &mut Checks, name: &'static str, levels: &[f64], min: f64, max: f64, unit: &'static str) {
    all(checks, name, levels.iter(), (min, max), unit);
    let (found, expected) = if (2..=LEVELS_MAX).contains(&levels.len()) {
        let Some(pair) = levels.windows(2).find(|pair| pair[1] <= pair[0]) else { return };
        (format!("{} after {}", pair[1], pair[0]), "rising levels".into())
    } else {
        (format!("{} levels", levels.len()), format!("2 to {LEVELS_MAX}"))
    };
    checks.refuse(ParamsError::Unreadable { name: name.into(), found, expected });
}

fn sizes(rows: &[Vec<f64>]) -> Vec<usize> {
    rows.iter().map(Vec::len).collect()
}

/// As many rows as levels of KGM, each as long as there are levels of FDJ.
fn sized(checks: &mut Checks, name: &'static str, rows: usize, found: &[usize], columns: usize) {
    if found.len() == rows && found.iter().all(|&size| size == columns) {
        return;
    }
    let odd = found.iter().find(|&&size| size != columns).copied().unwrap_or(columns);
    let rows_of = |rows: usize, columns: usize| match rows {
        1 => format!("{columns} values"),
        rows => format!("{rows} rows of {columns} values"),
    };
    let (found, expected) = (rows_of(found.len(), odd), rows_of(rows, columns));
    checks.refuse(ParamsError::Unreadable { name: name.into(), found, expected });
}

/// The range of every value: the first one out of it is told.
fn all<'a>(
    checks: &mut Checks,
    name: &'static str,
    mut values: impl Iterator<Item = &'a f64>,
    (min, max): (f64, f64),
    unit: &'static str,
) {
    let odd = values.find(|value| !(min..=max).contains(*value)).copied();
    checks.within(name, odd.unwrap_or(min), min, max, unit);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain() -> Bias {
        Bias { current_ratio: 1.01, current_ratio_std: 0.002, load_pressure_std_pa: 50.0, surface: None }
    }

    fn surface() -> Surface {
        Surface {
            kgm: vec![0.1, 0.3],
            fdj_n: vec![300.0, 500.0, 900.0],
            current_ratio: vec![vec![1.0, 1.2, 1.2], vec![1.1, 1.3, 1.5]],
            load_pressure_difference_pa: vec![vec![10.0, 20.0, 20.0], vec![-10.0, 0.0, 40.0]],
            current_ratio_std: vec![0.01, 0.02, 0.04],
            load_pressure_std_pa: vec![5.0, 5.0, 9.0],
        }
    }

    fn refusals(surface: Surface) -> Vec<String> {
        let mut checks = Checks::default();
        Bias { surface: Some(surface), ..plain() }.check(&mut checks);
        checks.into_parts().0.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn without_a_surface_the_difference_is_the_plain_ratio_everywhere() {
        let here = plain().at(0.7, 1500.0);
        assert_eq!(
            (here.current_ratio, here.current_ratio_std, here.load_pressure_pa, here.load_pressure_std_pa),
            (1.01, 0.002, 0.0, 50.0)
        );
    }

    #[test]
    fn a_surface_gives_its_own_values_at_its_levels_and_means_between_them() {
        let bias = Bias { surface: Some(surface()), ..plain() };
        let near = |one: f64, other: f64| assert!((one - other).abs() < 1e-12, "{one} {other}");
        near(bias.at(0.3, 900.0).current_ratio, 1.5);
        near(bias.at(0.1, 300.0).load_pressure_pa, 10.0);
        near(bias.at(0.2, 400.0).current_ratio, 1.15);
        near(bias.at(0.2, 400.0).load_pressure_pa, 5.0);
        near(bias.at(0.2, 700.0).current_ratio_std, 0.03);
        near(bias.at(0.2, 600.0).load_pressure_std_pa, 6.0);
    }

    #[test]
    fn beyond_its_edges_a_surface_keeps_the_values_that_it_has_there() {
        let bias = Bias { surface: Some(surface()), ..plain() };
        assert_eq!(bias.at(0.0, 200.0), bias.at(0.1, 300.0));
        assert_eq!(bias.at(1.0, 2000.0), bias.at(0.3, 900.0));
    }

    #[test]
    fn axes_that_do_not_rise_sizes_that_differ_and_values_out_of_range_are_refused() {
        assert!(refusals(surface()).is_empty());
        let told = |change: fn(&mut Surface)| {
            let mut changed = surface();
            change(&mut changed);
            refusals(changed).join("; ")
        };
        let of = "monitoring.bias.surface.";
        assert_eq!(told(|s| s.fdj_n[1] = 300.0), format!("{of}fdj_n: found 300 after 300, expected rising levels"));
        assert_eq!(
            told(|s| {
                s.current_ratio[1].pop();
            }),
            format!("{of}current_ratio: found 2 rows of 2 values, expected 2 rows of 3 values")
        );
        assert_eq!(
            told(|s| s.current_ratio[1][2] = f64::NAN),
            format!("{of}current_ratio: found NaN, expected 0.5 to 2")
        );
        assert_eq!(
            told(|s| s.load_pressure_std_pa.push(1.0)),
            format!("{of}load_pressure_std_pa: found 4 values, expected 3 values")
        );
        let short = told(|s| s.kgm.truncate(1));
        assert!(
            short.starts_with(&format!("{of}kgm: found 1 levels, expected 2 to 200; {of}current_ratio: found 2 rows")),
            "{short}"
        );
    }
}
