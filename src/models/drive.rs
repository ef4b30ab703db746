//! Commands: what the jack is told to do, as a function of time.

use std::f64::consts::TAU;
use std::str::FromStr;

use thiserror::Error;

/// The most that a position in a command may be, m.
const POSITION_MAX_M: f64 = 10.0;

/// A commanded position over time. Commands start at t = 0 with zero phase.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// The thesis's diagnostic command (section 6.3): a ramp of 0.1 m/s for 2 s, zero to 4 s, then 0.1 m.
    Diagnostic,
    /// A constant position from t = 0 on.
    Step {
        /// The position, m.
        level_m: f64,
    },
    /// A constant velocity from t = 0 on.
    Ramp {
        /// The velocity, m/s.
        slope_m_per_s: f64,
    },
    /// A sine.
    Sine {
        /// Semi-amplitude, m.
        amplitude_m: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// Levels held one after the other.
    Sequence {
        /// (from this time on in s, position in m), times rising from 0 or later; zero before the first.
        levels: Vec<(f64, f64)>,
    },
}

/// Why a command could not be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("command: found {found:?}, expected {expected}")]
pub struct DriveError {
    /// The part that could not be read.
    pub found: String,
    /// What would have been right.
    pub expected: &'static str,
}

impl Drive {
    /// The commanded position at a time, m.
    #[must_use]
    pub fn position_m(&self, time_s: f64) -> f64 {
        match self {
            Self::Diagnostic if time_s < 2.0 => 0.1 * time_s,
            Self::Diagnostic if time_s < 4.0 => 0.0,
            Self::Diagnostic => 0.1,
            Self::Step { level_m } => *level_m,
            Self::Ramp { slope_m_per_s } => slope_m_per_s * time_s,
            Self::Sine { amplitude_m, frequency_hz } => amplitude_m * (TAU * frequency_hz * time_s).sin(),
            Self::Sequence { levels } => {
                let passed = levels.partition_point(|&(from_s, _)| from_s <= time_s);
                passed.checked_sub(1).map_or(0.0, |last| levels[last].1)
            }
        }
    }
}

impl FromStr for Drive {
    type Err = DriveError;

    /// Reads `diagnostic`, `step:0.1`, `ramp:0.1`, `sine:0.2@5` or `sequence:0.1@0,-0.05@0.5` (level@time); m, m/s, Hz, s.
    fn from_str(text: &str) -> Result<Self, DriveError> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        match kind {
            "diagnostic" if rest.is_empty() => Ok(Self::Diagnostic),
            "step" => Ok(Self::Step { level_m: number(rest, POSITION_MAX_M)? }),
            "ramp" => Ok(Self::Ramp { slope_m_per_s: number(rest, POSITION_MAX_M)? }),
            "sine" => {
                let (amplitude_m, frequency_hz) = pair(rest)?;
                Ok(Self::Sine { amplitude_m, frequency_hz })
            }
            "sequence" => sequence(rest),
            _ => Err(DriveError {
                found: text.into(),
                expected: "diagnostic, step:LEVEL, ramp:SLOPE, sine:AMPLITUDE@HZ or sequence:LEVEL@TIME,...",
            }),
        }
    }
}

/// Levels and their times, which must rise.
fn sequence(text: &str) -> Result<Drive, DriveError> {
    let levels = text
        .split(',')
        .map(|part| pair(part).map(|(level_m, from_s)| (from_s, level_m)))
        .collect::<Result<Vec<_>, _>>()?;
    if levels.windows(2).any(|two| two[1].0 <= two[0].0) {
        return Err(DriveError { found: text.into(), expected: "levels at rising times" });
    }
    Ok(Drive::Sequence { levels })
}

/// Two numbers around an `@`; the second must not be negative.
fn pair(text: &str) -> Result<(f64, f64), DriveError> {
    let (first, second) =
        text.split_once('@').ok_or(DriveError { found: text.into(), expected: "two numbers around an @" })?;
    let second_number = number(second, 1e4)?;
    if second_number < 0.0 {
        return Err(DriveError { found: second.into(), expected: "a number of at least 0 after the @" });
    }
    Ok((number(first, POSITION_MAX_M)?, second_number))
}

/// A finite number of at most this magnitude.
fn number(text: &str, magnitude_max: f64) -> Result<f64, DriveError> {
    let value: f64 = text
        .trim()
        .parse()
        .map_err(|_| DriveError { found: text.into(), expected: "a number with a decimal point" })?;
    if value.abs() <= magnitude_max {
        Ok(value)
    } else {
        Err(DriveError { found: text.into(), expected: "at most 10 m or m/s, and 10000 Hz or s, in magnitude" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, times_s: &[f64]) -> Vec<f64> {
        let drive: Drive = text.parse().unwrap();
        times_s.iter().map(|&t| drive.position_m(t)).collect()
    }

    #[test]
    fn validate_section_6_3_the_diagnostic_command_is_a_ramp_a_return_and_a_step() {
        assert_eq!(at("diagnostic", &[0.0, 1.0, 2.0, 3.999, 4.0, 6.0]), [0.0, 0.1, 0.0, 0.0, 0.1, 0.1]);
    }

    #[test]
    fn every_command_is_read_and_starts_at_zero_time() {
        assert_eq!(at("step:0.1", &[0.0, 5.0]), [0.1, 0.1]);
        assert_eq!(at("ramp:-0.1", &[0.0, 5.0]), [0.0, -0.5]);
        assert_eq!(at("sine:0.2@5", &[0.0, 0.05]), [0.0, 0.2]);
        assert_eq!(at("sequence:0.1@0,-0.05@0.5", &[0.0, 0.499, 0.5, 9.0]), [0.1, 0.1, -0.05, -0.05]);
        assert_eq!(at("sequence:0.1@1", &[0.0, 1.0]), [0.0, 0.1]);
    }

    #[test]
    fn what_cannot_be_read_is_named_with_what_was_expected() {
        for bad in ["", "jump", "step", "step:x", "step:nan", "step:1e9", "sine:0.2", "sine:0.1@-1", "sequence:1@2,1@1"]
        {
            let error = bad.parse::<Drive>().unwrap_err();
            assert!(error.to_string().starts_with("command: found"), "{error}");
        }
    }
}
