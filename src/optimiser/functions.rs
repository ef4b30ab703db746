//! Standard test functions and a loop that runs a search on one.

use super::{Best, Bounds, Candidate, Search};

/// A cost function.
pub type Function = fn(&[f64]) -> f64;

/// A smooth bowl with its minimum 0 at 0.3 in every variable.
pub fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|v| (v - 0.3).powi(2)).sum()
}

/// Rosenbrock's valley in two variables, minimum 0 at (1, 1).
pub fn rosenbrock(x: &[f64]) -> f64 {
    (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2)
}

/// A sum of magnitudes of two coupled lines, minimum 0 at (0.7, -0.4): kinked, as the features objective is.
pub fn kinked(x: &[f64]) -> f64 {
    10.0 * ((x[0] - 0.7) + 0.1 * (x[1] + 0.4)).abs() + ((x[1] + 0.4) - 0.05 * (x[0] - 0.7)).abs()
}

/// Runs a search to its end, checking that it never leaves its bounds; returns the best and the evaluations.
pub fn run(search: &mut impl Search, bounds: &Bounds, function: Function) -> (Best, usize) {
    let mut evaluations = 0;
    while search.stop().is_none() {
        let asked: Vec<Candidate> = search.ask().to_vec();
        assert!(asked.iter().all(|c| bounds.contain(c)), "{asked:?} leaves the bounds");
        evaluations += asked.len();
        search.tell(&asked.iter().map(|c| function(c)).collect::<Vec<_>>());
    }
    (search.best().clone(), evaluations)
}
