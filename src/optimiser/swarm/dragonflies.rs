//! The dragonfly algorithm (Mirjalili, Neural Computing and Applications 27, 2016): separation, alignment and cohesion among
//! neighbours, attraction to food (the best), distraction from an enemy (the worst), a Lévy flight where no one is near.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

use super::super::frame::Frame;
use super::super::{Best, Bounds, Candidate, Search, StopReason, ranking};
use crate::numeric::rng::Seed;

/// Inertia at the start and at the end.
const INERTIA: (f64, f64) = (0.9, 0.4);
/// The weight of the enemy at the start, and the most of separation, alignment and cohesion; both fall to 0 at half of the run.
const SOCIAL: f64 = 0.1;
/// The most weight of the food.
const FOOD: f64 = 2.0;
/// The neighbourhood at the start and how much it grows, as parts of each interval.
const RADIUS: (f64, f64) = (0.25, 2.0);
/// The most step, as a part of each interval.
const STEP_MAX: f64 = 0.1;
/// The exponent of the Lévy flight, and the deviation that Mantegna's method gives it.
const LEVY_BETA: f64 = 1.5;
const LEVY_SIGMA: f64 = 0.696_575;
const LEVY_SCALE: f64 = 0.01;

/// A swarm of dragonflies under way. Places and steps are kept in parts of the intervals.
#[derive(Debug)]
pub struct Dragonflies {
    frame: Frame,
    places: Vec<Vec<f64>>,
    steps: Vec<Vec<f64>>,
    asked: Vec<Candidate>,
    /// In parts of the intervals; empty before the first costs.
    food: Vec<f64>,
    enemy: Vec<f64>,
}

impl Dragonflies {
    /// A search within bounds.
    ///
    /// # Panics
    /// When there are not two dragonflies.
    #[must_use]
    pub fn new(bounds: &Bounds, population: usize, generations: usize, seed: Seed) -> Self {
        let frame = Frame::new(bounds, population, 2, generations, seed);
        let (places, steps, asked) = (Vec::new(), Vec::new(), Vec::new());
        Self { frame, places, steps, asked, food: Vec::new(), enemy: Vec::new() }
    }

    fn fly(&mut self) {
        let progress = self.frame.generation as f64 / self.frame.generations.max(1) as f64;
        let mut rng = self.frame.stream("flight");
        let inertia = INERTIA.0 + (INERTIA.1 - INERTIA.0) * progress;
        let social = (SOCIAL * (1.0 - 2.0 * progress)).max(0.0);
        let radius = RADIUS.0 + RADIUS.1 * progress;
        let (places, steps) = (self.places.clone(), self.steps.clone());
        for own in 0..self.frame.population {
            let [separation, alignment, cohesion] = [(); 3].map(|()| 2.0 * social * rng.random::<f64>());
            let food = FOOD * rng.random::<f64>();
            let near: Vec<usize> =
                (0..self.frame.population).filter(|&j| j != own && is_near(&places[j], &places[own], radius)).collect();
            let food_is_near = is_near(&self.food, &places[own], radius);
            let place = &places[own];
            for i in 0..place.len() {
                let mean = |of: &[Vec<f64>]| near.iter().map(|&j| of[j][i]).sum::<f64>() / near.len() as f64;
                let step = if near.is_empty() {
                    levy(&mut rng) * place[i]
                } else if food_is_near || near.len() > 1 {
                    let apart = -near.iter().map(|&j| places[j][i] - place[i]).sum::<f64>();
                    let pull = if food_is_near { food * (self.food[i] - place[i]) } else { 0.0 };
                    let flight =
                        if is_near(&self.enemy, place, radius) { social * (place[i] - self.enemy[i]) } else { 0.0 };
                    separation * apart
                        + alignment * mean(&steps)
                        + cohesion * (mean(&places) - place[i])
                        + pull
                        + flight
                        + inertia * steps[own][i]
                } else {
                    inertia * steps[own][i] + rng.random::<f64>() * (mean(&places) - place[i])
                };
                self.steps[own][i] = step.clamp(-STEP_MAX, STEP_MAX);
                self.places[own][i] = (place[i] + self.steps[own][i]).clamp(0.0, 1.0);
            }
        }
    }
}

/// Whether two places are within a radius of each other in every variable.
fn is_near(a: &[f64], b: &[f64], radius: f64) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= radius)
}

/// A step of a Lévy flight by Mantegna's method.
fn levy(rng: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (StandardNormal.sample(rng), StandardNormal.sample(rng));
    LEVY_SCALE * u * LEVY_SIGMA / v.abs().powf(1.0 / LEVY_BETA)
}

impl Search for Dragonflies {
    fn ask(&mut self) -> &[Candidate] {
        if self.places.is_empty() {
            let mut rng = self.frame.stream("creation");
            let variables = self.frame.bounds.variables();
            self.places = (0..self.frame.population).map(|_| (0..variables).map(|_| rng.random()).collect()).collect();
            self.steps = vec![vec![0.0; variables]; self.frame.population];
        } else {
            self.fly();
        }
        self.asked = self.places.iter().map(|place| self.frame.bounds.at(|i| place[i])).collect();
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        let before = self.frame.best.cost;
        self.frame.tell(&self.asked, costs);
        let order = ranking(costs);
        if self.food.is_empty() || self.frame.best.cost < before {
            self.food.clone_from(&self.places[order[0]]);
        }
        self.enemy.clone_from(&self.places[order[order.len() - 1]]);
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
    use crate::optimiser::functions::{conforms, run, sphere};

    #[test]
    fn conforms_to_what_is_asked_of_every_search() {
        conforms(Dragonflies::new, [0.2, 2.0, 2.0]);
    }

    #[test]
    fn the_swarm_finds_its_food() {
        let bounds = Bounds::new(&[(-3.0, 3.0); 3]);
        let (best, _) = run(&mut Dragonflies::new(&bounds, 30, 100, Seed(1)), &bounds, sphere);
        assert!(best.cost < 1e-2, "{best:?}");
    }

    #[test]
    fn the_deviation_of_the_levy_flight_is_mantegna_s() {
        use statrs::function::gamma::gamma;
        let beta = LEVY_BETA;
        let numerator = gamma(1.0 + beta) * (std::f64::consts::PI * beta / 2.0).sin();
        let denominator = gamma((1.0 + beta) / 2.0) * beta * 2f64.powf((beta - 1.0) / 2.0);
        assert!((LEVY_SIGMA - (numerator / denominator).powf(1.0 / beta)).abs() < 1e-6);
    }
}
