//! A trace: what was recorded of an actuator, or what a model made, in SI units and already checked.

use std::collections::BTreeMap;

use thiserror::Error;

/// The fewest samples that a trace may have.
pub const SAMPLES_MIN: usize = 10;
/// The most samples that a trace may have: ten minutes at 10 kHz.
pub const SAMPLES_MAX: usize = 6_000_000;
/// The longest time that a trace may cover, s.
pub const DURATION_MAX_S: f64 = 600.0;
/// A time step this many times the median one is a gap. Uneven sampling below it is fine.
pub const GAP_RATIO: f64 = 10.0;

/// A quantity that elevon understands. Its column is named after it with the SI unit last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Commanded jack position (Com), m.
    PositionCommand,
    /// Current in the torque motor (Cor), A.
    ServovalveCurrent,
    /// Pressure in chamber 1 minus pressure in chamber 2 (P12), Pa.
    LoadPressure,
    /// Jack position as measured (XJ), m.
    JackPosition,
    /// Jack velocity (DXJ), m/s.
    JackVelocity,
    /// Spool position (XS), m.
    SpoolPosition,
    /// External load on the jack, N, positive against a positive velocity.
    ExternalLoad,
    /// Absolute supply pressure (PS), Pa.
    SupplyPressure,
}

impl Channel {
    /// Every channel, in the order in which columns are written.
    pub const ALL: [Self; 8] = [
        Self::PositionCommand,
        Self::ServovalveCurrent,
        Self::LoadPressure,
        Self::JackPosition,
        Self::JackVelocity,
        Self::SpoolPosition,
        Self::ExternalLoad,
        Self::SupplyPressure,
    ];

    /// The name of the channel's column, unit last.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::PositionCommand => "position_command_m",
            Self::ServovalveCurrent => "servovalve_current_a",
            Self::LoadPressure => "load_pressure_pa",
            Self::JackPosition => "jack_position_m",
            Self::JackVelocity => "jack_velocity_m_per_s",
            Self::SpoolPosition => "spool_position_m",
            Self::ExternalLoad => "external_load_n",
            Self::SupplyPressure => "supply_pressure_pa",
        }
    }
}

/// What is wrong with a trace as a whole. `row` counts samples from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TraceError {
    /// A column that every trace needs is not there.
    #[error("column {column} is missing")]
    Missing {
        /// The column's SI name.
        column: String,
    },
    /// A column is longer or shorter than the time.
    #[error("column {column} has {found} values, expected {expected} as time_s has")]
    Length {
        /// The column's name.
        column: String,
        /// Its number of values.
        found: usize,
        /// The number of times.
        expected: usize,
    },
    /// A value is not a finite number.
    #[error("column {column}, sample {row}: found {found}, expected a finite number")]
    NotFinite {
        /// The column's name.
        column: String,
        /// The sample.
        row: usize,
        /// The value.
        found: f64,
    },
    /// Time stands still or runs backwards.
    #[error("column time_s, sample {row}: found {found} after {previous}, expected a later time")]
    NotRising {
        /// The sample.
        row: usize,
        /// Its time, s.
        found: f64,
        /// The time before it, s.
        previous: f64,
    },
    /// Samples are missing.
    #[error(
        "column time_s, sample {row}: found a gap of {found} s, expected steps near the median of {median} s (at most {GAP_RATIO} times)"
    )]
    Gap {
        /// The first sample after the gap.
        row: usize,
        /// The gap's length, s.
        found: f64,
        /// The median step, s.
        median: f64,
    },
    /// Too few samples.
    #[error("found {found} samples, expected at least {min}")]
    TooShort {
        /// The number of samples.
        found: usize,
        /// The fewest allowed.
        min: usize,
    },
    /// Too long a time.
    #[error("found a trace of {found} s, expected at most {DURATION_MAX_S} s")]
    TooLate {
        /// The time from the first sample to the last, s.
        found: f64,
    },
    /// Too many samples.
    #[error("found {found} samples, expected at most {SAMPLES_MAX}")]
    TooLong {
        /// The number of samples.
        found: usize,
    },
}

/// A recording with one common time axis. It cannot exist unless its times rise, every value is finite, all
/// columns are equally long and the channels that an estimation needs are there.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    time_s: Vec<f64>,
    channels: BTreeMap<Channel, Vec<f64>>,
    extra: Vec<(String, Vec<f64>)>,
}

impl Trace {
    /// Checks and keeps a recording. `extra` holds columns that elevon does not interpret, under their own names.
    ///
    /// # Errors
    /// Every fault that was found, in the order of the columns; never empty.
    pub fn try_new(
        time_s: Vec<f64>,
        channels: BTreeMap<Channel, Vec<f64>>,
        extra: Vec<(String, Vec<f64>)>,
    ) -> Result<Self, Vec<TraceError>> {
        let named = channels.iter().map(|(channel, values)| (channel.column(), values.as_slice()));
        let extras = extra.iter().map(|(name, values)| (name.as_str(), values.as_slice()));
        let mut errors = check_samples(&time_s, named.chain(extras));
        if !channels.contains_key(&Channel::PositionCommand) {
            errors.push(TraceError::Missing { column: Channel::PositionCommand.column().into() });
        }
        if !channels.contains_key(&Channel::ServovalveCurrent) && !channels.contains_key(&Channel::LoadPressure) {
            errors.push(TraceError::Missing {
                column: format!("{} or {}", Channel::ServovalveCurrent.column(), Channel::LoadPressure.column()),
            });
        }
        if errors.is_empty() { Ok(Self { time_s, channels, extra }) } else { Err(errors) }
    }

