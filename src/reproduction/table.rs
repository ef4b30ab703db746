//! A table: rows of ours beside the thesis's.

use std::collections::BTreeMap;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Name;
use super::claims::Claim;
use super::figure::Figure;

/// One figure beside the thesis's.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What it is, unit last.
    pub quantity: &'static str,
    /// The thesis's, where it prints one.
    pub thesis: Option<f64>,
    /// Ours; `None` when an estimate was inconclusive.
    pub ours: Option<f64>,
    /// How far off ours is, %, without a sign: from the true value for an estimate, else from the thesis's.
    pub error_percent: Option<f64>,
    /// How far off the thesis's estimate is from the true value, %; the outer `None` where it is no estimate.
    pub thesis_error_percent: Option<Option<f64>>,
}

impl Comparison {
    /// A figure that the thesis measured too, or only ours.
    #[must_use]
    pub fn feature(quantity: &'static str, thesis: Option<f64>, ours: f64) -> Self {
        let error_percent = thesis.and_then(|thesis| off_percent(ours, thesis));
        Self { quantity, thesis, ours: Some(ours), error_percent, thesis_error_percent: None }
    }

    /// An estimate of a true value.
    #[must_use]
    pub fn estimate(quantity: &'static str, thesis: Option<f64>, ours: Option<f64>, truth: f64) -> Self {
        let off = |found: Option<f64>| found.and_then(|found| off_percent(found, truth));
        Self { quantity, thesis, ours, error_percent: off(ours), thesis_error_percent: Some(off(thesis)) }
    }
}

/// The thesis's percentage error (section 7.2): how far `found` is from `truth`; none where that is 0.
fn off_percent(found: f64, truth: f64) -> Option<f64> {
    (truth != 0.0).then(|| ((found - truth) / truth).abs() * 100.0)
}

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("thesis", &self.thesis)?;
        map.serialize_entry("ours", &self.ours)?;
        map.serialize_entry("error_percent", &self.error_percent)?;
        if let Some(thesis) = &self.thesis_error_percent {
            map.serialize_entry("thesis_error_percent", thesis)?;
        }
        map.end()
    }
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The heading of the rows that it stands among; empty where the table is one piece.
    pub heading: String,
    /// Its number in the table, from 1.
    pub case: usize,
    /// What else tells the row from others: a heading and a word.
    pub labels: Vec<(&'static str, String)>,
    /// Torque-motor demagnetisation KGM.
    pub kgm: f64,
    /// Dynamic jack friction FDJ, N.
    pub fdj_n: f64,
    /// What is compared.
    pub quantities: Vec<Comparison>,
}

impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("case", &self.case)?;
        for (heading, word) in &self.labels {
            map.serialize_entry(heading, word)?;
        }
        map.serialize_entry("kgm", &self.kgm)?;
        map.serialize_entry("fdj_n", &self.fdj_n)?;
        for comparison in &self.quantities {
            map.serialize_entry(comparison.quantity, comparison)?;
        }
        map.end()
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Which one.
    pub name: Name,
    /// Its heading.
    pub title: &'static str,
    /// Its rows.
    pub rows: Vec<Row>,
    /// The largest error of every quantity that has one, %; `None` where no true value allows one.
    pub max_error_percent: BTreeMap<&'static str, Option<f64>>,
    /// What to know of it.
    pub notes: Vec<String>,
    /// What the thesis says of it, judged.
    pub claims: Vec<Claim>,
    /// Its figures.
    pub figures: Vec<Figure>,
    /// The time that it took, s, where someone measured it.
    pub elapsed_s: Option<f64>,
}

impl Table {
    /// A table of rows, with the largest errors found.
    #[must_use]
    pub fn new(name: Name, title: &'static str, rows: Vec<Row>, notes: Vec<String>) -> Self {
        let mut max_error_percent: BTreeMap<&'static str, Option<f64>> = BTreeMap::new();
        for comparison in rows.iter().flat_map(|row| &row.quantities) {
            if comparison.thesis.is_none() && comparison.thesis_error_percent.is_none() {
                continue;
            }
            let worst = max_error_percent.entry(comparison.quantity).or_default();
            *worst = [*worst, comparison.error_percent].into_iter().flatten().reduce(f64::max);
        }
        let (claims, figures) = (Vec::new(), Vec::new());
        Self { name, title, rows, max_error_percent, notes, claims, figures, elapsed_s: None }
    }

