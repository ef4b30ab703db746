//! The box that a search stays in.

use rand::RngExt;

use crate::numeric::rng::Seed;

/// One value for each variable, in the variables' own units.
pub type Candidate = Vec<f64>;

/// Lower and upper bounds of every variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Bounds {
    /// Bounds from (lower, upper) pairs.
    ///
    /// # Panics
    /// When there is no variable, or a lower bound is not below its upper one, or one is not finite.
    #[must_use]
    pub fn new(pairs: &[(f64, f64)]) -> Self {
        assert!(!pairs.is_empty(), "a search needs a variable");
        let good = |&(lower, upper): &(f64, f64)| lower.is_finite() && upper.is_finite() && lower < upper;
        assert!(pairs.iter().all(good), "every lower bound must be finite and below its upper one: {pairs:?}");
        let (lower, upper) = pairs.iter().copied().unzip();
        Self { lower, upper }
    }

    /// Number of variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.lower.len()
    }

    /// The width of a variable's interval.
    #[must_use]
    pub fn width(&self, variable: usize) -> f64 {
        self.upper[variable] - self.lower[variable]
    }

    /// The middle of a variable's interval.
    #[must_use]
    pub fn middle(&self, variable: usize) -> f64 {
        0.5 * (self.lower[variable] + self.upper[variable])
    }

    /// The point at these fractions of every interval.
    pub fn at(&self, mut fraction: impl FnMut(usize) -> f64) -> Candidate {
        (0..self.variables()).map(|i| self.lower[i] + fraction(i) * self.width(i)).collect()
    }

    /// Random points, uniform inside.
    #[must_use]
    pub fn random(&self, number: usize, seed: Seed) -> Vec<Candidate> {
        let mut rng = seed.stream("creation", 0);
        (0..number).map(|_| self.at(|_| rng.random())).collect()
    }

    /// Whether a candidate lies inside, bounds included.
    #[must_use]
    pub fn contain(&self, candidate: &[f64]) -> bool {
        candidate.iter().zip(&self.lower).zip(&self.upper).all(|((x, low), high)| (low..=high).contains(&x))
    }

    /// The nearest point inside.
    #[must_use]
    pub fn clip(&self, mut candidate: Candidate) -> Candidate {
        for (i, x) in candidate.iter_mut().enumerate() {
            *x = x.clamp(self.lower[i], self.upper[i]);
        }
        candidate
    }
}
