//! From named columns of numbers to a trace, for every format.

use std::collections::{BTreeMap, HashMap};

use super::errors::{FormatErrors, clip, only};
use super::names::{COMMAND, CURRENT, KNOWN, LOAD_PRESSURE, Meaning, Role, TIME, accepted, accepted_for, meaning};
use super::{FormatError, ReadOptions};
use crate::models::trace::{Channel, GAP_RATIO, TraceError};
use crate::units::Unit;

/// The most columns that a file may have.
const COLUMNS_MAX: usize = 1000;
/// The most names of a file's columns that an error lists.
const NAMES_SHOWN_MAX: usize = 20;

/// What a file is read for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    /// To estimate faults from it.
    Measurement,
    /// To let one of its columns act on a model.
    Input(Channel),
}

/// What the columns of a file hold, in SI units.
pub(super) struct Contents {
    pub(super) time_s: Vec<f64>,
    pub(super) channels: BTreeMap<Channel, Vec<f64>>,
    pub(super) others: Vec<(String, Vec<f64>)>,
}

/// What is made of a file's contents.
pub(super) type Make<T> = fn(Contents) -> Result<T, Vec<TraceError>>;

/// How a format names places.
pub(super) trait Places {
    /// The place of all column names.
    fn names(&self) -> String;
    /// The place of a column, by its name in the file.
    fn column(&self, name: &str) -> String;
    /// The place of a value, by its column's name in the file and its sample, counted from 0.
    fn value(&self, name: &str, row: usize) -> String;
}

/// A column of a file: its name there, what it means, and its unit if that is known.
struct Column {
    name: String,
    role: Role,
    unit: Option<Unit>,
}

/// The columns of a file, in its order.
pub(super) struct Columns {
    columns: Vec<Column>,
    sample_rate_hz: Option<f64>,
}

impl Columns {
    /// Finds what the columns of a file are. Adds every name that is doubled or has a wrong unit, every option that
    /// does not fit the file, and every column that is missing, to `faults`.
    pub(super) fn resolve(
        names: Vec<String>,
        options: &ReadOptions,
        purpose: Purpose,
        places: &impl Places,
        faults: &mut FormatErrors,
    ) -> Self {
        let map = check_map(&names, options, faults);
        let mut columns: Vec<Column> = Vec::with_capacity(names.len());
        let mut first: HashMap<Role, usize> = HashMap::new();
        for name in names {
            let known_name = map.get(name.as_str()).copied().unwrap_or(&name);
            let (role, unit) = match meaning(known_name) {
                Meaning::Known(role, unit) => (role, Some(unit)),
                Meaning::UnknownUnit(role, stem, units) => {
                    let detail = || format!("found {}, expected {}", clip(known_name), accepted(stem, units));
                    faults.add(|| places.column(&name), detail);
                    (role, None)
                }
                Meaning::Unknown => (Role::Other(name.clone()), None),
            };
            match first.get(&role) {
                Some(&other) => {
                    let other = clip(&columns[other].name);
                    let what = role.column();
                    let detail = || format!("found a second column for {}, expected only {other}", clip(what));
                    faults.add(|| places.column(&name), detail);
                }
                None => _ = first.insert(role.clone(), columns.len()),
            }
            columns.push(Column { name, role, unit });
        }
        let columns = Self { columns, sample_rate_hz: options.sample_rate_hz };
        columns.check_presence(purpose, places, faults);
        columns
    }

    /// The number of columns.
    pub(super) fn len(&self) -> usize {
        self.columns.len()
    }

    /// A column's name in the file.
    pub(super) fn name(&self, column: usize) -> &str {
        &self.columns[column].name
    }

    fn find(&self, role: &Role) -> Option<usize> {
        self.columns.iter().position(|column| column.role == *role)
    }

    fn check_presence(&self, purpose: Purpose, places: &impl Places, faults: &mut FormatErrors) {
        let has = |role: &Role| self.find(role).is_some();
        let mut missing = |what: String| faults.add(|| places.names(), || what);
        if !has(&TIME) && self.sample_rate_hz.is_none() {
            missing(format!("found no time, expected {}, or the option sample_rate_hz", accepted_for(&TIME)));
        }
        if let Purpose::Input(channel) = purpose {
            let role = Role::Channel(channel);
            if !has(&role) {
                missing(format!("found no {}, expected {}", role.column(), accepted_for(&role)));
            }
            return;
        }
        if !has(&COMMAND) {
            missing(format!("found no commanded position, expected {}", accepted_for(&COMMAND)));
        }
        let (ports, load_pressure) = ([1, 2].map(|port| has(&Role::Port(port))), has(&LOAD_PRESSURE));
        if !has(&CURRENT) && !load_pressure && ports == [false, false] {
            missing(format!(
                "found neither current nor load pressure, expected {}, or {}",
                accepted_for(&CURRENT),
                accepted_for(&LOAD_PRESSURE)
            ));
        }
        for (port, other) in [(1, 2), (2, 1)] {
            if !load_pressure && !ports[port - 1] && ports[other - 1] {
                missing(format!(
                    "found the pressure in port {other} alone, expected {} beside it",
                    accepted_for(&Role::Port(port))
                ));
            }
        }
    }

