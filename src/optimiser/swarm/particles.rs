//! Particle swarm optimisation (Kennedy and Eberhart, IEEE International Conference on Neural Networks, 1995) with the
//! constriction of Clerc and Kennedy (IEEE Transactions on Evolutionary Computation 6, 2002).

use rand::RngExt;

use super::super::frame::Frame;
use super::super::{Best, Bounds, Candidate, Search, StopReason, key};
use crate::numeric::rng::Seed;

/// Inertia, and attraction to a particle's own best and to the swarm's: Clerc and Kennedy's constriction for a sum of 4.1.
const INERTIA: f64 = 0.729_84;
const ATTRACTION: f64 = 1.496_18;
/// The most velocity, as a part of each interval.
const VELOCITY_MAX: f64 = 0.5;

/// A particle swarm under way.
#[derive(Debug)]
pub struct Particles {
    frame: Frame,
    /// Where the particles are; what is asked.
    places: Vec<Candidate>,
    velocities: Vec<Vec<f64>>,
    /// The best that each particle has seen.
    own: Vec<Best>,
}

impl Particles {
    /// A search within bounds.
    ///
    /// # Panics
    /// When there is no particle.
    #[must_use]
    pub fn new(bounds: &Bounds, population: usize, generations: usize, seed: Seed) -> Self {
        let frame = Frame::new(bounds, population, 1, generations, seed);
        Self { frame, places: Vec::new(), velocities: Vec::new(), own: Vec::new() }
    }

    fn move_on(&mut self) {
        let mut rng = self.frame.stream("attraction");
        let Frame { bounds, best, .. } = &self.frame;
        for ((place, velocity), own) in self.places.iter_mut().zip(&mut self.velocities).zip(&self.own) {
            for i in 0..place.len() {
                let (to_own, to_all): (f64, f64) = (rng.random(), rng.random());
                let pulled = INERTIA * velocity[i]
                    + ATTRACTION * to_own * (own.candidate[i] - place[i])
                    + ATTRACTION * to_all * (best.candidate[i] - place[i]);
                let most = VELOCITY_MAX * bounds.width(i);
                velocity[i] = pulled.clamp(-most, most);
            }
            let moved: Candidate = place.iter().zip(&*velocity).map(|(x, v)| x + v).collect();
            let held = bounds.clip(moved.clone());
            // A particle that met a bound stands still there.
            for i in 0..held.len() {
                if held[i] != moved[i] {
                    velocity[i] = 0.0;
                }
            }
            *place = held;
        }
    }
}

impl Search for Particles {
    fn ask(&mut self) -> &[Candidate] {
        if self.places.is_empty() {
            self.places = self.frame.first();
            self.velocities = vec![vec![0.0; self.frame.bounds.variables()]; self.places.len()];
            self.own = self.places.iter().map(|place| Best::unknown(place.clone())).collect();
        } else {
            self.move_on();
        }
        &self.places
    }

    fn tell(&mut self, costs: &[f64]) {
        self.frame.tell(&self.places, costs);
        for ((own, place), &cost) in self.own.iter_mut().zip(&self.places).zip(costs) {
            if key(cost) < own.cost {
                *own = Best { candidate: place.clone(), cost };
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
    use crate::optimiser::functions::{conforms, run, sphere};

    #[test]
    fn conforms_to_what_is_asked_of_every_search() {
        conforms(Particles::new, [0.05, 0.5, 1.0]);
    }

    #[test]
    fn the_swarm_gathers_at_the_optimum() {
        let bounds = Bounds::new(&[(-3.0, 3.0); 3]);
        let mut swarm = Particles::new(&bounds, 30, 100, Seed(1));
        let (best, _) = run(&mut swarm, &bounds, sphere);
        assert!(best.cost < 1e-8, "{best:?}");
        assert!(swarm.places.iter().all(|place| sphere(place) < 1e-2));
    }
}
