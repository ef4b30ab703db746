//! Optimisers: they minimise a cost over bounds and have never heard of valves.
//!
//! Whoever runs one owns the loop: ask for candidates, evaluate them in any way and on any number of threads, tell the
//! costs in the order asked. Cancellation, progress and batching come free.

pub mod bounds;
pub mod differential;
mod frame;
#[cfg(test)]
mod functions;
pub mod genetic;
pub mod polish;
pub mod swarm;

pub use bounds::{Bounds, Candidate};

/// Why a search ended: a normal end, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The generations or iterations that were allowed are used up.
    BudgetUsed,
    /// The candidates have come as close together as was asked for.
    Converged,
}

/// The best candidate so far and its cost; the cost is infinite before the first evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// The candidate.
    pub candidate: Candidate,
    /// Its cost.
    pub cost: f64,
}

/// An optimiser that does not own the loop.
pub trait Search {
    /// The candidates to evaluate next. All randomness happens here, serially.
    fn ask(&mut self) -> &[Candidate];
    /// Their costs, in the order asked. NaN counts as infinite.
    fn tell(&mut self, costs: &[f64]);
    /// Why the search has ended, once it has.
    fn stop(&self) -> Option<StopReason>;
    /// The best candidate so far.
    fn best(&self) -> &Best;
}

/// The cost to compare by: NaN and the infinities are the worst.
pub(crate) fn key(cost: f64) -> f64 {
    if cost.is_finite() { cost } else { f64::INFINITY }
}

/// The indices of costs from best to worst. Ties keep their order, so that a sort is reproducible.
pub(crate) fn ranking(costs: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| key(costs[a]).total_cmp(&key(costs[b])).then(a.cmp(&b)));
    order
}

impl Best {
    /// Nothing found yet: a starting point of unknown cost.
    pub(crate) fn unknown(candidate: Candidate) -> Self {
        Self { candidate, cost: f64::INFINITY }
    }

    /// Takes over the best of some candidates where it is better.
    pub(crate) fn improve(&mut self, candidates: &[Candidate], costs: &[f64]) {
        if let Some(&first) = ranking(costs).first().filter(|&&first| key(costs[first]) < self.cost) {
            *self = Self { candidate: candidates[first].clone(), cost: costs[first] };
        }
    }
}