    /// The times of the samples, s, rising.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// The samples of a channel in SI units, or `None` when it was not recorded.
    #[must_use]
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(&channel).map(Vec::as_slice)
    }

    /// The commanded position, m: every trace has it.
    #[must_use]
    pub fn position_command_m(&self) -> &[f64] {
        &self.channels[&Channel::PositionCommand]
    }

    /// The number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.time_s.len()
    }

    /// The time from the first sample to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.time_s[self.time_s.len() - 1] - self.time_s[0]
    }

    /// Every column in the order in which it is written: time, the known channels, the others.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &[f64])> {
        let time = std::iter::once(("time_s", self.time_s.as_slice()));
        let known = self.channels.iter().map(|(channel, values)| (channel.column(), values.as_slice()));
        let extra = self.extra.iter().map(|(name, values)| (name.as_str(), values.as_slice()));
        time.chain(known).chain(extra)
    }
}

/// What is wrong with samples over a common time axis: their number, the times, a column's length or values.
#[must_use]
pub fn check_samples<'a>(time_s: &[f64], columns: impl Iterator<Item = (&'a str, &'a [f64])>) -> Vec<TraceError> {
    check_with(time_s, columns, SAMPLES_MIN, check_times)
}

/// What is wrong with samples that are to act on a model: as [`check_samples`], but two suffice, and a gap is a stretch without
/// a bend.
#[must_use]
pub fn check_input<'a>(time_s: &[f64], columns: impl Iterator<Item = (&'a str, &'a [f64])>) -> Vec<TraceError> {
    check_with(time_s, columns, 2, check_rising)
}

fn check_with<'a>(
    time_s: &[f64],
    columns: impl Iterator<Item = (&'a str, &'a [f64])>,
    min: usize,
    times: fn(&[f64]) -> Option<TraceError>,
) -> Vec<TraceError> {
    let times = match time_s.len() {
        found if found < min => Some(TraceError::TooShort { found, min }),
        found if found > SAMPLES_MAX => Some(TraceError::TooLong { found }),
        _ => times(time_s),
    };
    let columns = columns.filter_map(|(column, values)| check_column(column, values, time_s.len()));
    times.into_iter().chain(columns).collect()
}

/// The first fault of a time axis: a value that is not finite, a step that is not positive, a gap, too long a time.
fn check_times(time_s: &[f64]) -> Option<TraceError> {
    if let Some(error) = check_rising(time_s) {
        return Some(error);
    }
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    if let Some(at) = time_s.windows(2).position(|pair| pair[1] - pair[0] > GAP_RATIO * median) {
        return Some(TraceError::Gap { row: at + 1, found: time_s[at + 1] - time_s[at], median });
    }
    let found = time_s[time_s.len() - 1] - time_s[0];
    (found > DURATION_MAX_S).then_some(TraceError::TooLate { found })
}

/// The first time that is not finite or does not rise.
fn check_rising(time_s: &[f64]) -> Option<TraceError> {
    check_column("time_s", time_s, time_s.len()).or_else(|| {
        let at = time_s.windows(2).position(|pair| pair[1] <= pair[0])?;
        Some(TraceError::NotRising { row: at + 1, found: time_s[at + 1], previous: time_s[at] })
    })
}

/// The first fault of one column.
fn check_column(column: &str, values: &[f64], expected: usize) -> Option<TraceError> {
    if values.len() != expected {
        return Some(TraceError::Length { column: column.into(), found: values.len(), expected });
    }
    let row = values.iter().position(|value| !value.is_finite())?;
    Some(TraceError::NotFinite { column: column.into(), row, found: values[row] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace_with_times(time_s: Vec<f64>) -> Result<Trace, Vec<TraceError>> {
        let n = time_s.len();
        let channels = [Channel::PositionCommand, Channel::ServovalveCurrent].map(|c| (c, vec![0.0; n]));
        Trace::try_new(time_s, channels.into(), Vec::new())
    }

    fn even(n: usize) -> Vec<f64> {
        (0..n).map(|i| i as f64 * 1e-3).collect()
    }

    #[test]
    fn uneven_times_are_fine_and_a_gap_is_named_by_its_sample() {
        let mut time_s = even(50);
        time_s[20] += 0.4e-3;
        assert!(trace_with_times(time_s.clone()).is_ok());
        time_s.iter_mut().skip(30).for_each(|t| *t += 1.0);
        let errors = trace_with_times(time_s).unwrap_err();
        assert!(matches!(errors[..], [TraceError::Gap { row: 30, .. }]), "{errors:?}");
    }

    #[test]
    fn a_trace_that_covers_too_long_a_time_is_refused() {
        let errors = trace_with_times((0..100).map(|i| f64::from(i) * 10.0).collect()).unwrap_err();
        assert_eq!(errors, [TraceError::TooLate { found: 990.0 }]);
    }

    #[test]
    fn falling_duplicate_and_non_finite_times_are_refused() {
        for (bad, row) in [(0.009, 10), (0.0, 10), (f64::NAN, 10)] {
            let mut time_s = even(20);
            time_s[10] = bad;
            let text = trace_with_times(time_s).unwrap_err()[0].to_string();
            assert!(text.contains(&format!("sample {row}")), "{text}");
        }
    }

    #[test]
    fn every_faulty_column_is_reported_at_once() {
        let channels = [(Channel::JackPosition, vec![f64::INFINITY; 20]), (Channel::SpoolPosition, vec![0.0; 3])];
        let errors = Trace::try_new(even(20), channels.into(), Vec::new()).unwrap_err();
        assert_eq!(errors.len(), 4, "{errors:?}");
    }
}
