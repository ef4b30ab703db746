//! Crossover: a child of two parents (section 7.1).

use rand::{Rng, RngExt};

use crate::optimiser::Candidate;

/// How two parents are combined. The first three pass variables on unchanged; the others make new values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossover {
    /// Each variable comes from one parent or the other, by a random bit.
    Scattered,
    /// The variables before a random point come from the first parent, the others from the second.
    SinglePoint,
    /// The variables between two random points come from the second parent, the others from the first.
    TwoPoints,
    /// The mean of both, weighted at random.
    Arithmetic,
    /// The first parent moved towards the second by up to `ratio` of their difference, each variable by its own draw.
    /// (The thesis prints p1 + rand ratio (p1 - p2), which is no average of the two.)
    Intermediate {
        /// The most of the difference, above 0.
        ratio: f64,
    },
    /// On the line through both: p2 + ratio (p1 - p2), p1 being the better.
    Heuristic {
        /// How far from the worse parent, in units of the difference; above 1 is beyond the better one.
        ratio: f64,
    },
}

impl Crossover {
    /// A child of two parents. It may lie outside the bounds.
    pub(super) fn child(self, first: &[f64], second: &[f64], first_is_better: bool, rng: &mut impl Rng) -> Candidate {
        let pairs = first.iter().zip(second).map(|(&a, &b)| (a, b));
        let variables = first.len();
        match self {
            Self::Scattered => pairs.map(|(a, b)| if rng.random() { a } else { b }).collect(),
            Self::SinglePoint => {
                let point = rng.random_range(1..variables.max(2));
                pairs.enumerate().map(|(i, (a, b))| if i < point { a } else { b }).collect()
            }
            Self::TwoPoints => {
                let points = [rng.random_range(0..=variables), rng.random_range(0..=variables)];
                let middle = points[0].min(points[1])..points[0].max(points[1]);
                pairs.enumerate().map(|(i, (a, b))| if middle.contains(&i) { b } else { a }).collect()
            }
            Self::Arithmetic => {
                let weight: f64 = rng.random();
                pairs.map(|(a, b)| weight * a + (1.0 - weight) * b).collect()
            }
            Self::Intermediate { ratio } => pairs.map(|(a, b)| a + rng.random::<f64>() * ratio * (b - a)).collect(),
            Self::Heuristic { ratio } if first_is_better => pairs.map(|(a, b)| b + ratio * (a - b)).collect(),
            Self::Heuristic { ratio } => pairs.map(|(a, b)| a + ratio * (b - a)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::rng::Seed;

    const A: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];
    const B: [f64; 5] = [10.0, 20.0, 30.0, 40.0, 50.0];

    fn children(crossover: Crossover) -> Vec<Candidate> {
        let mut rng = Seed(1).stream("test", 0);
        (0..200).map(|_| crossover.child(&A, &B, true, &mut rng)).collect()
    }

    /// Whether each variable is the second parent's.
    fn origins(child: &[f64]) -> Vec<bool> {
        child
            .iter()
            .zip(A)
            .zip(B)
            .map(|((&x, a), b)| {
                if x == b {
                    true
                } else {
                    assert_eq!(x, a);
                    false
                }
            })
            .collect()
    }

    fn changes(origins: &[bool]) -> usize {
        origins.windows(2).filter(|two| two[0] != two[1]).count()
    }

    #[test]
    fn validate_section_7_1_three_crossovers_pass_variables_on_unchanged() {
        let scattered: Vec<_> = children(Crossover::Scattered).iter().map(|c| origins(c)).collect();
        assert!(scattered.iter().any(|o| changes(o) > 2));
        for one in children(Crossover::SinglePoint).iter().map(|c| origins(c)) {
            assert!(!one[0] && one[4] && changes(&one) == 1, "{one:?}");
        }
        for two in children(Crossover::TwoPoints).iter().map(|c| origins(c)) {
            assert!(changes(&two) <= 2 && !(two[0] && !two[2] && two[4]), "{two:?}");
        }
    }

    #[test]
    fn validate_section_7_1_three_crossovers_make_new_values() {
        for child in children(Crossover::Arithmetic) {
            let weight = (child[0] - B[0]) / (A[0] - B[0]);
            assert!((0.0..=1.0).contains(&weight));
            assert!(child.iter().zip(A).zip(B).all(|((x, a), b)| (x - (weight * a + (1.0 - weight) * b)).abs() < 1e-9));
        }
        for child in children(Crossover::Intermediate { ratio: 0.5 }) {
            assert!(child.iter().zip(A).zip(B).all(|((x, a), b)| (a..=0.5 * (a + b)).contains(x)), "{child:?}");
        }
        for child in children(Crossover::Heuristic { ratio: 1.2 }) {
            assert!(child.iter().zip(A).zip(B).all(|((x, a), b)| (x - (b + 1.2 * (a - b))).abs() < 1e-9));
        }
        let beyond_the_second =
            Crossover::Heuristic { ratio: 1.2 }.child(&A, &B, false, &mut Seed(1).stream("test", 0));
        assert!(beyond_the_second.iter().zip(B).all(|(x, b)| *x > b));
    }

    #[test]
    fn one_variable_can_be_crossed_too() {
        let mut rng = Seed(1).stream("test", 0);
        let all = [Crossover::Scattered, Crossover::SinglePoint, Crossover::TwoPoints, Crossover::Arithmetic];
        for crossover in all {
            assert_eq!(crossover.child(&[1.0], &[1.0], true, &mut rng).len(), 1);
        }
    }
}
