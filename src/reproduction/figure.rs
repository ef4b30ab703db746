//! A figure as data: lines over one common axis.

use std::fmt::Write;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A level, 0 (nominal) to 4: one scale of colours, each with its own dashes.
    Level(usize),
    /// One model beside the other, 0 (reference) or 1 (monitoring).
    Model(usize),
    /// A level of one model: the level's colour, whole for model 0 and dashed for model 1.
    LevelOfModel(usize, usize),
}

/// An axis: values are kept in SI and shown in a unit that reads well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// What stands beside the axis, without the unit.
    pub label: &'static str,
    /// The unit that is shown.
    pub unit: &'static str,
    /// The factor from SI to that unit.
    pub factor: f64,
    /// The name of the quantity in files, SI unit last.
    pub column: &'static str,
}

/// One line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its name in the legend; one without a name is not there.
    pub label: String,
    /// What precedes the quantity's name in its column.
    pub prefix: String,
    /// How it is drawn.
    pub look: Look,
    /// Its values, SI, one for every abscissa; NaN where there is none.
    pub values: Vec<f64>,
}

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The name of its files.
    pub id: String,
    /// The heading that it stands under.
    pub heading: String,
    /// What it shows, with the thesis's number.
    pub caption: String,
    /// What stands before the legend.
    pub legend: &'static str,
    /// Where it is shown only on demand: what the reader asks for.
    pub folded: Option<&'static str>,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is shown of the vertical axis, SI; `None` shows all.
    pub y_limits: Option<(f64, f64)>,
    /// The common abscissae, SI.
    pub abscissae: Vec<f64>,
    /// The lines.
    pub lines: Vec<Line>,
}

impl Figure {
    /// The figure's data as CSV in SI units, a column per line.
    #[must_use]
    pub fn csv(&self) -> String {
        let columns = self.lines.iter().map(|line| format!(",{}_{}", line.prefix, self.y.column));
        let mut text = format!("{}{}\n", self.x.column, columns.collect::<String>());
        for (row, x) in self.abscissae.iter().enumerate() {
            let cells = self
                .lines
                .iter()
                .map(|line| line.values[row])
                .map(|value| if value.is_nan() { ",".to_owned() } else { format!(",{value:.6e}") });
            writeln!(text, "{x}{}", cells.collect::<String>()).expect("a string takes any text");
        }
        text
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A figure with one line for every look.
    pub fn example(values: &[f64]) -> Figure {
        let axis = |label, unit, column| Axis { label, unit, factor: 1e3, column };
        let looks = [Look::Level(0), Look::Level(4), Look::Model(1), Look::LevelOfModel(2, 1)];
        let line =
            |(i, look)| Line { label: format!("<{i}>"), prefix: format!("level_{i}"), look, values: values.to_vec() };
        Figure {
            id: "figure-1".into(),
            heading: "Responses".into(),
            caption: "Cor & <XS>".into(),
            legend: "KGM",
            folded: None,
            y_limits: None,
            x: axis("time", "ms", "time_s"),
            y: axis("current", "mA", "servovalve_current_a"),
            abscissae: (0..values.len()).map(|i| i as f64 * 1e-3).collect(),
            lines: looks.into_iter().enumerate().map(line).collect(),
        }
    }

    #[test]
    fn the_data_are_written_in_si_units_with_a_column_for_every_line() {
        let csv = example(&[0.5, -2e-3]).csv();
        let lines: Vec<&str> = csv.lines().collect();
        assert!(lines[0].starts_with("time_s,level_0_servovalve_current_a,level_1_servovalve_current_a"));
        assert!(example(&[0.5, f64::NAN]).csv().ends_with("0.001,,,,\n"), "what is not there is empty");
        assert_eq!(lines[2], "0.001,-2.000000e-3,-2.000000e-3,-2.000000e-3,-2.000000e-3");
    }
}
