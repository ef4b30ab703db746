//! The characteristic curves and the settling times (sections 3.2, 4.1.3 and chapter 5).

mod drawn;
mod judged;

use super::table::{Comparison, Row, Table};
use super::{Name, ReproductionError};
use crate::characterisation::curves::{CurveModel, Curves, Gains, Series, curves};
use crate::characterisation::settling::{Settling, THESIS_BELL, THESIS_SLOPE_S_PER_M3, TOLERANCE_PA, settling};
use crate::models::fault::FDJ_NOMINAL_N;
use crate::models::parameters::ParameterSet;
use crate::numeric::watch::{Stretch, Watch};

/// Everything that is drawn and judged.
struct Valve {
    curves: Curves,
    settling: Settling,
    /// Supply less return, Pa.
    supply_pa: f64,
}

impl Valve {
    /// A model's pressure curves, a flow each.
    fn pressure(&self, model: CurveModel) -> Vec<&Series> {
        self.curves.pressure.iter().filter(|series| series.model == model).collect()
    }

    /// A model's flow curves, a pressure each.
    fn flow(&self, model: CurveModel) -> Vec<&Series> {
        self.curves.flow.iter().filter(|series| series.model == model).collect()
    }
}

/// Makes the table: the gains, the constants of the settling times, the curves.
pub fn table(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let fluid = &set.reference_model().fluid;
    let valve = Valve {
        curves: curves(set),
        settling: settling(set, &Stretch { watch, from: 0.1, to: 1.0 })?,
        supply_pa: fluid.supply_pressure_pa - fluid.return_pressure_pa,
    };
    let notes = vec![
        format!(
            "The thesis prints its flows as -6 to 6 m³/s, without the power of ten; they are taken as cm³/s, which goes with its \
             4.5e-6 and 3e-6 m³/s. Settled is what stays within {TOLERANCE_PA} Pa of its end."
        ),
        "Of the bell a/(b (XS/XSS)² + c) c is the thesis's 4. The thesis gives a no unit; ours is in s. Its valve's dimensions and its \
         XSS are not printed, so these constants are not expected to be the same: they belong to two valves."
            .into(),
    ];
    let title = "Characteristic curves and settling times (chapters 3 to 5)";
    let mut table = Table::new(Name::Curves, title, rows(&valve), notes);
    table.claims = judged::claims(&valve);
    table.figures = drawn::figures(&valve);
    Ok(table)
}

fn name(model: CurveModel) -> &'static str {
    match model {
        CurveModel::Reference => "reference",
        CurveModel::Linear => "linear",
        CurveModel::Evolved => "evolved",
        CurveModel::Developed => "developed",
    }
}

fn rows(valve: &Valve) -> Vec<Row> {
    let row = |heading: &str, model: &str, quantities| Row {
        heading: heading.into(),
        case: 0,
        labels: vec![("model", model.into())],
        kgm: 0.0,
        fdj_n: FDJ_NOMINAL_N,
        quantities,
    };
    let gains = |gains: &Gains| {
        let quantities = vec![
            Comparison::feature("pressure_gain_pa_per_m", None, gains.pressure_gain_pa_per_m),
            Comparison::feature("flow_gain_m2_per_s", None, gains.flow_gain_m2_per_s),
            Comparison::feature("open_flow_gain_m2_per_s", None, gains.open_flow_gain_m2_per_s),
        ];
        row("Section 3.2: gains at null", name(gains.model), quantities)
    };
    let mut rows: Vec<Row> = valve.curves.gains.iter().map(gains).collect();
    let (bell, growth) = (&valve.settling.bell, &valve.settling.growth);
    let constants = vec![
        Comparison::feature("bell_a", Some(THESIS_BELL[0]), bell.a_s),
        Comparison::feature("bell_b", Some(THESIS_BELL[1]), bell.b),
        Comparison::feature("peak_growth_s_per_m3", Some(THESIS_SLOPE_S_PER_M3), growth.slope_s_per_m3),
    ];
    rows.push(row(SETTLING, "reference", constants));
    for (i, row) in rows.iter_mut().enumerate() {
        row.case = i + 1;
    }
    rows
}

/// The heading of the settling times' row and figures.
const SETTLING: &str = "Section 5.3: settling times of the reference model's valve";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::watch::Unwatched;

    #[test]
    fn the_curves_have_the_thesis_s_figures_and_every_statement_has_a_section_that_is_shown() {
        let table = table(&ParameterSet::reference(), &Unwatched).unwrap();
        for number in ["3.4a", "3.4b", "5.2", "5.5", "5.8", "5.9", "5.10", "5.11", "5.12"] {
            assert!(table.figures.iter().any(|figure| figure.id == format!("figure-{number}")), "{number}");
        }
        for claim in &table.claims {
            let shown = format!("Section {}:", claim.section);
            assert!(table.figures.iter().any(|figure| figure.heading.starts_with(&shown)), "{}", claim.section);
        }
        for figure in &table.figures {
            let points = figure.abscissae.len();
            assert!(points > 50 && figure.lines.len() >= 2, "{}", figure.id);
            assert!(figure.lines.iter().all(|line| line.values.len() == points), "{}", figure.id);
        }
        assert_eq!(table.rows.len(), CurveModel::ALL.len() + 1);
    }
}
