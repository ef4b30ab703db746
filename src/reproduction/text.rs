//! A table for a terminal, and the words that it shares with the page.

use super::claims::Claim;
use super::table::{Comparison, Row, Table};

/// A column of a grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// The quantity that it shares with its neighbours; empty where it stands alone.
    pub group: String,
    /// Its own heading.
    pub name: String,
    /// Its cells, a row each.
    pub cells: Vec<String>,
}

/// The quantities' names as people read them: the first word is set apart from what follows it.
const NAMES: [(&str, &str); 14] = [
    ("current_ma", "Cor, mA"),
    ("pressure_kpa", "P12, kPa"),
    ("kgm_estimated", "KGM"),
    ("fdj_estimated_n", "FDJ, N"),
    ("kgm_std", "standard deviation of KGM"),
    ("fdj_std_n", "standard deviation of FDJ, N"),
    ("kgm_estimated_worst_seed", "KGM, worst seed"),
    ("fdj_estimated_worst_seed_n", "FDJ, worst seed, N"),
    ("pressure_gain_pa_per_m", "pressure gain GP, Pa/m"),
    ("flow_gain_m2_per_s", "flow gain GQ at null, m²/s"),
    ("open_flow_gain_m2_per_s", "flow gain from 0.1 to 0.6 mm, m²/s"),
    ("bell_a", "bell a"),
    ("bell_b", "bell b"),
    ("peak_growth_s_per_m3", "growth of the peak, s/m³"),
];
/// The estimates of KGM, whose error is told without per cent too.
pub const KGM: [&str; 2] = ["kgm_estimated", "kgm_estimated_worst_seed"];
/// How the names of the responses' quantities begin and end, and what stands there for people.
const BEGIN: [(&str, &str); 5] = [
    ("current_", "Cor "),
    ("jack_velocity_", "DXJ "),
    ("pressure_", "P12 "),
    ("jack_position_", "XJ "),
    ("spool_position_", "XS "),
];
const END: [(&str, &str); 4] = [("_ma", ", mA"), ("_m_per_s", ", m/s"), ("_mpa", ", MPa"), ("_mm", ", mm")];

/// A quantity's name as people read it.
#[must_use]
pub fn named(quantity: &str) -> String {
    if let Some((_, name)) = NAMES.iter().find(|(known, _)| *known == quantity) {
        return (*name).into();
    }
    let (mut name, mut unit) = (quantity.to_owned(), "");
    if let Some((rest, shown)) = END.iter().find_map(|(end, shown)| Some((name.strip_suffix(end)?.to_owned(), shown))) {
        (name, unit) = (rest, *shown);
    }
    for (begin, symbol) in BEGIN {
        if let Some(rest) = name.strip_prefix(begin) {
            return format!("{symbol}{}{unit}", rest.replace('_', " "));
        }
    }
    format!("{}{unit}", name.replace('_', " "))
}

/// A number with as many digits as tell something; a dash where there is none.
#[must_use]
pub fn number(value: Option<f64>) -> String {
    match value {
        None => "–".into(),
        Some(v) if v.abs() >= 1e5 => format!("{v:.4e}"),
        Some(v) if v.abs() >= 100.0 => format!("{v:.3}"),
        Some(v) => format!("{v:.4}"),
    }
}

/// An error in per cent; a dash where there is none.
#[must_use]
pub fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.3}"))
}

/// Text that is safe between tags and in attributes.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The largest errors of a table: the quantity, the thesis's, where it estimated it too, and ours.
#[must_use]
pub fn largest_errors(table: &Table) -> Vec<(&'static str, Option<f64>, Option<f64>)> {
    let quantities = table.quantities().into_iter();
    quantities
        .filter_map(|quantity| {
            let ours = table.max_error_percent.get(quantity)?;
            ours.map(|ours| (quantity, table.thesis_max_error_percent(quantity), Some(ours)))
        })
        .collect()
}

/// The columns of rows under one heading. A label that is the same in all of them is left out: the heading says it.
#[must_use]
pub fn columns(rows: &[Row]) -> Vec<Column> {
    let in_group = |group: &str, name: &str, cell: &dyn Fn(&Row) -> String| Column {
        group: group.into(),
        name: name.into(),
        cells: rows.iter().map(cell).collect(),
    };
    let of = |name: &str, cell: &dyn Fn(&Row) -> String| in_group("", name, cell);
    let mut columns: Vec<Column> = vec![of("case", &|row| row.case.to_string())];
    for (at, (name, first)) in rows[0].labels.iter().enumerate() {
        if rows.iter().any(|row| row.labels[at].1 != *first) {
            columns.push(of(name, &|row| row.labels[at].1.clone()));
        }
    }
    columns.push(of("KGM", &|row| row.kgm.to_string()));
    columns.push(of("FDJ, N", &|row| row.fdj_n.to_string()));
    for (at, Comparison { quantity, thesis_error_percent, .. }) in rows[0].quantities.iter().enumerate() {
        let name = named(quantity);
        let is_estimate = thesis_error_percent.is_some();
        let has_thesis = rows.iter().any(|row| row.quantities[at].thesis.is_some());
        let mut push = |own: &str, cell: &dyn Fn(&Comparison) -> String| {
            let cell = |row: &Row| row.quantities.get(at).map_or_else(String::new, cell);
            columns.push(if is_estimate || has_thesis { in_group(&name, own, &cell) } else { of(&name, &cell) });
        };
        if has_thesis {
            push("thesis", &|c| number(c.thesis));
        }
        push("ours", &|c| number(c.ours));
        if is_estimate && has_thesis {
            push("thesis error %", &|c| percent(c.thesis_error_percent.flatten()));
        }
        if is_estimate || has_thesis {
            push("our error %", &|c| percent(c.error_percent));
        }
    }
    columns
}