    /// The names of the quantities in the order in which the rows bring them, each once.
    #[must_use]
    pub fn quantities(&self) -> Vec<&'static str> {
        let mut names = Vec::new();
        for comparison in self.rows.iter().flat_map(|row| &row.quantities) {
            if !names.contains(&comparison.quantity) {
                names.push(comparison.quantity);
            }
        }
        names
    }

    /// Every figure of a quantity, down the rows.
    pub fn of<'a>(&'a self, quantity: &'a str) -> impl Iterator<Item = &'a Comparison> {
        self.rows.iter().flat_map(|row| &row.quantities).filter(move |comparison| comparison.quantity == quantity)
    }

    /// By how much the thesis's KGM and ours are off at most, where it was estimated: what the error in per cent does not tell
    /// where the true KGM is small or 0.
    #[must_use]
    pub fn largest_kgm_off(&self, quantity: &str) -> Option<(Option<f64>, f64)> {
        let off = |figure: fn(&Comparison) -> Option<f64>| {
            let of_row = |row: &Row| {
                let estimate = row.quantities.iter().find(|comparison| comparison.quantity == quantity)?;
                Some((figure(estimate)? - row.kgm).abs())
            };
            self.rows.iter().filter_map(of_row).reduce(f64::max)
        };
        Some((off(|comparison| comparison.thesis), off(|comparison| comparison.ours)?))
    }

    /// The largest error of the thesis's estimates of a quantity, %.
    #[must_use]
    pub fn thesis_max_error_percent(&self, quantity: &str) -> Option<f64> {
        self.of(quantity).filter_map(|comparison| comparison.thesis_error_percent.flatten()).reduce(f64::max)
    }
}

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("table", self.name.name())?;
        map.serialize_entry("rows", &self.rows)?;
        map.serialize_entry("max_error_percent", &self.max_error_percent)?;
        map.serialize_entry("elapsed_s", &self.elapsed_s)?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(quantities: Vec<Comparison>) -> Row {
        Row {
            heading: String::new(),
            case: 1,
            labels: vec![("model", "reference".into())],
            kgm: 0.0,
            fdj_n: 200.0,
            quantities,
        }
    }

    #[test]
    fn an_error_is_told_of_the_true_value_or_of_the_thesis_and_none_of_zero() {
        let estimates = [
            Comparison::estimate("fdj_estimated_n", Some(202.0), Some(201.0), 200.0),
            Comparison::estimate("kgm_estimated", Some(0.01), Some(0.002), 0.0),
        ];
        let feature = Comparison::feature("current_ma", Some(10.0), 9.9);
        let alone = Comparison::feature("jack_position_peak_mm", None, 3.0);
        let rows = vec![row(estimates.into_iter().chain([feature, alone]).collect())];
        let table = Table::new(Name::Table72, "title", rows, Vec::new());
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(json["rows"][0]["fdj_estimated_n"]["error_percent"], 0.5);
        assert_eq!(json["rows"][0]["fdj_estimated_n"]["thesis_error_percent"], 1.0);
        assert!(json["rows"][0]["kgm_estimated"]["error_percent"].is_null());
        assert!(json["rows"][0]["current_ma"].get("thesis_error_percent").is_none());
        assert_eq!(json["rows"][0]["model"], "reference");
        let worst = json["max_error_percent"].as_object().unwrap();
        assert_eq!(worst.len(), 3, "{worst:?}");
        assert!((worst["current_ma"].as_f64().unwrap() - 1.0).abs() < 1e-9 && worst["kgm_estimated"].is_null());
        assert_eq!(table.thesis_max_error_percent("fdj_estimated_n"), Some(1.0));
        assert_eq!(table.largest_kgm_off("kgm_estimated"), Some((Some(0.01), 0.002)));
    }

    #[test]
    fn an_estimate_that_is_missing_is_null_and_no_error() {
        let rows = vec![row(vec![Comparison::estimate("fdj_estimated_n", None, None, 200.0)])];
        let table = Table::new(Name::Table72, "title", rows, Vec::new());
        let json = serde_json::to_value(&table).unwrap();
        assert!(json["rows"][0]["fdj_estimated_n"]["ours"].is_null());
        assert!(json["max_error_percent"]["fdj_estimated_n"].is_null() && json["elapsed_s"].is_null());
    }
}
