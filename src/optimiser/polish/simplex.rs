//! The downhill simplex of Nelder and Mead (Computer Journal 7, 1965) within bounds, every move of an iteration asked at
//! once: candidates in lock-step cost little more than one. A simplex that has shrunk to a point starts again from there
//! until that gains nothing, for on a bound it can collapse away from the optimum.

use crate::optimiser::{Best, Bounds, Candidate, Search, StopReason, key, ranking};

/// Reflection, expansion, outer and inner contraction: where each puts the worst vertex on the line through the
/// centre of the others, in units of its distance to it.
const MOVES: [f64; 4] = [1.0, 2.0, 0.5, -0.5];
/// How far the others come towards the best when nothing helps.
const SHRINK: f64 = 0.5;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Width of the first simplex, as a part of each interval.
    pub width: f64,
    /// The width at which it has converged.
    pub width_min: f64,
    /// The most iterations.
    pub iterations: usize,
    /// A cost that is as good as zero.
    pub cost_enough: f64,
}

/// A downhill simplex under way.
#[derive(Debug)]
pub struct Simplex {
    bounds: Bounds,
    settings: Settings,
    /// Best first; empty costs before the first evaluation.
    vertices: Vec<Candidate>,
    costs: Vec<f64>,
    asked: Vec<Candidate>,
    iteration: usize,
    best: Best,
    /// The best cost when the present simplex started; infinite for the first.
    cost_at_start: f64,
    converged: bool,
}

impl Simplex {
    /// A search from a start.
    #[must_use]
    pub fn new(bounds: &Bounds, start: &[f64], settings: Settings) -> Self {
        let start = bounds.clip(start.to_vec());
        Self {
            bounds: bounds.clone(),
            settings,
            vertices: around(bounds, &start, settings.width),
            costs: Vec::new(),
            asked: Vec::new(),
            iteration: 0,
            best: Best::unknown(start),
            cost_at_start: f64::INFINITY,
            converged: false,
        }
    }

    /// Ends the search, or starts again from the best if the simplex that has shrunk to a point gained anything.
    fn end_or_restart(&mut self) {
        if self.best.cost <= self.settings.cost_enough {
            self.converged = true;
        } else if self.width() <= self.settings.width_min {
            self.converged = self.best.cost >= self.cost_at_start;
            self.cost_at_start = self.best.cost;
            self.vertices = around(&self.bounds, &self.best.candidate, self.settings.width);
            self.costs.clear();
        }
    }

    /// The largest distance of a vertex from the best, as a part of an interval.
    fn width(&self) -> f64 {
        let from_best = |vertex: &Candidate| {
            (0..vertex.len())
                .map(|i| (vertex[i] - self.vertices[0][i]).abs() / self.bounds.width(i))
                .fold(0.0, f64::max)
        };
        self.vertices.iter().map(from_best).fold(0.0, f64::max)
    }

    fn moves(&self) -> Vec<Candidate> {
        let (worst, others) = self.vertices.split_last().expect("a simplex has vertices");
        let centre = |i: usize| others.iter().map(|v| v[i]).sum::<f64>() / others.len() as f64;
        let centre: Vec<f64> = (0..worst.len()).map(centre).collect();
        let mut moves: Vec<Candidate> = MOVES
            .iter()
            .map(|reach| (0..worst.len()).map(|i| centre[i] + reach * (centre[i] - worst[i])).collect())
            .map(|candidate| self.bounds.clip(candidate))
            .collect();
        let best = &self.vertices[0];
        for vertex in &self.vertices[1..] {
            moves.push(best.iter().zip(vertex).map(|(b, v)| b + SHRINK * (v - b)).collect());
        }
        moves
    }

    /// The move that Nelder and Mead's rules take, or `None` for the shrink.
    fn choose(&self, costs: &[f64]) -> Option<usize> {
        let [reflected, expanded, outer, inner] = [0, 1, 2, 3].map(|i| key(costs[i]));
        let n = self.costs.len();
        let (best, second_worst, worst) = (self.costs[0], self.costs[n - 2], self.costs[n - 1]);
        if reflected < best {
            Some(usize::from(expanded < reflected))
        } else if reflected < second_worst {
            Some(0)
        } else if reflected < worst {
            (outer <= reflected).then_some(2)
        } else {
            (inner < worst).then_some(3)
        }
    }

