//! The simulated fleet: how fast which fault grows in which actuator.

use jiff::{SignedDuration, Timestamp};
use rand_distr::{Distribution, StandardNormal};

use crate::models::fault::{FDJ_NOMINAL_N, Faults};
use crate::numeric::rng::Seed;

/// Seed of the fleet: every draw of the demo comes from it.
pub const SEED: Seed = Seed(2021);
/// Flights per actuator that are recorded.
pub const FLIGHTS: u32 = 24;
/// Flight hours between two recordings, and the days between them.
const HOURS_BETWEEN: f64 = 40.0;
const DAYS_BETWEEN: i64 = 6;
/// The scatter from flight to flight (temperature, supply, load): demagnetisation, and friction in N.
const SCATTER: (f64, f64) = (0.004, 6.0);
/// How much a cold-soaked jack rubs beside its wear, N.
const COLD_N: f64 = 260.0;
/// Power of the noise on the current, mA² s (thesis, section 7.2).
pub const NOISE_POWER_MA2_S: f64 = 5e-6;

/// How a fault grows: what it has grown by at the last flight, and the power of usage that it follows (1 is steady).
#[derive(Debug, Clone, Copy)]
struct Growth {
    by: f64,
    power: f64,
}

impl Growth {
    /// The growth after a part (0 to 1) of the recorded usage.
    fn after(self, part: f64) -> f64 {
        self.by * part.powf(self.power)
    }
}

const fn steady(by: f64) -> Growth {
    Growth { by, power: 1.0 }
}

/// One actuator of the fleet.
#[derive(Debug, Clone, Copy)]
pub struct Member {
    pub serial_number: &'static str,
    pub tail_number: &'static str,
    pub location: &'static str,
    kgm: Growth,
    fdj_n: Growth,
    /// The flight before which another part took its place.
    pub replaced_before: Option<u32>,
    /// A flight whose check was never flown: the command is zero throughout.
    idle_flight: Option<u32>,
    /// A flight on which the jack was cold-soaked, and its friction higher by [`COLD_N`].
    cold_flight: Option<u32>,
}

const fn member(
    serial_number: &'static str,
    tail_number: &'static str,
    location: &'static str,
    kgm: Growth,
    fdj_n: Growth,
) -> Member {
    Member {
        serial_number,
        tail_number,
        location,
        kgm,
        fdj_n,
        replaced_before: None,
        idle_flight: None,
        cold_flight: None,
    }
}

/// The fleet: one actuator stays healthy, two come near their thresholds, one is replaced when it was near its own, and one has
/// an outlier.
pub const FLEET: [Member; 8] = [
    member("EHSA-1001", "I-ELVA", "left aileron", steady(0.22), steady(90.0)),
    member("EHSA-1002", "I-ELVA", "right aileron", steady(0.0), steady(0.0)),
    Member { cold_flight: Some(15), ..member("EHSA-1003", "I-ELVA", "left elevator", steady(0.04), steady(430.0)) },
    member("EHSA-2001", "I-ELVB", "rudder, upper", steady(0.37), steady(60.0)),
    Member { idle_flight: Some(17), ..member("EHSA-2002", "I-ELVB", "left aileron", steady(0.10), steady(150.0)) },
    Member {
        replaced_before: Some(14),
        ..member("EHSA-2003", "I-ELVB", "right elevator", steady(0.65), steady(180.0))
    },
    member("EHSA-3001", "I-ELVC", "rudder, lower", steady(0.03), Growth { by: 690.0, power: 1.5 }),
    member("EHSA-3002", "I-ELVC", "inboard spoiler", Growth { by: 0.17, power: 0.8 }, steady(260.0)),
];

impl Member {
    /// The command, the faults and the seed of the noise of a flight, 0 to [`FLIGHTS`].
    pub fn flight(&self, index: usize, flight: u32) -> (&'static str, Faults, u64) {
        let since = self.replaced_before.filter(|&first| flight >= first).map_or(flight, |first| flight - first);
        let part = f64::from(since) / f64::from(FLIGHTS - 1);
        let mut scatter = SEED.stream(self.serial_number, u64::from(flight));
        let mut draw = || -> f64 { StandardNormal.sample(&mut scatter) };
        let kgm = (self.kgm.after(part) + SCATTER.0 * draw()).clamp(0.0, 1.0);
        let cold_n = if self.cold_flight == Some(flight) { COLD_N } else { 0.0 };
        let fdj_n = (FDJ_NOMINAL_N + self.fdj_n.after(part) + cold_n + SCATTER.1 * draw()).max(FDJ_NOMINAL_N);
        let command = if self.idle_flight == Some(flight) { "step:0" } else { "diagnostic" };
        (command, Faults { kgm, fdj_n, ..Faults::default() }, index as u64 * 1000 + u64::from(flight))
    }
}

/// When a flight was recorded, and the usage then, flight hours.
pub fn recorded(flight: u32) -> (Timestamp, f64) {
    let first: Timestamp = "2026-06-01T05:30:00Z".parse().expect("a valid time");
    (first + SignedDuration::from_hours(24 * DAYS_BETWEEN * i64::from(flight)), HOURS_BETWEEN * f64::from(flight + 1))
}

/// When another part took an actuator's place, and the usage then: a day before the new part's first recording.
pub fn replaced(before: u32) -> (Timestamp, f64) {
    let (at, usage) = recorded(before);
    (at - SignedDuration::from_hours(24), usage - HOURS_BETWEEN / 2.0)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn the_fleet_has_what_the_demo_promises() {
        let tails: HashSet<&str> = FLEET.iter().map(|member| member.tail_number).collect();
        assert!(FLEET.len() >= 8 && tails.len() == 3 && FLIGHTS >= 20);
        let last = |index: usize| FLEET[index].flight(index, FLIGHTS - 1).1;
        assert!((0..FLEET.len()).any(|i| last(i).kgm < 0.03 && last(i).fdj_n < 230.0), "one is healthy");
        assert!((0..FLEET.len()).any(|i| (0.35..0.4).contains(&last(i).kgm)), "one is near its threshold");
        assert!(FLEET.iter().any(|member| member.replaced_before.is_some_and(|flight| flight > 8)), "one is replaced");
        let apart = |index: usize, flight: u32| {
            let [before, at] = [flight - 1, flight].map(|flight| FLEET[index].flight(index, flight).1.fdj_n);
            at - before > 200.0
        };
        let cold = |index: usize| FLEET[index].cold_flight.is_some_and(|flight| apart(index, flight));
        assert!((0..FLEET.len()).any(cold), "one has an outlier");
    }

    #[test]
    fn a_replaced_part_starts_again_from_healthy() {
        let (index, member) = FLEET.iter().enumerate().find(|(_, m)| m.replaced_before.is_some()).unwrap();
        let first = member.replaced_before.unwrap();
        let (before, after) = (member.flight(index, first - 1).1, member.flight(index, first).1);
        assert!(before.kgm > 0.35 && after.kgm < 0.05, "{before:?} {after:?}");
        let (at, usage) = replaced(first);
        assert!(recorded(first - 1).0 < at && at < recorded(first).0);
        assert!(recorded(first - 1).1 < usage && usage < recorded(first).1);
    }
}
