//! Differential evolution (Storn and Price, Journal of Global Optimization 11, 1997), the variant rand/1/bin.

use rand::{Rng, RngExt};

use super::frame::Frame;
use super::{Best, Bounds, Candidate, Search, StopReason, key};
use crate::numeric::rng::Seed;

/// Weight of the difference of two candidates (F) and probability that a variable is taken from the mutant (CR): the
/// settings that its authors name to begin with are 0.5 and 0.9; a little more weight keeps a small population apart.
const WEIGHT: f64 = 0.6;
const CROSSOVER: f64 = 0.9;

/// A differential evolution under way.
#[derive(Debug)]
pub struct Differential {
    frame: Frame,
    members: Vec<Candidate>,
    costs: Vec<f64>,
    asked: Vec<Candidate>,
}

impl Differential {
    /// A search within bounds.
    ///
    /// # Panics
    /// When the population is below 4: a mutant is made of three members beside its own.
    #[must_use]
    pub fn new(bounds: &Bounds, population: usize, generations: usize, seed: Seed) -> Self {
        let frame = Frame::new(bounds, population, 4, generations, seed);
        Self { frame, members: Vec::new(), costs: Vec::new(), asked: Vec::new() }
    }

    /// A rival of one member: a third, displaced by the difference of two others, crossed with the member.
    fn rival(&self, own: usize, rng: &mut impl Rng) -> Candidate {
        let [base, plus, minus] = others(own, self.frame.population, rng);
        let member = &self.members[own];
        // One variable at least is the mutant's.
        let sure = rng.random_range(0..member.len());
        let rival = (0..member.len())
            .map(|i| {
                let mutant = self.members[base][i] + WEIGHT * (self.members[plus][i] - self.members[minus][i]);
                if rng.random::<f64>() < CROSSOVER || i == sure { mutant } else { member[i] }
            })
            .collect();
        self.frame.bounds.clip(rival)
    }
}

/// Three members, all different from each other and from one.
fn others(own: usize, population: usize, rng: &mut impl Rng) -> [usize; 3] {
    let mut taken = [own; 4];
    for place in 1..4 {
        taken[place] = loop {
            let drawn = rng.random_range(0..population);
            if !taken[..place].contains(&drawn) {
                break drawn;
            }
        };
    }
    [taken[1], taken[2], taken[3]]
}

impl Search for Differential {
    fn ask(&mut self) -> &[Candidate] {
        self.asked = if self.members.is_empty() {
            self.frame.first()
        } else {
            let mut rng = self.frame.stream("differences");
            (0..self.frame.population).map(|own| self.rival(own, &mut rng)).collect()
        };
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        let asked = std::mem::take(&mut self.asked);
        self.frame.tell(&asked, costs);
        if self.members.is_empty() {
            (self.members, self.costs) = (asked, costs.to_vec());
        } else {
            for (own, (rival, &cost)) in asked.into_iter().zip(costs).enumerate() {
                if key(cost) <= key(self.costs[own]) {
                    (self.members[own], self.costs[own]) = (rival, cost);
                }
            }
        }
    }

    fn stop(&self) -> Option<StopReason> {
        self.frame.stop()
    }

    fn best(&self) -> &Best {
        &self.frame.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::functions::{conforms, rastrigin, run};

    #[test]
    fn conforms_to_what_is_asked_of_every_search() {
        conforms(Differential::new, [0.05, 0.5, 1.0]);
    }

    #[test]
    fn finds_the_lowest_of_many_minima() {
        let bounds = Bounds::new(&[(-3.0, 3.0); 3]);
        for seed in 0..5 {
            let (best, _) = run(&mut Differential::new(&bounds, 40, 300, Seed(seed)), &bounds, rastrigin);
            assert!(best.cost < 1e-3, "seed {seed}: {best:?}");
        }
    }

    #[test]
    fn the_three_members_of_a_mutant_differ_from_each_other_and_from_its_rival() {
        let mut rng = Seed(1).stream("test", 0);
        for _ in 0..1000 {
            let [a, b, c] = others(2, 4, &mut rng);
            let mut all = [a, b, c, 2];
            all.sort_unstable();
            assert_eq!(all, [0, 1, 2, 3]);
        }
    }
}
