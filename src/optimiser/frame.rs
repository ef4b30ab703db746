//! What every search with a population of a fixed size keeps beside its own state.

use rand::Rng;

use super::{Best, Bounds, Candidate, StopReason};
use crate::numeric::rng::Seed;

/// Bounds, budget, seed and the best so far.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) bounds: Bounds,
    pub(super) population: usize,
    pub(super) generations: usize,
    /// Generations that were told.
    pub(super) generation: usize,
    pub(super) best: Best,
    seed: Seed,
}

impl Frame {
    /// A search that has not begun.
    ///
    /// # Panics
    /// When the population is smaller than the method's `least`.
    pub(super) fn new(bounds: &Bounds, population: usize, least: usize, generations: usize, seed: Seed) -> Self {
        assert!(population >= least, "a population of {population} is too small, expected at least {least}");
        let best = Best::unknown(bounds.at(|_| 0.5));
        Self { bounds: bounds.clone(), population, generations, generation: 0, best, seed }
    }

    /// The first generation: random points within the bounds.
    pub(super) fn first(&self) -> Vec<Candidate> {
        self.bounds.random(self.population, self.seed)
    }

    /// This generation's stream of random draws for a purpose.
    pub(super) fn stream(&self, name: &str) -> impl Rng + use<> {
        self.seed.stream(name, self.generation as u64)
    }

    /// Notes a generation's costs, in the order asked.
    pub(super) fn tell(&mut self, asked: &[Candidate], costs: &[f64]) {
        assert_eq!(costs.len(), asked.len(), "one cost for each candidate asked");
        self.best.improve(asked, costs);
        self.generation += 1;
    }

    /// The end, once every generation was told.
    pub(super) fn stop(&self) -> Option<StopReason> {
        (self.generation > self.generations).then_some(StopReason::BudgetUsed)
    }
}
