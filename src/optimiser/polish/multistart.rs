//! Many local searches at once, from starts that are spread evenly: a downhill simplex each, asked together so that a round
//! costs little more than one.

use super::simplex::{self, Simplex};
use crate::optimiser::{Best, Bounds, Candidate, Search, StopReason};

/// Several simplexes under way.
#[derive(Debug)]
pub struct Multistart {
    simplexes: Vec<Simplex>,
    /// How many candidates each of them asked for, in their order.
    shares: Vec<usize>,
    asked: Vec<Candidate>,
    evaluations: usize,
    evaluations_max: usize,
    best: Best,
}

impl Multistart {
    /// Searches from this many starts, within a number of evaluations: no round begins that, if it is as large as the
    /// last, would go beyond it.
    ///
    /// # Panics
    /// When there is no start.
    #[must_use]
    pub fn new(bounds: &Bounds, starts: usize, settings: simplex::Settings, evaluations_max: usize) -> Self {
        assert!(starts >= 1, "a search has a start");
        let simplexes: Vec<Simplex> = (0..starts).map(|k| Simplex::new(bounds, &spread(bounds, k), settings)).collect();
        Self {
            simplexes,
            shares: Vec::new(),
            asked: Vec::new(),
            evaluations: 0,
            evaluations_max,
            best: Best::unknown(spread(bounds, 0)),
        }
    }
}

/// The `k`th point of an additive recurrence over the bounds: fractions of k times the powers of the inverse of the root of
/// x^(n+1) = x + 1, which generalises the golden ratio to n variables and spreads points evenly, however many there are.
fn spread(bounds: &Bounds, k: usize) -> Candidate {
    let order = bounds.variables() as i32 + 1;
    let mut root = 2.0_f64;
    for _ in 0..60 {
        root = (1.0 + root).powf(1.0 / f64::from(order));
    }
    bounds.at(|i| (0.5 + k as f64 * root.powi(-(i as i32 + 1))).fract())
}

impl Search for Multistart {
    fn ask(&mut self) -> &[Candidate] {
        self.asked.clear();
        self.shares.clear();
        for simplex in &mut self.simplexes {
            let asked = if simplex.stop().is_none() { simplex.ask() } else { &[] };
            self.shares.push(asked.len());
            self.asked.extend_from_slice(asked);
        }
        self.evaluations += self.asked.len();
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        assert_eq!(costs.len(), self.asked.len(), "one cost for each candidate asked");
        self.best.improve(&self.asked, costs);
        let mut rest = costs;
        for (simplex, &share) in self.simplexes.iter_mut().zip(&self.shares) {
            let (own, others) = rest.split_at(share);
            if share > 0 {
                simplex.tell(own);
            }
            rest = others;
        }
    }

    fn stop(&self) -> Option<StopReason> {
        if self.evaluations + self.asked.len() > self.evaluations_max {
            return Some(StopReason::BudgetUsed);
        }
        self.simplexes.iter().all(|simplex| simplex.stop().is_some()).then_some(StopReason::Converged)
    }

    fn best(&self) -> &Best {
        &self.best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::functions::{kinked, rastrigin, rosenbrock, run, sphere};

    const SETTINGS: simplex::Settings =
        simplex::Settings { width: 0.05, width_min: 1e-7, iterations: 400, cost_enough: 1e-12 };

    fn bounds() -> Bounds {
        Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)])
    }

    #[test]
    fn finds_the_optimum_of_smooth_narrow_kinked_and_many_humped_functions() {
        for function in [sphere, rosenbrock, kinked, rastrigin] {
            let (best, _) = run(&mut Multistart::new(&bounds(), 16, SETTINGS, 20_000), &bounds(), function);
            assert!(best.cost < 1e-7, "{best:?}");
        }
    }

    #[test]
    fn keeps_to_its_budget_and_a_cost_that_is_not_finite_never_wins() {
        let mut search = Multistart::new(&bounds(), 5, SETTINGS, 100);
        let holes = |x: &[f64]| if x[0] < 0.0 { f64::NAN } else { sphere(x) };
        let (best, evaluations) = run(&mut search, &bounds(), holes);
        assert!((60..=100).contains(&evaluations), "{evaluations}");
        assert_eq!(search.stop(), Some(StopReason::BudgetUsed));
        assert_eq!(best.cost, sphere(&best.candidate));
    }

    #[test]
    fn starts_are_spread_evenly_however_many() {
        for n in [16, 64, 256] {
            let starts: Vec<Candidate> = (0..n).map(|k| spread(&bounds(), k)).collect();
            // Each quarter of the square has its quarter of the starts, but for a few.
            for (right, up) in [(false, false), (false, true), (true, false), (true, true)] {
                let inside = starts.iter().filter(|s| (s[0] > 0.0, s[1] > 0.0) == (right, up)).count();
                assert!(inside.abs_diff(n / 4) <= 2 + n / 64, "{inside} of {n}");
            }
        }
    }
}
