//! When a delivery that failed is sent again.

use std::time::Duration;

use rand::RngExt as _;

use crate::numeric::rng::Seed;
use crate::store::records::Id;

/// How many times longer each wait is than the one before.
const GROWTH: f64 = 5.0;
/// The part of a wait that is left to chance, so that what failed together is not sent again together.
const JITTER: f64 = 0.25;

/// The growing waits between the attempts of a delivery.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// The wait after the first attempt.
    pub first: Duration,
    /// The longest wait.
    pub max: Duration,
}

impl Schedule {
    /// The wait after attempt number `attempt`, from 1: five times the one before, never over the longest, and a part of it
    /// drawn from the delivery's id.
    pub fn wait(&self, delivery: Id, attempt: u32) -> Duration {
        let exponent = i32::try_from(attempt.saturating_sub(1)).unwrap_or(i32::MAX);
        let longest = (self.first.as_secs_f64() * GROWTH.powi(exponent)).min(self.max.as_secs_f64());
        let chance: f64 = Seed(0).stream(&format!("webhooks.retry.{delivery}"), u64::from(attempt)).random();
        Duration::from_secs_f64(longest * (1.0 - JITTER * chance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCHEDULE: Schedule = Schedule { first: Duration::from_secs(5), max: Duration::from_secs(3600) };

    #[test]
    fn waits_grow_to_the_longest_and_stay_there() {
        let id = Id::now();
        for (attempt, longest) in [(1, 5.0), (2, 25.0), (3, 125.0), (4, 625.0), (5, 3125.0), (6, 3600.0), (9, 3600.0)] {
            let wait = SCHEDULE.wait(id, attempt).as_secs_f64();
            assert!((0.75 * longest..=longest).contains(&wait), "{attempt}: {wait}");
        }
        assert!(SCHEDULE.wait(id, u32::MAX) <= SCHEDULE.max);
    }

    #[test]
    fn a_delivery_has_its_own_waits_and_always_the_same() {
        let (one, two) = (Id::now(), Id::now());
        assert_eq!(SCHEDULE.wait(one, 3), SCHEDULE.wait(one, 3));
        assert_ne!(SCHEDULE.wait(one, 3), SCHEDULE.wait(two, 3));
        assert_ne!(SCHEDULE.wait(one, 7), SCHEDULE.wait(one, 8));
    }
}