/// The table with its heading, notes and statements.
#[must_use]
pub fn told(table: &Table) -> String {
    let mut lines = vec![format!("{}: {}", table.name.name(), table.title), String::new()];
    for rows in table.rows.chunk_by(|a, b| a.heading == b.heading && same_quantities(a, b)) {
        if !rows[0].heading.is_empty() {
            lines.push(rows[0].heading.clone());
        }
        lines.extend(aligned(&columns(rows)));
        lines.push(String::new());
    }
    for (quantity, thesis, ours) in largest_errors(table) {
        let thesis = thesis.map_or_else(String::new, |error| format!("; the thesis's {error:.3} %"));
        lines.push(format!("Largest error of {}: {} %{thesis}", named(quantity), percent(ours)));
    }
    for quantity in KGM {
        if let Some((thesis, ours)) = table.largest_kgm_off(quantity) {
            let thesis = thesis.map_or_else(String::new, |off| format!("; the thesis's by {off:.4}"));
            lines.push(format!("{} is off by at most {ours:.4}{thesis}", named(quantity)));
        }
    }
    lines.extend(table.notes.iter().cloned());
    lines.extend(table.claims.iter().map(judged));
    lines.join("\n") + "\n\n"
}

/// Whether two rows can stand in one grid.
#[must_use]
pub fn same_quantities(a: &Row, b: &Row) -> bool {
    a.quantities.iter().map(|c| c.quantity).eq(b.quantities.iter().map(|c| c.quantity))
}

fn judged(claim: &Claim) -> String {
    let verdict = if claim.agrees { "agrees" } else { "differs" };
    let why = claim.why.filter(|_| !claim.agrees).map_or_else(String::new, |why| format!(" Why: {why}."));
    format!("{} {verdict}. The thesis: {}. Ours: {}{why}", claim.section, claim.thesis, claim.ours)
}

/// Columns beside each other, ranged right; a heading of several words takes several lines.
fn aligned(columns: &[Column]) -> Vec<String> {
    let words = |column: &'_ Column| format!("{} {}", column.group, column.name);
    let headings: Vec<String> = columns.iter().map(words).collect();
    let headings: Vec<Vec<&str>> = headings.iter().map(|heading| heading.split_whitespace().collect()).collect();
    let height = headings.iter().map(Vec::len).max().unwrap_or(0);
    let width = |at: usize| {
        let cells = columns[at].cells.iter().map(|cell| cell.chars().count());
        headings[at].iter().map(|word| word.chars().count()).chain(cells).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let line = |cell: &dyn Fn(usize) -> String| {
        let cells = widths.iter().enumerate().map(|(at, width)| format!("{:>width$}", cell(at)));
        cells.collect::<Vec<_>>().join("  ")
    };
    let heading = |row: usize| line(&|at| (*headings[at].get(row).unwrap_or(&"")).to_owned());
    let rows = columns.first().map_or(0, |column| column.cells.len());
    (0..height).map(heading).chain((0..rows).map(|row| line(&|at| columns[at].cells[row].clone()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::Name;

    #[test]
    fn quantities_are_named_as_people_read_them() {
        let shown =
            ["kgm_estimated", "pressure_kpa", "jack_velocity_peak_m_per_s", "spool_position_steady_mm"].map(named);
        assert_eq!(shown, ["KGM", "P12, kPa", "DXJ peak, m/s", "XS steady, mm"]);
    }

    #[test]
    fn a_table_is_told_with_its_columns_under_their_headings_and_its_largest_errors() {
        let quantities = vec![Comparison::estimate("kgm_estimated", Some(0.11), None, 0.1)];
        let labels = vec![("model", "reference".to_owned())];
        let row = Row { heading: "Section 7".into(), case: 1, labels, kgm: 0.1, fdj_n: 200.0, quantities };
        let found = Comparison::estimate("kgm_estimated", Some(0.11), Some(0.101), 0.1);
        let other = Row { case: 2, quantities: vec![found], ..row.clone() };
        let mut table = Table::new(Name::Table72, "Both faults", vec![row, other], vec!["A note.".into()]);
        let (section, thesis, ours) = ("7.2", "It is small", "It is.".into());
        table.claims.push(Claim { section, thesis, ours, agrees: false, why: Some("Because") });
        let expected = "table-7.2: Both faults\n\nSection 7\n\
                        case  KGM  FDJ,     KGM     KGM     KGM    KGM\n\
                        \u{20}             N  thesis    ours  thesis    our\n\
                        \u{20}                                 error  error\n\
                        \u{20}                                     %      %\n\
                        \u{20}  1  0.1   200  0.1100       –  10.000      –\n\
                        \u{20}  2  0.1   200  0.1100  0.1010  10.000  1.000\n\n\
                        Largest error of KGM: 1.000 %; the thesis's 10.000 %\n\
                        KGM is off by at most 0.0010; the thesis's by 0.0100\nA note.\n\
                        7.2 differs. The thesis: It is small. Ours: It is. Why: Because.\n\n";
        assert_eq!(told(&table), expected);
    }
}
