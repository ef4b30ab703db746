//! What the thesis says of a table or a figure, judged by our own figures.

use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, range, window};

use super::runs::values;

/// One statement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Where it stands.
    pub section: &'static str,
    /// What it says.
    pub thesis: &'static str,
    /// Our figures.
    pub ours: String,
    /// Whether they bear it out.
    pub agrees: bool,
    /// Why, where they do not.
    pub why: Option<&'static str>,
}

/// The value that is furthest from zero.
#[must_use]
pub fn peak(trace: &Trace, channel: Channel) -> f64 {
    let further = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    values(trace, channel).iter().copied().fold(0.0, further)
}

/// The mean between two times, s.
#[must_use]
pub fn mean(trace: &Trace, channel: Channel, (from_s, to_s): (f64, f64)) -> f64 {
    mean_between(trace.time_s(), values(trace, channel), from_s, to_s)
        .expect("every response covers the times asked for")
}

/// The mean magnitude between two times, s.
#[must_use]
pub fn mean_magnitude(trace: &Trace, channel: Channel, (from_s, to_s): (f64, f64)) -> f64 {
    let magnitudes: Vec<f64> = values(trace, channel).iter().map(|value| value.abs()).collect();
    mean_between(trace.time_s(), &magnitudes, from_s, to_s).expect("every response covers the times asked for")
}

/// The difference between the greatest and the least value between two times, s.
#[must_use]
pub fn swing(trace: &Trace, channel: Channel, (from_s, to_s): (f64, f64)) -> f64 {
    range(&values(trace, channel)[window(trace.time_s(), from_s, to_s)])
}

/// The first time at which a channel is at least this much, s; never is infinite.
#[must_use]
pub fn first_above(trace: &Trace, channel: Channel, level: f64) -> f64 {
    let at = values(trace, channel).iter().position(|&value| value >= level);
    at.map_or(f64::INFINITY, |at| trace.time_s()[at])
}

/// The last time at which a channel is at least this much, s; never is 0.
#[must_use]
pub fn last_above(trace: &Trace, channel: Channel, level: f64) -> f64 {
    let at = values(trace, channel).iter().rposition(|&value| value >= level);
    at.map_or(0.0, |at| trace.time_s()[at])
}

/// How far two traces are apart in a channel: the root mean square of their difference, as a part of the first one's range.
#[must_use]
pub fn apart(one: &Trace, other: &Trace, channel: Channel) -> f64 {
    let (one, other) = (values(one, channel), values(other, channel));
    let squares: f64 = one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / one.len() as f64).sqrt() / range(one)
}

/// Whether every value is above the one before.
#[must_use]
pub fn grows(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[1] > pair[0])
}

/// Whether every value is below the one before.
#[must_use]
pub fn falls(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[1] < pair[0])
}

/// The change from the first to the last value, %.
#[must_use]
pub fn change_percent(values: &[f64]) -> f64 {
    (values[values.len() - 1] / values[0] - 1.0) * 100.0
}

/// Values for a sentence, with this many decimals.
#[must_use]
pub fn listed(values: &[f64], decimals: usize) -> String {
    let told = |value: &f64| {
        let text = format!("{value:.decimals$}");
        // What rounds to nothing has no sign.
        if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) { text.replace('-', "") } else { text }
    };
    values.iter().map(told).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn trace(pressure_pa: Vec<f64>) -> Trace {
        let time_s: Vec<f64> = (0..pressure_pa.len()).map(|i| i as f64).collect();
        let command = vec![0.0; time_s.len()];
        let channels = BTreeMap::from([(Channel::PositionCommand, command), (Channel::LoadPressure, pressure_pa)]);
        Trace::try_new(time_s, channels, Vec::new()).unwrap()
    }

    #[test]
    fn a_response_is_measured_by_its_peak_means_and_times() {
        let one = trace(vec![0.0, 1.0, 3.0, -4.0, 2.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let of = Channel::LoadPressure;
        assert_eq!((peak(&one, of), mean(&one, of, (4.0, 7.0)), swing(&one, of, (2.0, 5.0))), (-4.0, 2.0, 7.0));
        assert_eq!(
            (first_above(&one, of, 1.0), last_above(&one, of, 2.0), first_above(&one, of, 5.0)),
            (1.0, 7.0, f64::INFINITY)
        );
        assert_eq!(mean_magnitude(&one, of, (3.0, 4.0)), 3.0);
        let other = trace(values(&one, of).iter().map(|value| value + 0.7).collect());
        assert!((apart(&one, &other, of) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_trend_is_one_only_if_every_level_follows_it() {
        assert!(grows(&[1.0, 2.0, 2.5]) && !grows(&[1.0, 2.0, 2.0]) && falls(&[3.0, 2.0]) && !falls(&[3.0, 2.0, 2.5]));
        assert_eq!(
            (change_percent(&[2.0, 9.0, 3.0]), listed(&[1.0, 0.126, -0.001], 2).as_str()),
            (50.0, "1.00, 0.13, 0.00")
        );
    }
}
