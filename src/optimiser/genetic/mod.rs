//! The genetic algorithm of section 7.1, with the thesis's settings (section 7.2): random creation, proportional
//! scaling, stochastic uniform selection, scattered crossover, adaptive feasible mutation, elitism.

mod breed;

use super::{Best, Bounds, Candidate, Search, StopReason, ranking};
use crate::numeric::rng::Seed;
use breed::Breeder;

/// Share of a generation that survives unchanged, rounded up.
const ELITE_SHARE: f64 = 0.05;

/// How large the search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Candidates in a generation, at least 4.
    pub population: usize,
    /// Generations bred after the first, random one.
    pub generations: usize,
}

/// A genetic algorithm under way.
#[derive(Debug)]
pub struct Genetic {
    settings: Settings,
    breeder: Breeder,
    generation: usize,
    /// The evaluated generation; empty before the first.
    parents: Vec<Candidate>,
    costs: Vec<f64>,
    /// What was asked; the elite of the parents is not asked again.
    asked: Vec<Candidate>,
    improved: bool,
    best: Best,
}

impl Genetic {
    /// A search within bounds.
    ///
    /// # Panics
    /// When the population is below 4.
    #[must_use]
    pub fn new(bounds: &Bounds, settings: Settings, seed: Seed) -> Self {
        assert!(settings.population >= 4, "a population of {} cannot breed", settings.population);
        Self {
            settings,
            breeder: Breeder::new(bounds, seed),
            generation: 0,
            parents: Vec::new(),
            costs: Vec::new(),
            asked: Vec::new(),
            improved: true,
            best: Best::unknown(bounds.at(|_| 0.5)),
        }
    }

    fn elite(&self) -> usize {
        (self.settings.population as f64 * ELITE_SHARE).ceil() as usize
    }
}

impl Search for Genetic {
    fn ask(&mut self) -> &[Candidate] {
        self.asked = if self.parents.is_empty() {
            self.breeder.create(self.settings.population)
        } else {
            let children = self.settings.population - self.elite();
            self.breeder.breed(&self.parents, &self.costs, children, self.generation as u64, self.improved)
        };
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        assert_eq!(costs.len(), self.asked.len(), "one cost for each candidate asked");
        let elite: Vec<usize> = ranking(&self.costs).into_iter().take(self.elite()).collect();
        let mut parents: Vec<Candidate> = elite.iter().map(|&i| self.parents[i].clone()).collect();
        let mut all: Vec<f64> = elite.iter().map(|&i| self.costs[i]).collect();
        parents.append(&mut self.asked);
        all.extend_from_slice(costs);
        let before = self.best.cost;
        self.best.improve(&parents, &all);
        self.improved = self.best.cost < before;
        (self.parents, self.costs) = (parents, all);
        self.generation += 1;
    }

    fn stop(&self) -> Option<StopReason> {
        (self.generation > self.settings.generations).then_some(StopReason::BudgetUsed)
    }

    fn best(&self) -> &Best {
        &self.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::functions::{kinked, rosenbrock, run, sphere};

    fn search(population: usize, generations: usize, seed: u64) -> (Genetic, Bounds) {
        let bounds = Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)]);
        (Genetic::new(&bounds, Settings { population, generations }, Seed(seed)), bounds)
    }

    #[test]
    fn comes_near_the_optimum_of_three_functions_within_the_thesis_s_budget() {
        for (function, enough) in [(sphere as fn(&[f64]) -> f64, 0.05), (rosenbrock, 0.5), (kinked, 1.0)] {
            for seed in 0..20 {
                let (mut genetic, bounds) = search(40, 10, seed);
                let (best, evaluations) = run(&mut genetic, &bounds, function);
                assert!(best.cost < enough, "seed {seed}: {best:?}");
                assert_eq!(evaluations, 40 + 10 * 38);
            }
        }
    }

    #[test]
    fn determinism_the_same_seed_gives_the_same_trace_and_another_does_not() {
        let trace = |seed: u64| {
            let (mut genetic, bounds) = search(12, 5, seed);
            run(&mut genetic, &bounds, rosenbrock);
            genetic.parents
        };
        assert_eq!(trace(5), trace(5));
        assert_ne!(trace(5), trace(6));
    }

    #[test]
    fn zero_generations_returns_the_best_of_the_first() {
        let (mut genetic, bounds) = search(40, 0, 1);
        let (best, evaluations) = run(&mut genetic, &bounds, sphere);
        assert_eq!((evaluations, genetic.stop()), (40, Some(StopReason::BudgetUsed)));
        assert!(best.cost.is_finite());
    }

    #[test]
    fn a_cost_that_is_not_finite_never_wins() {
        let (mut genetic, bounds) = search(40, 10, 1);
        let (best, _) = run(&mut genetic, &bounds, |x| match x[0] {
            a if a < -0.5 => f64::NAN,
            a if a > 1.5 => f64::NEG_INFINITY,
            _ => sphere(x),
        });
        assert!((best.cost - sphere(&best.candidate)).abs() < 1e-15 && best.cost < 0.05, "{best:?}");
    }

    #[test]
    #[should_panic(expected = "cannot breed")]
    fn a_population_too_small_to_breed_is_refused() {
        let _ = search(3, 1, 1);
    }
}
