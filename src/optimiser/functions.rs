//! Standard test functions, a loop that runs a search on one, and what is asked of every search.

use super::{Best, Bounds, Candidate, Search};
use crate::numeric::rng::Seed;

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

/// Rastrigin's egg box, minimum 0 at 0.3 in every variable, with local minima a unit apart.
pub fn rastrigin(x: &[f64]) -> f64 {
    let one = |v: &f64| {
        let d = v - 0.3;
        10.0 + d * d - 10.0 * (std::f64::consts::TAU * d).cos()
    };
    x.iter().map(one).sum()
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

/// All that a search asks for over a run.
fn trace(mut search: impl Search, function: Function) -> Vec<Candidate> {
    let mut all = Vec::new();
    while search.stop().is_none() {
        let asked = search.ask().to_vec();
        search.tell(&asked.iter().map(|c| function(c)).collect::<Vec<_>>());
        all.extend(asked);
    }
    all
}

/// What every search with a population must do: come within `enough` of the optimum of the sphere, Rosenbrock's valley and the
/// kinked function with 40 candidates and 10 generations, from any of twenty seeds; never leave its bounds; repeat itself
/// for the same seed and not for another; end with the best of the first candidates when no generation follows; and never
/// let a cost win that is not finite. `make` takes bounds, population, generations and seed.
pub fn conforms<S: Search>(make: impl Fn(&Bounds, usize, usize, Seed) -> S, enough: [f64; 3]) {
    let bounds = Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)]);
    for (function, enough) in [sphere as Function, rosenbrock, kinked].into_iter().zip(enough) {
        for seed in 0..20 {
            let (best, evaluations) = run(&mut make(&bounds, 40, 10, Seed(seed)), &bounds, function);
            assert!(best.cost < enough, "seed {seed}: {best:?}");
            assert_eq!(function(&best.candidate), best.cost);
            assert!(evaluations <= 40 * 11, "{evaluations} evaluations");
        }
    }
    let traced = |seed: u64| trace(make(&bounds, 12, 5, Seed(seed)), rosenbrock);
    assert_eq!(traced(5), traced(5));
    assert_ne!(traced(5), traced(6));

    let first: Vec<f64> = make(&bounds, 40, 0, Seed(1)).ask().iter().map(|c| sphere(c)).collect();
    let (best, evaluations) = run(&mut make(&bounds, 40, 0, Seed(1)), &bounds, sphere);
    assert_eq!(evaluations, first.len());
    assert_eq!(best.cost, first.iter().copied().fold(f64::INFINITY, f64::min));

    let holes: Function = |x| match x[0] {
        a if a < -0.5 => f64::NAN,
        a if a > 1.5 => f64::NEG_INFINITY,
        _ => sphere(x),
    };
    let (best, _) = run(&mut make(&bounds, 40, 10, Seed(1)), &bounds, holes);
    assert!((best.cost - sphere(&best.candidate)).abs() < 1e-15, "{best:?}");
    let nowhere: Function = |_| f64::NAN;
    let (best, _) = run(&mut make(&bounds, 12, 3, Seed(1)), &bounds, nowhere);
    assert!(best.cost.is_infinite() && bounds.contain(&best.candidate));
}
