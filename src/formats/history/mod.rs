//! Histories of a fault, from which its remaining life is forecast: usage, value and standard deviation.
//!
//! CSV holds one history under a header line, JSON one or many (see [`read`]).

mod json;
mod text;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::errors::FormatErrors;
use super::{Format, FormatError, text as text_of};

/// The way a fault's value moves as the damage grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Larger is worse.
    Rising,
    /// Smaller is worse.
    Falling,
}

/// What usage counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UsageUnit {
    /// Hours of flight.
    FlightHours,
    /// Flights.
    FlightCycles,
}

/// What a file says of a question, for all its histories or for one of them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// The value at which life ends.
    pub threshold: Option<f64>,
    /// The way from healthy to the threshold.
    pub direction: Option<Direction>,
    /// The value when new.
    pub healthy: Option<f64>,
    /// The usage at which this life began.
    pub life_start: Option<f64>,
    /// What usage counts.
    pub unit: Option<UsageUnit>,
}

/// The usages at which a forecast is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum At {
    /// One, of a history that stands alone.
    One(f64),
    /// Any number, in the order of the file.
    Many(Vec<f64>),
}

/// A history of one fault. Its usage never falls; all its numbers are finite.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Its name: a text or a number; in a batch its place, from 0, unless told.
    pub id: Option<Value>,
    /// What is asked of it, where the file says so of it alone.
    pub asked: Asked,
    /// The usage of each observation.
    pub usage: Vec<f64>,
    /// The value of each observation.
    pub value: Vec<f64>,
    /// The standard deviation of each observation, 0 or more, where it has one; as many as there are observations.
    pub std: Vec<Option<f64>>,
    /// The usages at which a forecast is asked.
    pub at: Option<At>,
    /// The usage at which life ended, where that is known.
    pub end_of_life: Option<f64>,
    places: Places,
}

/// A file of histories.
#[derive(Debug, Clone, PartialEq)]
pub struct Histories {
    /// What is asked of all of them.
    pub asked: Asked,
    /// The histories.
    pub histories: Vec<History>,
    /// Whether the file is a batch, or one history that stands alone.
    pub batch: bool,
}

/// Where the parts of a history are in its file.
#[derive(Debug, Clone, PartialEq)]
enum Places {
    /// The line of the header and of each observation; the names of the columns of usage, value and standard deviation.
    Lines { header: u64, observations: Vec<u64>, names: [String; 3] },
    /// The pointer to the history; the names of its arrays.
    Pointer { history: String, names: [&'static str; 3] },
}

/// One of the three figures of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Its usage.
    Usage,
    /// Its value.
    Value,
    /// Its standard deviation.
    Std,
}

impl History {
    /// Where a figure of an observation, counted from 0, is in the file.
    #[must_use]
    pub fn place_of(&self, figure: Figure, observation: usize) -> String {
        match &self.places {
            Places::Lines { header, observations, names } => {
                let line = observations.get(observation).unwrap_or(header);
                super::csv::at(*line, &names[figure as usize])
            }
            Places::Pointer { history, names } => format!("{history}/{}/{observation}", names[figure as usize]),
        }
    }

    /// Where a field of the history is in the file, or would be; its name where the format has no place for it.
    #[must_use]
    pub fn place_of_field(&self, name: &str) -> String {
        match &self.places {
            Places::Lines { .. } => name.to_owned(),
            Places::Pointer { history, .. } => format!("{history}/{name}"),
        }
    }

    /// Adds every observation whose usage falls or whose standard deviation is below 0.
    fn check(&self, faults: &mut FormatErrors) {
        let falls = |pair: &[f64]| pair[1] < pair[0];
        for (before, pair) in self.usage.windows(2).enumerate().filter(|(_, pair)| falls(pair)) {
            faults.add(
                || self.place_of(Figure::Usage, before + 1),
                || format!("found {}, expected {} or more: usage does not fall", pair[1], pair[0]),
            );
        }
        for (i, std) in self.std.iter().enumerate().filter_map(|(i, std)| Some((i, (*std)?))) {
            if std < 0.0 {
                faults.add(|| self.place_of(Figure::Std, i), || format!("found {std}, expected 0 or more"));
            }
        }
    }
}

/// Reads histories.
///
/// CSV: a header line, then rows of numbers. Usage is the column `usage`, `flight_hours`, `flight_cycles` or `t`; the
/// value is `value`, `kgm`, `fdj_n` or `h`; the standard deviation, which may be missing or empty, is `std`, `value_std`,
/// `kgm_std` or `fdj_n_std`. Other columns are not looked at.
///
/// JSON: `{"usage": [...], "value": [...], "std"?: [...], "at"?: number or [...]}`, or a batch of such objects with their
/// `id`: `{"histories": [...]}`. `threshold`, `direction`, `healthy`, `life_start` and `unit` may be said of all of them
/// or of each; the latter comes first. `eol` is the end of life where it is known. `t`, `h` and `cuts` are other names of
/// `usage`, `value` and `at`; the usages of `cuts` may have labels, as in an object. Other fields are not looked at.
///
/// # Errors
/// Everything that is wrong with the file, as far as reading could go on; never empty. After 20 errors comes one that
/// counts the others.
pub fn read(format: Format, bytes: &[u8]) -> Result<Histories, Vec<FormatError>> {
    let text = text_of(bytes, "a history")?;
    let histories = match format {
        Format::Csv => text::read(text)?,
        Format::Json => json::read(text)?,
    };
    let mut faults = FormatErrors::default();
    for history in &histories.histories {
        history.check(&mut faults);
    }
    faults.into_result().map(|()| histories)
}

#[cfg(test)]
mod tests;
