//! From one generation to the next: scaling, selection, crossover, mutation (section 7.1).

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::numeric::rng::Seed;
use crate::optimiser::{Bounds, Candidate, key};

/// Share of the children that come from crossover; the others are mutants.
const CROSSOVER_SHARE: f64 = 0.8;
/// The mutation's reach, as a part of each interval: at the start, at most and at least.
const REACH: (f64, f64, f64) = (0.25, 0.5, 1e-4);
/// The reach grows by this factor after a generation that improved the best, and shrinks by it after one that did not.
const REACH_FACTOR: f64 = 2.0;

/// Makes children.
#[derive(Debug)]
pub struct Breeder {
    bounds: Bounds,
    seed: Seed,
    reach: f64,
}

impl Breeder {
    pub fn new(bounds: &Bounds, seed: Seed) -> Self {
        Self { bounds: bounds.clone(), seed, reach: REACH.0 }
    }

    /// Random candidates, uniform within the bounds.
    pub fn create(&self, number: usize) -> Vec<Candidate> {
        let mut rng = self.seed.stream("creation", 0);
        (0..number).map(|_| self.bounds.at(|_| rng.random())).collect()
    }

    /// The children of one generation.
    pub fn breed(
        &mut self,
        parents: &[Candidate],
        costs: &[f64],
        children: usize,
        generation: u64,
        improved: bool,
    ) -> Vec<Candidate> {
        let factor = if improved { REACH_FACTOR } else { 1.0 / REACH_FACTOR };
        self.reach = (self.reach * factor).clamp(REACH.2, REACH.1);
        let crossed = (children as f64 * CROSSOVER_SHARE).round() as usize;
        let picked = select(&scale(costs), 2 * crossed + children - crossed, &mut self.stream("selection", generation));
        let (couples, singles) = picked.split_at(2 * crossed);
        let mut cross = self.stream("crossover", generation);
        let mut mutate = self.stream("mutation", generation);
        let offspring = couples.chunks(2).map(|pair| scatter(&parents[pair[0]], &parents[pair[1]], &mut cross));
        offspring.chain(singles.iter().map(|&single| self.mutate(&parents[single], &mut mutate))).collect()
    }

    fn stream(&self, name: &str, generation: u64) -> impl Rng + use<> {
        self.seed.stream(name, generation)
    }

    /// Adaptive feasible mutation: a step in a random direction, halved until it ends inside the bounds.
    fn mutate(&self, parent: &Candidate, rng: &mut impl Rng) -> Candidate {
        let direction: Vec<f64> = parent.iter().map(|_| StandardNormal.sample(rng)).collect();
        let mut reach = self.reach;
        loop {
            let moved: Candidate =
                (0..parent.len()).map(|i| parent[i] + reach * direction[i] * self.bounds.width(i)).collect();
            if self.bounds.contain(&moved) {
                return moved;
            }
            reach *= 0.5;
            if reach < f64::EPSILON {
                return parent.clone();
            }
        }
    }
}

/// Proportional scaling: the expectation of a candidate is as the inverse of its cost; nothing of an infinite one.
fn scale(costs: &[f64]) -> Vec<f64> {
    let least = costs.iter().map(|&c| key(c)).fold(f64::INFINITY, f64::min);
    // A cost near zero must not take the whole wheel: costs count from a hundredth of their spread.
    let worst = costs.iter().map(|&c| key(c)).filter(|c| c.is_finite()).fold(least, f64::max);
    let floor = (0.01 * (worst - least)).max(f64::MIN_POSITIVE);
    if least.is_infinite() {
        return vec![1.0; costs.len()];
    }
    costs.iter().map(|&c| if key(c).is_finite() { floor / (c - least + floor) } else { 0.0 }).collect()
}

/// Stochastic uniform selection: equal steps along a line on which each candidate has a stretch as long as its
/// expectation; then shuffled, so that couples are random.
fn select(expectations: &[f64], number: usize, rng: &mut impl Rng) -> Vec<usize> {
    let total: f64 = expectations.iter().sum();
    let step = total / number as f64;
    let mut at = step * rng.random::<f64>();
    let (mut index, mut reached) = (0, expectations[0]);
    let mut picked = Vec::with_capacity(number);
    for _ in 0..number {
        while at > reached && index + 1 < expectations.len() {
            index += 1;
            reached += expectations[index];
        }
        picked.push(index);
        at += step;
    }
    for i in (1..picked.len()).rev() {
        picked.swap(i, rng.random_range(0..=i));
    }
    picked
}

/// Scattered crossover: each variable comes from one parent or the other.
fn scatter(first: &Candidate, second: &Candidate, rng: &mut impl Rng) -> Candidate {
    first.iter().zip(second).map(|(&a, &b)| if rng.random() { a } else { b }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selection_picks_each_candidate_as_often_as_its_expectation_says() {
        let mut rng = Seed(1).stream("test", 0);
        let picked = select(&[1.0, 0.0, 3.0], 400, &mut rng);
        let count = |i: usize| picked.iter().filter(|&&p| p == i).count();
        assert!((99..=101).contains(&count(0)) && count(1) == 0, "{} {}", count(0), count(1));
    }

    #[test]
    fn scaling_prefers_the_better_and_gives_the_infinite_nothing() {
        let expectations = scale(&[1.0, 2.0, f64::NAN, 101.0]);
        assert_eq!(expectations, [1.0, 0.5, 0.0, 1.0 / 101.0]);
        assert_eq!(scale(&[f64::NAN, f64::INFINITY]), [1.0, 1.0]);
    }
}
