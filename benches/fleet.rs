//! What a fleet is worth: early forecasts on simulated fleets, by how many others and how many earlier lives are known; and the
//! time that the fleet costs a forecast.

use std::slice::from_ref;
use std::time::Instant;

use elevon::prognostics::metrics::{Criteria, Figures, Scored, figures};
use elevon::prognostics::{Direction, Fleet, LifeEvidence, LifePrior, Observation, Question, remaining_life, tally};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, Gamma, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Simulated fleets, each with a type of its own.
const FLEETS: u64 = 60;
/// Ages at which forecasts are asked of the lives that last longer, in median lives of the type: when a question comes has
/// nothing to do with when that life will end.
const ASKED: [f64; 3] = [0.1, 0.25, 0.5];
/// Known others, and known earlier lives of the same actuator.
const KNOWN: [(usize, usize); 8] = [(0, 0), (1, 0), (3, 0), (10, 0), (30, 0), (100, 0), (0, 2), (30, 2)];
const STEP: f64 = 100.0;

/// A type of actuators: the logarithm of its median life, and the spread of those of its actuators and of each one's lives.
struct Type {
    median: f64,
    between: f64,
    within: f64,
}

impl Type {
    fn drawn(random: &mut impl Rng) -> Self {
        let median = random.random_range(1500f64.ln()..15_000f64.ln());
        Self { median, between: random.random_range(0.05..0.5), within: random.random_range(0.05..0.5) }
    }

    /// The medians of the lives of an actuator, in logarithm.
    fn actuator(&self, random: &mut impl Rng) -> f64 {
        let deviate: f64 = StandardNormal.sample(random);
        self.median + self.between * deviate
    }

    fn life(&self, actuator: f64, random: &mut impl Rng) -> f64 {
        let deviate: f64 = StandardNormal.sample(random);
        (actuator + self.within * deviate).exp()
    }
}

/// A history of about a life: growth as a power of usage by gamma increments, seen through noise; and when it truly ends.
fn history(about: f64, random: &mut impl Rng) -> (Vec<Observation>, f64) {
    let exponent: f64 = random.random_range(1.0..2.5);
    let (scatter, noise) = (random.random_range(0.001..0.01), random.random_range(0.01..0.06));
    let (mut level, mut usage, mut observations) = (0.0, 0.0, Vec::new());
    loop {
        let deviate: f64 = StandardNormal.sample(random);
        observations.push(Observation { usage, value: level + noise * deviate, std: Some(noise) });
        let next = usage + STEP;
        let mean = (next / about).powf(exponent) - (usage / about).powf(exponent);
        let grown = Gamma::new((mean / scatter).max(1e-9), scatter).expect("both are above 0").sample(random);
        if level + grown >= 1.0 {
            return (observations, usage + STEP * (1.0 - level) / grown);
        }
        (level, usage) = (level + grown, next);
    }
}

fn question(at: f64, prior: LifePrior) -> Question {
    let direction = Direction::Rising;
    let (threshold, healthy, life_start, risk_window) = (1.0, Some(0.0), Some(0.0), 100.0);
    Question { threshold, direction, healthy, at, life_start, horizon: None, risk_window, prior }
}

/// What a life of an actuator says when seen up to a part of it.
fn evidence(about: f64, part: f64, random: &mut impl Rng) -> LifeEvidence {
    let (observations, end) = history(about, random);
    let prognosis = remaining_life(&observations, &question(part * end, LifePrior::Watched)).expect("a sound history");
    prognosis.evidence.expect("it has an observation")
}

fn add(sum: &mut Vec<i64>, tally: &[i32]) {
    sum.resize(tally.len(), 0);
    sum.iter_mut().zip(tally).for_each(|(sum, &number)| *sum += i64::from(number));
}

fn scored(observations: &[Observation], at: f64, end: f64, prior: LifePrior) -> Scored {
    let prognosis = remaining_life(observations, &question(at, prior)).expect("a sound history");
    Scored::of_prognosis(0.0, at, end, &prognosis).expect("a question within the life")
}

fn main() {
    let mut table = vec![[const { Vec::new() }; ASKED.len()]; KNOWN.len()];
    for seed in 0..FLEETS {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let kind = Type::drawn(&mut random);
        // Half of the others' lives have ended, the other half are anywhere in theirs.
        let others: Vec<Vec<i32>> = (0..100)
            .map(|i| {
                let actuator = kind.actuator(&mut random);
                let part = if i % 2 == 0 { 1.0 } else { random.random_range(0.05..1.0) };
                let life = evidence(kind.life(actuator, &mut random), part, &mut random);
                tally(from_ref(&life)).expect("one life")
            })
            .collect();
        for _ in 0..5 {
            let actuator = kind.actuator(&mut random);
            let earlier: Vec<LifeEvidence> =
                (0..2).map(|_| evidence(kind.life(actuator, &mut random), 1.0, &mut random)).collect();
            let (observations, end) = history(kind.life(actuator, &mut random), &mut random);
            for (row, &(n, own)) in table.iter_mut().zip(&KNOWN) {
                let mut sum = Vec::new();
                others[..n].iter().for_each(|tally| add(&mut sum, tally));
                let prior = Fleet::new(&sum, &earlier[..own]).map_or(LifePrior::Watched, LifePrior::Fleet);
                for (cell, part) in row.iter_mut().zip(ASKED) {
                    let at = part * kind.median.exp();
                    if at < end {
                        cell.push((scored(&observations, at, end, prior.clone()), kind.median.exp()));
                    }
                }
            }
        }
    }
    println!("others  earlier lives  asked at  forecasts  MRA    CRPS over median life  90 % coverage");
    for (row, (n, own)) in table.iter().zip(KNOWN) {
        for (cell, part) in row.iter().zip(ASKED) {
            let crps = cell.iter().map(|(scored, median)| scored.crps() / median).sum::<f64>() / cell.len() as f64;
            let scored: Vec<_> = cell.iter().map(|(scored, _)| vec![scored.clone()]).collect();
            let Figures { forecasts, mra, coverage_90, .. } =
                figures(&scored, &Criteria::default()).expect("forecasts");
            println!("{n:6} {own:14} {part:9} {forecasts:10} {mra:6.3} {crps:6.3} {coverage_90:22.3}");
        }
    }
    cost();
}

/// The time of a forecast with 50 observations, alone and with all that a fleet adds.
fn cost() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let (observations, end) = history(5000.0, &mut random);
    let life = evidence(5000.0, 1.0, &mut random);
    let others: Vec<i64> = tally(from_ref(&life)).expect("one life").into_iter().map(i64::from).collect();
    let fleet = LifePrior::Fleet(Fleet::new(&others, &[]).expect("one other"));
    for (name, prior) in [("alone", LifePrior::Watched), ("in a fleet, with its tally", fleet)] {
        let mut times = Vec::new();
        for _ in 0..500 {
            let started = Instant::now();
            let prognosis =
                remaining_life(&observations, &question(0.9 * end, prior.clone())).expect("a sound history");
            let told = matches!(prior, LifePrior::Fleet(_)).then(|| tally(from_ref(&prognosis.evidence?)));
            times.push(started.elapsed().as_secs_f64() * 1e3);
            assert!(told.is_none_or(|told| told.is_some()));
        }
        times.sort_by(f64::total_cmp);
        println!("{name}: {:.2} ms in the median", times[times.len() / 2]);
    }
}
