//! Commands: what the jack is told to do, as a function of time.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::signal::Signal;

/// The most that a position in a command may be, m.
pub const POSITION_MAX_M: f64 = 10.0;
/// The most that a frequency, or a time, in a command may be, Hz or s.
const FREQUENCY_MAX_HZ: f64 = 1e4;

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
    /// A sine whose frequency changes in proportion to the time, over the whole run (section 4.1).
    Chirp {
        /// Semi-amplitude, m.
        amplitude_m: f64,
        /// Frequency at the start, Hz.
        from_hz: f64,
        /// Frequency at the end of the run, Hz.
        to_hz: f64,
    },
    /// Levels held one after the other.
    Sequence {
        /// (from this time on in s, position in m), times rising from 0 or later; zero before the first.
        levels: Vec<(f64, f64)>,
    },
    /// A recorded command, m.
    Recorded(Signal),
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
    /// The commanded position, m, at a time of a run of this duration.
    #[must_use]
    #[inline]
    pub fn position_m(&self, time_s: f64, duration_s: f64) -> f64 {
        match self {
            Self::Diagnostic if time_s < 2.0 => 0.1 * time_s,
            Self::Diagnostic if time_s < 4.0 => 0.0,
            Self::Diagnostic => 0.1,
            Self::Step { level_m } => *level_m,
            Self::Ramp { slope_m_per_s } => slope_m_per_s * time_s,
            Self::Sine { amplitude_m, frequency_hz } => amplitude_m * (TAU * frequency_hz * time_s).sin(),
            Self::Chirp { amplitude_m, from_hz, to_hz } => {
                // The phase is the integral of the frequency.
                let mean_hz = from_hz + 0.5 * (to_hz - from_hz) * (time_s / duration_s);
                amplitude_m * (TAU * mean_hz * time_s).sin()
            }
            Self::Recorded(signal) => signal.at(time_s),
            Self::Sequence { levels } => {
                let passed = levels.partition_point(|&(from_s, _)| from_s <= time_s);
                passed.checked_sub(1).map_or(0.0, |last| levels[last].1)
            }
        }
    }
}

impl FromStr for Drive {
    type Err = DriveError;

    /// Reads `diagnostic`, `step:0.1`, `ramp:0.1`, `sine:0.2@5`, `chirp:0.05@0.5-10` or `sequence:0.1@0,-0.05@0.5`
    /// (level@time); m, m/s, Hz, s. A file of a recorded command is for the caller to read.
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
            "chirp" => chirp(rest),
            "sequence" => sequence(rest),
            _ => Err(DriveError {
                found: text.into(),
                expected: "diagnostic, step:LEVEL, ramp:SLOPE, sine:AMPLITUDE@HZ, chirp:AMPLITUDE@HZ-HZ or \
                           sequence:LEVEL@TIME,...",
            }),
        }
    }
}

impl fmt::Display for Drive {
    /// The text that is read as this command; `file` for a recorded one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Diagnostic => f.write_str("diagnostic"),
            Self::Step { level_m } => write!(f, "step:{level_m}"),
            Self::Ramp { slope_m_per_s } => write!(f, "ramp:{slope_m_per_s}"),
            Self::Sine { amplitude_m, frequency_hz } => write!(f, "sine:{amplitude_m}@{frequency_hz}"),
            Self::Chirp { amplitude_m, from_hz, to_hz } => write!(f, "chirp:{amplitude_m}@{from_hz}-{to_hz}"),
            Self::Sequence { levels } => {
                let levels: Vec<String> =
                    levels.iter().map(|(from_s, level_m)| format!("{level_m}@{from_s}")).collect();
                write!(f, "sequence:{}", levels.join(","))
            }
            Self::Recorded(_) => f.write_str("file"),
        }
    }
}

/// An amplitude and two frequencies.
fn chirp(text: &str) -> Result<Drive, DriveError> {
    let expected = "an amplitude, an @ and two frequencies with a - between them, as 0.05@0.5-10";
    let wrong = || DriveError { found: text.into(), expected };
    let (amplitude, band) = text.split_once('@').ok_or_else(wrong)?;
    // A minus may belong to an exponent: the one between the frequencies is the one that leaves two numbers.
    let is_number = |part: &str| part.trim().parse::<f64>().is_ok();
    let minuses = band.match_indices('-').map(|(at, _)| (&band[..at], &band[at + 1..]));
    let (from, to) = minuses.into_iter().find(|(from, to)| is_number(from) && is_number(to)).ok_or_else(wrong)?;
    let (from_hz, to_hz) = (number(from, FREQUENCY_MAX_HZ)?, number(to, FREQUENCY_MAX_HZ)?);
    if from_hz < 0.0 || to_hz < 0.0 {
        return Err(DriveError { found: band.into(), expected: "frequencies of at least 0" });
    }
    Ok(Drive::Chirp { amplitude_m: number(amplitude, POSITION_MAX_M)?, from_hz, to_hz })
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
    let second_number = number(second, FREQUENCY_MAX_HZ)?;
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
        times_s.iter().map(|&t| drive.position_m(t, 10.0)).collect()
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
    fn validate_section_4_1_a_chirp_s_frequency_grows_in_proportion_to_the_time() {
        let drive: Drive = "chirp:0.05@0.5-10".parse().unwrap();
        let (duration_s, dt) = (4.0, 1e-5);
        // The time between two upward passages through zero is one period of the frequency between them.
        let at = |step: u32| drive.position_m(f64::from(step) * dt, duration_s);
        let rises: Vec<f64> =
            (0..400_000).filter(|&step| at(step) <= 0.0 && at(step + 1) > 0.0).map(|s| f64::from(s) * dt).collect();
        assert!(rises.len() > 15, "{rises:?}");
        for two in rises.windows(2) {
            let found_hz = 1.0 / (two[1] - two[0]);
            let expected_hz = 0.5 + 9.5 * (0.5 * (two[0] + two[1])) / duration_s;
            assert!((found_hz / expected_hz - 1.0).abs() < 2e-3, "{found_hz} at {two:?}, expected {expected_hz}");
        }
        let down: Drive = "chirp:0.05@1e1-5e-1".parse().unwrap();
        assert_eq!(down, Drive::Chirp { amplitude_m: 0.05, from_hz: 10.0, to_hz: 0.5 });
    }

    #[test]
    fn a_command_is_read_back_from_what_it_is_written_as() {
        for text in
            ["diagnostic", "step:-0.1", "ramp:0.1", "sine:0.2@5", "chirp:0.05@0.5-10", "sequence:0.1@0,-0.05@0.5"]
        {
            assert_eq!(text.parse::<Drive>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_cannot_be_read_is_named_with_what_was_expected() {
        let bad = ["", "jump", "step", "step:x", "step:nan", "step:1e9", "sine:0.2", "sine:0.1@-1", "sequence:1@2,1@1"];
        let chirps = ["chirp:0.1", "chirp:0.1@5", "chirp:@1-2", "chirp:0.1@1--2", "chirp:0.1@a-2", "chirp:0.1@1-1e9"];
        for bad in bad.into_iter().chain(chirps) {
            let error = bad.parse::<Drive>().unwrap_err();
            assert!(error.to_string().starts_with("command: found"), "{error}");
        }
    }
}
