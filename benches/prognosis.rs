//! The time of one forecast of the remaining life, by the number of observations, on one core.

use std::time::{Duration, Instant};

use elevon::prognostics::{Direction, LifePrior, Observation, Question, remaining_life};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// How long each size is repeated.
const REPEATED_FOR: Duration = Duration::from_secs(3);

/// Growth as the square of usage, to 0.6 of the way, seen through noise.
fn history(n: usize) -> Vec<Observation> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let observe = |i: usize| {
        let part = i as f64 / (n - 1) as f64;
        let deviate: f64 = StandardNormal.sample(&mut random);
        Observation { usage: 1000.0 * part, value: 0.6 * part * part + 0.02 * deviate, std: None }
    };
    (0..n).map(observe).collect()
}

fn main() {
    let question = Question {
        threshold: 1.0,
        direction: Direction::Rising,
        healthy: None,
        at: 1000.0,
        life_start: None,
        horizon: None,
        risk_window: 0.0,
        prior: LifePrior::Age,
    };
    println!("observations  median ms  fastest ms");
    for n in [5, 10, 50, 200, 1000] {
        let history = history(n);
        let (started, mut times) = (Instant::now(), Vec::new());
        while started.elapsed() < REPEATED_FOR {
            let one = Instant::now();
            let forecast = remaining_life(&history, &question).map(|prognosis| prognosis.forecast);
            times.push(one.elapsed().as_secs_f64() * 1e3);
            assert!(forecast.is_ok_and(|forecast| forecast.is_some()), "{n} observations have a forecast");
        }
        times.sort_by(f64::total_cmp);
        println!("{n:12} {:10.2} {:11.2}", times[times.len() / 2], times[0]);
    }
}
