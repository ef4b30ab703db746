//! From usage to the calendar: how fast an actuator was used of late, and the dates that a forecast means at that rate.

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use serde::Serialize;
use utoipa::ToSchema;

use crate::prognostics::Quantiles;
use crate::store::records::HealthRecord;

/// What was recorded this long before the newest trace is recent.
const RECENT: SignedDuration = SignedDuration::from_hours(24 * 90);
/// Traces that the rate is taken from where fewer than this are recent.
const TRACES_MIN: usize = 10;
/// The most traces that are compared with each other; of more, as many are taken evenly.
const TRACES_MAX: usize = 50;
/// Seconds of a day.
const DAY_S: f64 = 86_400.0;
/// No two dates are as far apart as this, s.
const DATES_S: f64 = 1e12;

/// The recent rate of use: the median of the slopes of usage over time between all pairs of recent traces, each weighted by
/// the time between the two. Recent are the life's traces of the 90 days up to its newest, or its newest 10 where those are
/// more; of more than 50, as many are taken evenly.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct UseRate {
    /// Usage per day, in the actuator's usage unit, above 0; null where usage or time does not advance.
    pub per_day: Option<f64>,
    /// When the first of the recent traces was recorded; null without a trace.
    pub from: Option<Timestamp>,
    /// When the newest trace was recorded; null without a trace.
    pub to: Option<Timestamp>,
    /// The recent traces.
    pub traces: usize,
    /// Why there is no rate; null where there is one.
    pub reason: Option<String>,
}

impl UseRate {
    /// The rate of use in a life, from its history ascending by time of recording.
    #[must_use]
    pub fn of(history: &[HealthRecord]) -> Self {
        let recent = recent(history);
        let (Some(first), Some(newest)) = (recent.first(), recent.last()) else {
            let reason = Some("no trace of this life".to_owned());
            return Self { per_day: None, from: None, to: None, traces: 0, reason };
        };
        let (from, to) = (first.recorded_at, newest.recorded_at);
        let found = match median_slope(&evenly(recent)) {
            Some(per_day) if per_day > 0.0 => Ok(per_day),
            Some(_) => Err(format!("usage does not advance from {from} to {to}")),
            None if recent.len() == 1 => Err("one trace alone tells no rate of use".to_owned()),
            None => Err(format!("time does not advance: all {} traces were recorded at {from}", recent.len())),
        };
        Self {
            per_day: found.as_ref().ok().copied(),
            from: Some(from),
            to: Some(to),
            traces: recent.len(),
            reason: found.err(),
        }
    }

    /// The date, to the second, at which `ahead` more usage than the newest trace has will be there; none without a rate,
    /// and beyond the year 9999.
    #[must_use]
    pub fn date(&self, ahead: f64) -> Option<Timestamp> {
        let elapsed_s = ahead / self.per_day? * DAY_S;
        let elapsed_s = (elapsed_s < DATES_S).then_some(elapsed_s as i64)?;
        Timestamp::from_second(self.to?.as_second() + elapsed_s).ok()
    }

    /// The date of every quantile, by its probability.
    #[must_use]
    pub fn dates(&self, quantiles: &Quantiles) -> BTreeMap<String, Option<Timestamp>> {
        let dated = |(p, quantile): (f64, Option<f64>)| (p.to_string(), quantile.and_then(|ahead| self.date(ahead)));
        quantiles.pairs().map(dated).into()
    }
}

/// The recent traces of a history.
fn recent(history: &[HealthRecord]) -> &[HealthRecord] {
    let Some(newest) = history.last() else { return history };
    let since = newest.recorded_at.checked_sub(RECENT).unwrap_or(Timestamp::MIN);
    let by_time = history.partition_point(|record| record.recorded_at < since);
    &history[by_time.min(history.len().saturating_sub(TRACES_MIN))..]
}

/// Time in days and usage of at most [`TRACES_MAX`] records, the first and the last among them.
fn evenly(records: &[HealthRecord]) -> Vec<(f64, f64)> {
    let (all, taken) = (records.len(), records.len().min(TRACES_MAX));
    let origin = records[0].recorded_at;
    let place = |i: usize| i * (all - 1) / (taken - 1).max(1);
    let point = |record: &HealthRecord| (record.recorded_at.duration_since(origin).as_secs_f64() / DAY_S, record.usage);
    (0..taken).map(|i| point(&records[place(i)])).collect()
}