    /// Makes something of the columns' numbers, which come in the same order.
    ///
    /// # Errors
    /// Columns of different lengths, or what is wrong with the numbers as a whole, by place in the file; never empty.
    pub(super) fn into<T>(
        self,
        data: Vec<Vec<f64>>,
        make: Make<T>,
        places: &impl Places,
    ) -> Result<T, Vec<FormatError>> {
        let samples = self.check_lengths(&data, places)?;
        let mut time_s = None;
        let mut channels = BTreeMap::new();
        let mut others = Vec::new();
        let mut ports = [None, None];
        for (column, mut values) in self.columns.iter().zip(data) {
            if let Some(unit) = column.unit {
                values.iter_mut().for_each(|value| *value = unit.to_si(*value));
            }
            match column.role {
                Role::Time => time_s = Some(values),
                Role::Channel(channel) => _ = channels.insert(channel, values),
                Role::Port(_) | Role::Other(_) => {
                    if let Role::Port(port) = column.role {
                        ports[port - 1] = Some(others.len());
                    }
                    others.push((column.role.column().to_owned(), values));
                }
            }
        }
        if let [Some(one), Some(two)] = ports {
            let difference = || others[one].1.iter().zip(&others[two].1).map(|(one, two)| one - two).collect();
            channels.entry(Channel::LoadPressure).or_insert_with(difference);
        }
        let rate = self.sample_rate_hz.unwrap_or(f64::NAN);
        let time_s = time_s.unwrap_or_else(|| (0..samples).map(|k| k as f64 / rate).collect());
        make(Contents { time_s, channels, others }).map_err(|errors| self.locate(errors, places))
    }

    /// The number of samples, which every column must have.
    fn check_lengths(&self, data: &[Vec<f64>], places: &impl Places) -> Result<usize, Vec<FormatError>> {
        let guide = self.find(&TIME).or_else(|| self.find(&COMMAND)).unwrap_or_default();
        let expected = data.get(guide).map_or(0, Vec::len);
        let mut faults = FormatErrors::default();
        for (column, values) in self.columns.iter().zip(data).filter(|(_, values)| values.len() != expected) {
            let (found, guide) = (values.len(), clip(self.name(guide)));
            let detail = || format!("found {found} values, expected {expected} as {guide} has");
            faults.add(|| places.column(&column.name), detail);
        }
        faults.into_result().map(|()| expected)
    }

    /// Says what is wrong with a trace in terms of the file.
    fn locate(&self, errors: Vec<TraceError>, places: &impl Places) -> Vec<FormatError> {
        let mut faults = FormatErrors::default();
        for error in errors {
            let (place, detail) = match &error {
                TraceError::NotFinite { column, row, found } => (
                    self.place(column, *row, places),
                    format!("found {found:?} after conversion to SI units, expected a finite number"),
                ),
                TraceError::NotRising { row, found, previous } => (
                    self.place("time_s", *row, places),
                    format!("found {found:?} s after {previous:?} s, expected a later time"),
                ),
                TraceError::Gap { row, found, median } => (
                    self.place("time_s", *row, places),
                    format!(
                        "found a gap of {:?} s, expected at most {GAP_RATIO} times the median step of {:?} s",
                        rounded(*found),
                        rounded(*median)
                    ),
                ),
                TraceError::Missing { .. } | TraceError::Length { .. } => (places.names(), error.to_string()),
                TraceError::TooShort { .. } | TraceError::TooLong { .. } | TraceError::TooLate { .. } => {
                    ("file".into(), error.to_string())
                }
            };
            faults.add(|| place, || detail);
        }
        faults.into_errors()
    }

    /// The place of a value of a trace's column. What has no column of its own stems from the sample rate or port 1.
    fn place(&self, trace_column: &str, row: usize, places: &impl Places) -> String {
        let find = |name| self.columns.iter().find(|column| column.role.column() == name);
        let derived = || find(Role::Port(1).column()).filter(|_| trace_column == LOAD_PRESSURE.column());
        find(trace_column)
            .or_else(derived)
            .map_or_else(|| "sample_rate_hz".into(), |column| places.value(&column.name, row))
    }
}

/// Refuses a file with so many columns that looking at each would take long.
pub(super) fn check_number(names: &[String], places: &impl Places) -> Result<(), Vec<FormatError>> {
    match names.len() {
        found if found > COLUMNS_MAX => {
            Err(only(places.names(), format!("found {found} columns, expected at most {COLUMNS_MAX}")))
        }
        _ => Ok(()),
    }
}

/// A number with six digits, enough for a person.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// The column map of the options, after a look at whether its names, and the sample rate, can be right.
fn check_map<'a>(names: &[String], options: &'a ReadOptions, faults: &mut FormatErrors) -> HashMap<&'a str, &'a str> {
    if let Some(rate) = options.sample_rate_hz.filter(|rate| !rate.is_finite() || *rate <= 0.0) {
        faults.add(|| "sample_rate_hz".into(), || format!("found {rate:?}, expected a finite number above 0"));
    }
    let mut map = HashMap::new();
    for (from, to) in &options.columns {
        let mut fault = |detail: String| faults.add(|| "columns".into(), || detail);
        if !names.contains(from) {
            let names = names.iter().take(NAMES_SHOWN_MAX).map(|name| clip(name)).collect::<Vec<_>>().join(", ");
            fault(format!("found no column {} in the file, expected one of {names}", clip(from)));
        }
        if matches!(meaning(to), Meaning::Unknown) {
            let known = KNOWN.map(|(_, role, _)| role.column().to_owned()).join(", ");
            fault(format!("found {} for {}, expected one of {known}, or with another unit", clip(to), clip(from)));
        }
        if map.insert(from.as_str(), to.as_str()).is_some() {
            fault(format!("found {} twice, expected every column once", clip(from)));
        }
    }
    map
}
