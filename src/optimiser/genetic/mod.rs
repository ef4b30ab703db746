//! The genetic algorithm of section 7.1: creation, fitness scaling, selection, crossover, mutation, elitism; each of them
//! selectable, with the thesis's choices (section 7.2) as [`Choices::THESIS`]. The hybrid polish at the end is a search of
//! its own ([`super::polish`]).

mod choices;
mod crossover;
mod mutation;
mod scaling;
mod selection;

use super::{Best, Bounds, Candidate, Search, StopReason, key, ranking};
use crate::numeric::rng::Seed;
pub use choices::{Choices, ChoicesError};
pub use crossover::Crossover;
pub use mutation::Mutation;
use mutation::Mutator;
pub use scaling::Scaling;
pub use selection::Selection;

/// How the search goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Candidates in a generation, at least 4.
    pub population: usize,
    /// Generations bred after the first.
    pub generations: usize,
    /// What happens at each stage.
    pub choices: Choices,
}

impl Settings {
    /// The thesis's choices.
    #[must_use]
    pub const fn thesis(population: usize, generations: usize) -> Self {
        Self { population, generations, choices: Choices::THESIS }
    }

    /// Candidates that survive a generation.
    fn elite(&self) -> usize {
        ((self.population as f64 * self.choices.elite_share).ceil() as usize).min(self.population - 1)
    }
}

/// A genetic algorithm under way.
#[derive(Debug)]
pub struct Genetic {
    bounds: Bounds,
    settings: Settings,
    seed: Seed,
    mutator: Mutator,
    generation: usize,
    /// Candidates that the first generation begins with.
    given: Vec<Candidate>,
    /// The evaluated generation; empty before the first.
    parents: Vec<Candidate>,
    costs: Vec<f64>,
    /// What was asked; the elite of the parents is not asked again.
    asked: Vec<Candidate>,
    improved: bool,
    best: Best,
}

impl Genetic {
    /// A search within bounds, from a random population.
    ///
    /// # Panics
    /// When the population is below 4.
    #[must_use]
    pub fn new(bounds: &Bounds, settings: Settings, seed: Seed) -> Self {
        Self::from_population(bounds, settings, seed, Vec::new())
    }

    /// The same from a population that is given, clipped to the bounds; random candidates fill it up, and what is beyond its
    /// size is left out.
    ///
    /// # Panics
    /// When the population is below 4.
    #[must_use]
    pub fn from_population(bounds: &Bounds, settings: Settings, seed: Seed, given: Vec<Candidate>) -> Self {
        assert!(settings.population >= 4, "a population of {} cannot breed", settings.population);
        Self {
            bounds: bounds.clone(),
            settings,
            seed,
            mutator: Mutator::new(settings.choices.mutation),
            generation: 0,
            given,
            parents: Vec::new(),
            costs: Vec::new(),
            asked: Vec::new(),
            improved: true,
            best: Best::unknown(bounds.at(|_| 0.5)),
        }
    }

    fn create(&mut self) -> Vec<Candidate> {
        let random = self.bounds.random(self.settings.population, self.seed);
        let given = self.given.drain(..).map(|candidate| self.bounds.clip(candidate));
        given.chain(random).take(self.settings.population).collect()
    }

    fn breed(&mut self) -> Vec<Candidate> {
        let Settings { generations, choices, .. } = self.settings;
        let Choices { scaling, selection, crossover, crossover_share, .. } = choices;
        let children = self.settings.population - self.settings.elite();
        let index = self.generation as u64;
        self.mutator.adapt(self.improved, self.generation as f64 / generations as f64);
        let crossed = (children as f64 * crossover_share).round() as usize;
        let expectations = scaling.expectations(&self.costs);
        let number = 2 * crossed + children - crossed;
        let picked = selection.pick(&expectations, number, &mut self.seed.stream("selection", index));
        let (couples, singles) = picked.split_at(2 * crossed);
        let mut cross = self.seed.stream("crossover", index);
        let mut mutate = self.seed.stream("mutation", index);
        let costs = &self.costs;
        let offspring = couples.chunks(2).map(|pair| {
            let first_is_better = key(costs[pair[0]]) <= key(costs[pair[1]]);
            let (first, second) = (&self.parents[pair[0]], &self.parents[pair[1]]);
            self.bounds.clip(crossover.child(first, second, first_is_better, &mut cross))
        });
        let mutants = singles.iter().map(|&i| self.mutator.mutate(&self.parents[i], &self.bounds, &mut mutate));
        offspring.chain(mutants).collect()
    }
}

impl Search for Genetic {
    fn ask(&mut self) -> &[Candidate] {
        self.asked = if self.parents.is_empty() { self.create() } else { self.breed() };
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        assert_eq!(costs.len(), self.asked.len(), "one cost for each candidate asked");
        let elite: Vec<usize> = ranking(&self.costs).into_iter().take(self.settings.elite()).collect();
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
mod tests;
