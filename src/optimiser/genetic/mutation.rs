//! Mutation: a random change of one parent (section 7.1).

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use crate::optimiser::{Bounds, Candidate};

/// How a parent is changed. Reaches are parts of each variable's interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mutation {
    /// A normal number is added to every variable; its deviation falls over the generations.
    Gaussian {
        /// The deviation at the first generation, above 0.
        scale: f64,
        /// The part of it that is lost by the last, 0 to 1.
        shrink: f64,
    },
    /// Each variable is replaced, with a probability, by a number that is uniform over its interval.
    Uniform {
        /// That probability, 0 to 1; the thesis names 0.001 to 0.01.
        rate: f64,
    },
    /// A step in a random direction whose length adapts to the last generation's success, within the bounds. The thesis's choice.
    AdaptiveFeasible,
}

/// The reach of the adaptive mutation: at the start, at most and at least.
const REACH: (f64, f64, f64) = (0.25, 0.5, 1e-4);
/// It grows by this factor after a generation that improved the best, and shrinks by it after one that did not.
const REACH_FACTOR: f64 = 2.0;

/// A mutation under way.
#[derive(Debug)]
pub(super) struct Mutator {
    mutation: Mutation,
    reach: f64,
}

impl Mutator {
    pub(super) fn new(mutation: Mutation) -> Self {
        let reach = if let Mutation::Gaussian { scale, .. } = mutation { scale } else { REACH.0 };
        Self { mutation, reach }
    }

    /// Learns how the last generation did, and how far the search has come, 0 to 1.
    pub(super) fn adapt(&mut self, improved: bool, progress: f64) {
        match self.mutation {
            Mutation::Gaussian { scale, shrink } => self.reach = scale * (1.0 - shrink * progress),
            Mutation::Uniform { .. } => {}
            Mutation::AdaptiveFeasible => {
                let factor = if improved { REACH_FACTOR } else { 1.0 / REACH_FACTOR };
                self.reach = (self.reach * factor).clamp(REACH.2, REACH.1);
            }
        }
    }

    /// A changed copy, within the bounds.
    pub(super) fn mutate(&self, parent: &Candidate, bounds: &Bounds, rng: &mut impl Rng) -> Candidate {
        match self.mutation {
            Mutation::Gaussian { .. } => {
                let mut draw = || -> f64 { StandardNormal.sample(rng) };
                let moved = parent.iter().enumerate().map(|(i, x)| x + self.reach * bounds.width(i) * draw());
                bounds.clip(moved.collect())
            }
            Mutation::Uniform { rate } => {
                let fresh = bounds.at(|_| rng.random());
                parent.iter().zip(fresh).map(|(&x, new)| if rng.random::<f64>() < rate { new } else { x }).collect()
            }
            Mutation::AdaptiveFeasible => step_inside(parent, bounds, self.reach, rng),
        }
    }
}

/// A step in a random direction, halved until it ends inside the bounds.
fn step_inside(parent: &Candidate, bounds: &Bounds, reach: f64, rng: &mut impl Rng) -> Candidate {
    let direction: Vec<f64> = parent.iter().map(|_| StandardNormal.sample(rng)).collect();
    let mut reach = reach;
    loop {
        let moved: Candidate = (0..parent.len()).map(|i| parent[i] + reach * direction[i] * bounds.width(i)).collect();
        if bounds.contain(&moved) {
            return moved;
        }
        reach *= 0.5;
        if reach < f64::EPSILON {
            return parent.clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::rng::Seed;

    fn bounds() -> Bounds {
        Bounds::new(&[(0.0, 1.0), (-100.0, 100.0)])
    }

    fn mutants(mutation: Mutation, progress: f64) -> Vec<Candidate> {
        let mut mutator = Mutator::new(mutation);
        mutator.adapt(true, progress);
        let mut rng = Seed(1).stream("test", 0);
        let mutants: Vec<Candidate> = (0..2000).map(|_| mutator.mutate(&vec![0.5, 0.0], &bounds(), &mut rng)).collect();
        assert!(mutants.iter().all(|m| bounds().contain(m)));
        mutants
    }

    fn deviation(mutants: &[Candidate], variable: usize, centre: f64) -> f64 {
        (mutants.iter().map(|m| (m[variable] - centre).powi(2)).sum::<f64>() / mutants.len() as f64).sqrt()
    }

    #[test]
    fn validate_section_7_1_gaussian_mutation_adds_normal_numbers_that_shrink_over_the_generations() {
        for (progress, expected) in [(0.0, 0.1), (0.5, 0.06), (1.0, 0.02)] {
            let found = mutants(Mutation::Gaussian { scale: 0.1, shrink: 0.8 }, progress);
            assert!((deviation(&found, 0, 0.5) / expected - 1.0).abs() < 0.06);
            assert!((deviation(&found, 1, 0.0) / (200.0 * expected) - 1.0).abs() < 0.06);
        }
    }

    #[test]
    fn validate_section_7_1_uniform_mutation_replaces_each_variable_with_its_rate() {
        let found = mutants(Mutation::Uniform { rate: 0.2 }, 0.0);
        let changed = found.iter().filter(|m| m[0] != 0.5).count();
        assert!(changed.abs_diff(400) < 75, "{changed}");
        assert!(found.iter().any(|m| m[1] < -80.0) && found.iter().any(|m| m[1] > 80.0));
    }

    #[test]
    fn validate_section_7_1_the_adaptive_mutation_reaches_further_after_success_than_after_failure() {
        let reached = |improved: bool| {
            let mut mutator = Mutator::new(Mutation::AdaptiveFeasible);
            (0..4).for_each(|_| mutator.adapt(improved, 0.0));
            let mut rng = Seed(1).stream("test", 0);
            let found: Vec<Candidate> =
                (0..500).map(|_| mutator.mutate(&vec![0.5, 0.0], &bounds(), &mut rng)).collect();
            deviation(&found, 0, 0.5)
        };
        assert!(reached(true) > 5.0 * reached(false));
    }
}
