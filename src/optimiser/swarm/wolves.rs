//! The grey wolf optimiser (Mirjalili, Mirjalili and Lewis, Advances in Engineering Software 69, 2014).

use rand::RngExt;

use super::super::frame::Frame;
use super::super::{Best, Bounds, Candidate, Search, StopReason, ranking};
use crate::numeric::rng::Seed;

/// The wolves that lead: alpha, beta and delta.
const LEADERS: usize = 3;
/// How far wolves stray at the start (a of the paper, which falls to 0 at the end).
const STRAY: f64 = 2.0;

/// A pack under way.
#[derive(Debug)]
pub struct Wolves {
    frame: Frame,
    /// Where the wolves are; what is asked.
    places: Vec<Candidate>,
    /// The three best so far, best first.
    leaders: Vec<Best>,
}

impl Wolves {
    /// A search within bounds.
    ///
    /// # Panics
    /// When there are not three wolves to lead.
    #[must_use]
    pub fn new(bounds: &Bounds, population: usize, generations: usize, seed: Seed) -> Self {
        let frame = Frame::new(bounds, population, LEADERS, generations, seed);
        Self { frame, places: Vec::new(), leaders: Vec::new() }
    }

    /// Every wolf goes to the mean of the places that the leaders call it to.
    fn hunt(&mut self) {
        // The last generation strays a little still: at 0 it would only repeat the leaders' mean.
        let Frame { bounds, generation, generations, .. } = &self.frame;
        let stray = STRAY * (1.0 - (generation - 1) as f64 / *generations as f64);
        let mut rng = self.frame.stream("hunt");
        for place in &mut self.places {
            let mut called = vec![0.0; place.len()];
            for leader in &self.leaders {
                for (i, sum) in called.iter_mut().enumerate() {
                    let a = stray * (2.0 * rng.random::<f64>() - 1.0);
                    let c = 2.0 * rng.random::<f64>();
                    // The paper's C X - X has a preference for the origin; here the origin is the bounds' middle.
                    let middle = bounds.middle(i);
                    let (prey, own) = (leader.candidate[i] - middle, place[i] - middle);
                    *sum += middle + prey - a * (c * prey - own).abs();
                }
            }
            let count = self.leaders.len() as f64;
            *place = bounds.clip(called.iter().map(|sum| sum / count).collect());
        }
    }
}

impl Search for Wolves {
    fn ask(&mut self) -> &[Candidate] {
        if self.places.is_empty() {
            self.places = self.frame.first();
        } else {
            self.hunt();
        }
        &self.places
    }

    fn tell(&mut self, costs: &[f64]) {
        self.frame.tell(&self.places, costs);
        let seen = self.places.iter().zip(costs).map(|(place, &cost)| Best { candidate: place.clone(), cost });
        let all: Vec<Best> = self.leaders.drain(..).chain(seen).collect();
        let order = ranking(&all.iter().map(|one| one.cost).collect::<Vec<_>>());
        self.leaders = order.into_iter().take(LEADERS).map(|i| all[i].clone()).collect();
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
        conforms(Wolves::new, [0.05, 0.6, 1.0]);
    }

    #[test]
    fn the_pack_closes_in_on_the_optimum() {
        let bounds = Bounds::new(&[(-3.0, 3.0); 3]);
        let (best, _) = run(&mut Wolves::new(&bounds, 30, 100, Seed(1)), &bounds, sphere);
        assert!(best.cost < 1e-4, "{best:?}");
    }
}