    fn sort(&mut self) {
        let order = ranking(&self.costs);
        self.vertices = order.iter().map(|&i| std::mem::take(&mut self.vertices[i])).collect();
        self.costs = order.iter().map(|&i| self.costs[i]).collect();
    }
}

impl Search for Simplex {
    fn ask(&mut self) -> &[Candidate] {
        self.asked = if self.costs.is_empty() { self.vertices.clone() } else { self.moves() };
        &self.asked
    }

    fn tell(&mut self, costs: &[f64]) {
        assert_eq!(costs.len(), self.asked.len(), "one cost for each candidate asked");
        self.best.improve(&self.asked, costs);
        let costs: Vec<f64> = costs.iter().map(|&c| key(c)).collect();
        if self.costs.is_empty() {
            self.costs = costs;
        } else if let Some(chosen) = self.choose(&costs) {
            *self.vertices.last_mut().expect("a simplex has vertices") = self.asked[chosen].clone();
            *self.costs.last_mut().expect("a simplex has costs") = costs[chosen];
        } else {
            for i in 1..self.vertices.len() {
                let shrunk = MOVES.len() + i - 1;
                self.vertices[i].clone_from(&self.asked[shrunk]);
                self.costs[i] = costs[shrunk];
            }
        }
        self.sort();
        self.iteration += 1;
        self.end_or_restart();
    }

    fn stop(&self) -> Option<StopReason> {
        if self.converged {
            Some(StopReason::Converged)
        } else {
            (self.iteration > self.settings.iterations).then_some(StopReason::BudgetUsed)
        }
    }

    fn best(&self) -> &Best {
        &self.best
    }
}

/// The vertices of a new simplex: a start, and a step from it along each variable, away from a bound that is near.
fn around(bounds: &Bounds, start: &Candidate, width: f64) -> Vec<Candidate> {
    let mut vertices = vec![start.clone()];
    for variable in 0..bounds.variables() {
        let mut vertex = start.clone();
        vertex[variable] += width * bounds.width(variable);
        if !bounds.contain(&vertex) {
            vertex[variable] = start[variable] - width * bounds.width(variable);
        }
        vertices.push(bounds.clip(vertex));
    }
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimiser::functions::{kinked, rosenbrock, run, sphere};

    const SETTINGS: Settings = Settings { width: 0.05, width_min: 1e-8, iterations: 500, cost_enough: 1e-9 };

    fn polish(function: fn(&[f64]) -> f64, start: [f64; 2]) -> (Best, usize, Option<StopReason>) {
        let bounds = Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)]);
        let mut simplex = Simplex::new(&bounds, &start, SETTINGS);
        let (best, evaluations) = run(&mut simplex, &bounds, function);
        (best, evaluations, simplex.stop())
    }

    #[test]
    fn reaches_the_optimum_of_three_functions_and_says_that_it_converged() {
        for function in [sphere as fn(&[f64]) -> f64, rosenbrock, kinked] {
            for start in [[0.0, 0.0], [1.9, -1.9], [2.0, 2.0]] {
                let (best, evaluations, stop) = polish(function, start);
                assert!(best.cost < 1e-6, "from {start:?}: {best:?} after {evaluations}");
                assert_eq!(stop, Some(StopReason::Converged));
            }
        }
    }

    #[test]
    fn finds_an_optimum_on_the_bound() {
        let (best, ..) = polish(|x| sphere(&[x[0] + 5.0, x[1]]), [0.0, 0.0]);
        assert!(best.candidate[0] == -2.0 && (best.candidate[1] - 0.3).abs() < 1e-4, "{best:?}");
    }

    #[test]
    fn zero_iterations_returns_the_best_vertex_of_the_first_simplex() {
        let bounds = Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)]);
        let mut simplex = Simplex::new(&bounds, &[0.3, 0.3], Settings { iterations: 0, ..SETTINGS });
        let (best, evaluations) = run(&mut simplex, &bounds, sphere);
        assert_eq!((best.candidate, evaluations), (vec![0.3, 0.3], 3));
    }

    #[test]
    fn a_cost_that_is_not_finite_never_wins() {
        let (best, ..) = polish(|x| if x[0] > 1.0 { f64::NAN } else { sphere(x) }, [0.99, 0.0]);
        assert!(best.cost < 1e-6, "{best:?}");
    }
}
