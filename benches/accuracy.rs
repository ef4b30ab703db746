//! How good the forecasts of the remaining life are on simulated histories of a health index, kind by kind: a third each of straight,
//! exponential and accelerating growth of the damage, seen at random times through noise.

use elevon::prognostics::metrics::{Criteria, Figures, Scored, figures};
use elevon::prognostics::{Direction, LifePrior, Observation, Question, remaining_life};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, Gamma, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

const SEED: u64 = 2027;
const HISTORIES: u64 = 300;
/// Fractions of the life at which a forecast is asked.
const ASKED: [f64; 4] = [0.3, 0.5, 0.7, 0.9];
/// The index when new is near 1; life ends here.
const END: f64 = 0.3;
/// Steps of a nominal life, and those after which a history that has not ended is drawn again.
const STEPS: usize = 1500;
const STEPS_MAX: usize = 3750;

type Range = (f64, f64);

/// What differs between kinds of histories.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    /// Of the exponential, its rate times the life; of the power, its exponent.
    rate: Range,
    exponent: Range,
    /// The mean increment of the gamma process, log-uniform; the standard deviation of the noise; observations.
    scatter: Range,
    noise: Range,
    observations: Range,
    way: Way,
}

/// How the damage comes.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Evenly,
    /// Each twelfth of the life at a pace of its own, of log-deviation 0.5.
    UnsteadyUse,
    /// Only after 0.4 of the life.
    Late,
    /// In jumps of exponential size, ten times the scatter in the mean.
    Bouts,
}

const AS_DESCRIBED: Kind = Kind {
    name: "as described",
    rate: (1.5, 4.5),
    exponent: (1.5, 3.5),
    scatter: (5e-4, 5e-3),
    noise: (0.005, 0.03),
    observations: (10.0, 61.0),
    way: Way::Evenly,
};

const KINDS: [Kind; 12] = [
    AS_DESCRIBED,
    Kind { name: "narrower", rate: (1.5, 3.0), exponent: (1.5, 2.5), scatter: (3e-4, 3e-3), ..AS_DESCRIBED },
    Kind { name: "milder", rate: (0.8, 2.5), exponent: (1.2, 2.0), ..AS_DESCRIBED },
    Kind { name: "sharper", rate: (3.5, 6.0), exponent: (2.5, 4.0), ..AS_DESCRIBED },
    Kind { name: "less scatter", scatter: (1e-4, 7e-4), ..AS_DESCRIBED },
    Kind { name: "more scatter", scatter: (4e-3, 2e-2), ..AS_DESCRIBED },
    Kind { name: "more noise", noise: (0.03, 0.08), ..AS_DESCRIBED },
    Kind { name: "few observations", observations: (6.0, 15.0), ..AS_DESCRIBED },
    Kind { name: "many observations", observations: (60.0, 200.0), ..AS_DESCRIBED },
    Kind { name: "unsteady use", way: Way::UnsteadyUse, ..AS_DESCRIBED },
    Kind { name: "late growth", way: Way::Late, ..AS_DESCRIBED },
    Kind { name: "bouts", way: Way::Bouts, ..AS_DESCRIBED },
];

fn log_uniform((low, high): Range, random: &mut impl Rng) -> f64 {
    random.random_range(low.ln()..high.ln()).exp()
}

/// One life: the index at every step until its end, that end in steps.
struct Life {
    index: Vec<f64>,
    end: f64,
}

/// Draws a life; none when it lasts too long.
fn life(kind: &Kind, shape: u64, random: &mut Xoshiro256PlusPlus) -> Option<Life> {
    let (low, high) = if shape == 1 { kind.rate } else { kind.exponent };
    let curve = random.random_range(low..high);
    let scatter = log_uniform(kind.scatter, random);
    let growth = |part: f64| match (kind.way, shape) {
        (Way::Late, _) => ((part - 0.4).max(0.0) / 0.6).powf(1.0 + 0.5 * shape as f64),
        (_, 0) => part,
        (_, 1) => (curve * part).exp_m1() / curve.exp_m1(),
        _ => part.powf(curve),
    };
    let deviate: f64 = StandardNormal.sample(random);
    let mut index = vec![1.0 - 0.015 * deviate.abs().min(3.0)];
    let (way, mut part, mut pace) = (index[0] - END, 0.0, 1.0);
    for step in 0..STEPS_MAX {
        if kind.way == Way::UnsteadyUse && step % (STEPS / 12) == 0 {
            let deviate: f64 = StandardNormal.sample(random);
            pace = (0.5 * deviate - 0.125).exp();
        }
        let next = part + pace / STEPS as f64;
        let mean = way * (growth(next) - growth(part));
        part = next;
        let grown = if mean <= 0.0 {
            0.0
        } else if kind.way == Way::Bouts {
            let size = 10.0 * scatter;
            if random.random::<f64>() < mean / size { -size * (1.0 - random.random::<f64>()).ln() } else { 0.0 }
        } else {
            Gamma::new(mean / scatter, scatter).expect("both are above 0").sample(random)
        };
        let before = index[step];
        index.push(before - grown);
        if before - grown <= END {
            return Some(Life { index, end: step as f64 + (before - END) / grown });
        }
    }
    None
}

/// The observations of a life of 300 to 6000 h, and its end.
fn history(kind: &Kind, number: u64, random: &mut Xoshiro256PlusPlus) -> (Vec<Observation>, f64) {
    let Life { index, end } =
        std::iter::repeat_with(|| life(kind, number % 3, random)).flatten().next().expect("endless");
    let step = log_uniform((300.0, 6000.0), random) / STEPS as f64;
    let noise = random.random_range(kind.noise.0..kind.noise.1);
    let count = random.random_range(kind.observations.0..kind.observations.1) as usize;
    let mut times: Vec<f64> = (1..count).map(|_| random.random_range(0.0..end)).collect();
    times.push(0.0);
    times.sort_by(f64::total_cmp);
    let observe = |time: f64| {
        let (at, deviate): (usize, f64) = (time as usize, StandardNormal.sample(random));
        let value = index[at] + (index[at + 1] - index[at]) * time.fract() + noise * deviate;
        Observation { usage: time * step, value, std: None }
    };
    (times.into_iter().map(observe).collect(), end * step)
}

fn scored(observations: &[Observation], at: f64, end: f64) -> Option<Scored> {
    let question = Question {
        threshold: END,
        direction: Direction::Falling,
        healthy: None,
        at,
        life_start: None,
        horizon: None,
        risk_window: 0.0,
        prior: LifePrior::Age,
    };
    let prognosis = remaining_life(observations, &question).expect("a sound history");
    Scored::of_prognosis(0.0, at, end, &prognosis)
}

fn main() {
    println!("{:18} forecasts    MRA  alpha-lambda  nCRPS  50 % coverage  90 % coverage", "histories");
    for kind in KINDS {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let histories: Vec<Vec<Scored>> = (0..HISTORIES)
            .map(|number| {
                let (observations, end) = history(&kind, number, &mut random);
                ASKED.iter().filter_map(|part| scored(&observations, part * end, end)).collect()
            })
            .collect();
        let Figures { forecasts, mra, alpha_lambda, ncrps, coverage_50, coverage_90, .. } =
            figures(&histories, &Criteria::default()).expect("forecasts");
        println!(
            "{:18} {forecasts:9} {mra:6.3} {alpha_lambda:13.3} {ncrps:6.3} {coverage_50:14.3} {coverage_90:14.3}",
            kind.name
        );
    }
}