/// The weighted median of the slopes between points ascending by time; none where all are of one time.
fn median_slope(points: &[(f64, f64)]) -> Option<f64> {
    let mut slopes = Vec::with_capacity(points.len() * points.len() / 2);
    for (i, before) in points.iter().enumerate() {
        let later = points[i + 1..].iter().filter(|after| after.0 > before.0);
        slopes.extend(later.map(|after| ((after.1 - before.1) / (after.0 - before.0), after.0 - before.0)));
    }
    slopes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * slopes.iter().map(|slope| slope.1).sum::<f64>();
    let mut sum = 0.0;
    let middle = slopes.iter().find(|slope| {
        sum += slope.1;
        sum >= half
    });
    middle.map(|slope| slope.0)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::estimation::Verdict;
    use crate::store::records::Id;

    /// Records of (day, usage), the days counted from the start of 2026.
    fn records(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<HealthRecord> {
        let start: Timestamp = "2026-01-01T00:00:00Z".parse().unwrap();
        let record = |(day, usage): (f64, f64)| HealthRecord {
            trace_id: Id::now(),
            job_id: Id::now(),
            recorded_at: start + SignedDuration::from_secs_f64(day * DAY_S),
            usage,
            kgm: None,
            kgm_std: None,
            fdj_n: None,
            fdj_n_std: None,
            faults: BTreeMap::new(),
            verdict: Verdict::Inconclusive,
        };
        points.into_iter().map(record).collect()
    }

    fn rate(points: impl IntoIterator<Item = (f64, f64)>) -> UseRate {
        UseRate::of(&records(points))
    }

    #[test]
    fn a_steady_use_is_found_and_dates_count_from_the_newest_trace() {
        let rate = rate((0..5).map(|i| (f64::from(i), 100.0 + 4.0 * f64::from(i))));
        assert_eq!((rate.per_day, rate.traces, &rate.reason), (Some(4.0), 5, &None));
        assert_eq!(rate.from.unwrap().to_string(), "2026-01-01T00:00:00Z");
        assert_eq!(rate.to.unwrap().to_string(), "2026-01-05T00:00:00Z");
        assert_eq!(rate.date(0.0), rate.to);
        assert_eq!(rate.date(10.0).unwrap().to_string(), "2026-01-07T12:00:00Z");
    }

    #[test]
    fn one_mistyped_usage_and_repeated_traces_do_not_change_the_rate() {
        let mut points: Vec<_> = (0..9).map(|i| (f64::from(i), 4.0 * f64::from(i))).collect();
        points[4].1 = 9000.0;
        for i in [2, 6] {
            points.insert(i, (points[i].0 + 1e-4, points[i].1));
        }
        let found = rate(points).per_day.unwrap();
        assert!((found - 4.0).abs() < 0.01, "{found}");
    }

    #[test]
    fn only_the_last_90_days_count_where_they_hold_ten_traces_and_the_newest_ten_otherwise() {
        let slow = (0..99).map(|i| (f64::from(i), f64::from(i)));
        let fast = (0..40).map(|i| (150.0 + f64::from(i), 200.0 + 5.0 * f64::from(i)));
        let dense = rate(slow.clone().chain(fast));
        assert!((dense.per_day.unwrap() - 5.0).abs() < 1e-9, "{dense:?}");
        assert_eq!(dense.traces, 40);
        let rare = rate((0..30).map(|i| (100.0 * f64::from(i), 50.0 * f64::from(i))));
        assert_eq!((rare.per_day, rare.traces), (Some(0.5), 10));
    }

    #[test]
    fn of_many_traces_as_many_are_taken_evenly_from_the_first_to_the_last() {
        let many = records((0..5000).map(|i| (0.01 * f64::from(i), 0.03 * f64::from(i))));
        let taken = evenly(&many);
        assert_eq!((taken.len(), taken[0].1, taken[TRACES_MAX - 1].1), (TRACES_MAX, 0.0, many[4999].usage));
        assert!((UseRate::of(&many).per_day.unwrap() - 3.0).abs() < 1e-6);
    }

    #[test]
    fn where_usage_or_time_does_not_advance_there_is_no_rate_but_a_reason() {
        let cases: [(&[(f64, f64)], &str); 5] = [
            (&[], "no trace"),
            (&[(1.0, 5.0)], "one trace alone"),
            (&[(1.0, 5.0), (1.0, 7.0), (1.0, 9.0)], "time does not advance: all 3"),
            (&[(1.0, 5.0), (2.0, 5.0)], "usage does not advance"),
            (&[(1.0, 5.0), (2.0, 4.0)], "usage does not advance"),
        ];
        for (points, reason) in cases {
            let rate = rate(points.iter().copied());
            assert!(rate.per_day.is_none() && rate.date(1.0).is_none(), "{rate:?}");
            assert!(rate.reason.as_ref().unwrap().starts_with(reason), "{rate:?}");
            assert_eq!(rate.traces, points.len());
        }
    }

    #[test]
    fn a_date_beyond_the_year_9999_is_none() {
        let rate = rate([(0.0, 0.0), (1.0, 1.0)]);
        assert!(rate.date(2_900_000.0).unwrap() > Timestamp::UNIX_EPOCH);
        for ahead in [2_920_000.0, 1e12, 1e300, f64::INFINITY, f64::NAN] {
            assert_eq!(rate.date(ahead), None, "{ahead}");
        }
    }
}
