//! A recorded quantity between its samples.

use std::sync::Arc;

/// The least slope of a command's jump, m/s: no jack follows it.
const COMMAND_JUMP_M_PER_S: f64 = 0.5;
/// How many times as steep as before and after it a jump is; a fast sine is not.
const JUMP_RATIO: f64 = 10.0;
/// How much earlier than a sample its time may be taken, s: times that were printed and read back are that uncertain.
const TOLERANCE_S: f64 = 1e-9;

/// A quantity over time, by its samples: straight between two of them, held before the first and after the last. Where it
/// jumps (a slope above 0.5 m/s of a command, and ten times those before and after it) it is held until the sample that
/// ends the jump. Time counts from the first sample. Clones share the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    time_s: Arc<[f64]>,
    values: Arc<[f64]>,
    /// The slope above which it jumps, per second.
    jump_per_s: f64,
}

impl Signal {
    /// A quantity that jumps where it changes faster than `jump_per_s`; with infinity it never does.
    ///
    /// # Panics
    /// Where there is no sample, or not a value for every time.
    #[must_use]
    pub fn new(time_s: &[f64], values: &[f64], jump_per_s: f64) -> Self {
        assert!(!time_s.is_empty() && time_s.len() == values.len(), "a signal has samples, each with its time");
        Self { time_s: time_s.iter().map(|t| t - time_s[0]).collect(), values: values.into(), jump_per_s }
    }

    /// A commanded position, m, which jumps where no jack could follow.
    #[must_use]
    pub fn command(time_s: &[f64], position_m: &[f64]) -> Self {
        Self::new(time_s, position_m, COMMAND_JUMP_M_PER_S)
    }

    /// The value at a time after the first sample, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let (times_s, values) = (&self.time_s, &self.values);
        if times_s.len() == 1 {
            return values[0];
        }
        let right = times_s.partition_point(|&t| t <= time_s + TOLERANCE_S).clamp(1, times_s.len() - 1);
        let (left_s, right_s) = (times_s[right - 1], times_s[right]);
        if time_s + TOLERANCE_S < right_s && self.jumps(right) {
            return values[right - 1];
        }
        let rise = values[right] - values[right - 1];
        values[right - 1] + rise * ((time_s - left_s) / (right_s - left_s)).clamp(0.0, 1.0)
    }

    /// Whether it jumps between a sample and the one before it.
    fn jumps(&self, right: usize) -> bool {
        let slope = |right: usize| {
            let values = self.values.get(right).zip(self.values.get(right.wrapping_sub(1)));
            let rise = values.map_or(0.0, |(after, before)| after - before);
            if rise == 0.0 { 0.0 } else { (rise / (self.time_s[right] - self.time_s[right - 1])).abs() }
        };
        let around = slope(right - 1).max(slope(right + 1));
        slope(right) > self.jump_per_s.max(JUMP_RATIO * around)
    }

    /// The time from the first sample to the last, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.time_s[self.time_s.len() - 1]
    }

    /// The least and the greatest value.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_straight_between_samples_and_held_beyond_them_and_over_jumps() {
        let signal = Signal::command(&[5.0, 5.5, 5.501, 6.0], &[0.0, 0.1, -0.1, -0.1]);
        let found = [-1.0, 0.0, 0.25, 0.5, 0.5005, 0.501, 0.7, 9.0].map(|t| signal.at(t));
        let expected = [0.0, 0.0, 0.05, 0.1, 0.1, -0.1, -0.1, -0.1];
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9), "{found:?}");
        assert_eq!((signal.duration_s(), signal.range()), (1.0, (-0.1, 0.1)));
        assert!((Signal::new(&[0.0, 1e-3], &[0.0, 1.0], f64::INFINITY).at(5e-4) - 0.5).abs() < 1e-12);
        assert_eq!(Signal::new(&[3.0], &[7.0], 1.0).at(0.5), 7.0);
    }

    #[test]
    fn a_fast_sine_does_not_jump_and_an_input_that_never_jumps_is_straight() {
        let time_s: Vec<f64> = (0..=1000).map(|k| f64::from(k) / 1000.0).collect();
        let sine = |t: f64| 0.2 * (std::f64::consts::TAU * 5.0 * t).sin();
        let signal = Signal::command(&time_s, &time_s.iter().map(|&t| sine(t)).collect::<Vec<_>>());
        // Half a step of 1 ms off at the steepest would be 3 mm; the bend of the sine between samples is 25 um.
        assert!((0..10_000).map(|k| f64::from(k) * 1e-4).all(|t| (signal.at(t) - sine(t)).abs() < 3e-5));
    }

    #[test]
    fn a_sampled_diagnostic_command_comes_back_with_its_jumps_in_place_whenever_the_trace_begins() {
        use crate::models::drive::Drive;
        let time_s: Vec<f64> = (0..=6000).map(|k| f64::from(k) / 1000.0).collect();
        let position = |t: f64| Drive::Diagnostic.position_m(t, 6.0);
        let position_m: Vec<f64> = time_s.iter().map(|&t| position(t)).collect();
        for start_s in [0.0, 100.0] {
            let late_s: Vec<f64> = time_s.iter().map(|t| t + start_s).collect();
            let signal = Signal::command(&late_s, &position_m);
            for step in 0..=24_000 {
                let at_s = f64::from(step) * 2.5e-4;
                let before_the_jump = (1.999..2.0).contains(&at_s);
                let off = (signal.at(at_s) - position(at_s)).abs();
                assert!(off < if before_the_jump { 1e-4 } else { 1e-12 }, "{off} at {at_s}");
            }
        }
    }
}
