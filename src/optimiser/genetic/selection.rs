//! Selection of parents by their expectations (section 7.1).

use rand::{Rng, RngExt};

/// How parents are selected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selection {
    /// A wheel with a segment as wide as each expectation, spun once for each parent (figure 7.2).
    Roulette,
    /// One spin, then equal steps along the wheel: every candidate is picked as often as its expectation says, but for
    /// a fraction. The thesis's choice.
    StochasticUniform,
    /// The best of this many candidates that are drawn alike.
    Tournament {
        /// The candidates that compete, at least 1.
        size: usize,
    },
}

impl Selection {
    /// The indices of `number` parents, in random order.
    pub(super) fn pick(self, expectations: &[f64], number: usize, rng: &mut impl Rng) -> Vec<usize> {
        match self {
            Self::Roulette => {
                let total: f64 = expectations.iter().sum();
                (0..number).map(|_| at(expectations, total * rng.random::<f64>())).collect()
            }
            Self::StochasticUniform => stochastic_uniform(expectations, number, rng),
            Self::Tournament { size } => (0..number).map(|_| tournament(expectations, size, rng)).collect(),
        }
    }
}

/// The candidate on whose segment of the wheel a place lies.
fn at(expectations: &[f64], place: f64) -> usize {
    let mut reached = 0.0;
    let passes = |&e: &f64| {
        reached += e;
        place < reached
    };
    // Rounding may leave the last place beyond the last segment: then the last one that has any.
    expectations.iter().position(passes).or_else(|| expectations.iter().rposition(|&e| e > 0.0)).unwrap_or(0)
}

fn stochastic_uniform(expectations: &[f64], number: usize, rng: &mut impl Rng) -> Vec<usize> {
    let total: f64 = expectations.iter().sum();
    let step = total / number as f64;
    let mut place = step * rng.random::<f64>();
    let (mut index, mut reached) = (0, expectations[0]);
    let mut picked = Vec::with_capacity(number);
    for _ in 0..number {
        while place > reached && index + 1 < expectations.len() {
            index += 1;
            reached += expectations[index];
        }
        picked.push(index);
        place += step;
    }
    // The walk goes in order: shuffled, so that couples are random.
    for i in (1..picked.len()).rev() {
        picked.swap(i, rng.random_range(0..=i));
    }
    picked
}

fn tournament(expectations: &[f64], size: usize, rng: &mut impl Rng) -> usize {
    let mut winner = rng.random_range(0..expectations.len());
    for _ in 1..size {
        let rival = rng.random_range(0..expectations.len());
        if expectations[rival] > expectations[winner] {
            winner = rival;
        }
    }
    winner
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::rng::Seed;

    fn counts(selection: Selection, expectations: &[f64], number: usize) -> Vec<usize> {
        let picked = selection.pick(expectations, number, &mut Seed(1).stream("test", 0));
        assert_eq!(picked.len(), number);
        (0..expectations.len()).map(|i| picked.iter().filter(|&&p| p == i).count()).collect()
    }

    #[test]
    fn stochastic_uniform_picks_each_as_often_as_its_expectation_says() {
        let found = counts(Selection::StochasticUniform, &[1.0, 0.0, 3.0], 400);
        assert!((99..=101).contains(&found[0]) && found[1] == 0, "{found:?}");
    }

    #[test]
    fn validate_section_7_1_roulette_picks_each_in_proportion_to_its_segment() {
        let found = counts(Selection::Roulette, &[1.0, 0.0, 3.0], 40_000);
        // Four standard deviations of a binomial count.
        assert!(found[0].abs_diff(10_000) < 350 && found[1] == 0, "{found:?}");
    }

    #[test]
    fn a_tournament_of_many_is_won_by_the_best_and_of_one_by_anyone() {
        let expectations = [0.2, 0.9, 0.5];
        assert_eq!(counts(Selection::Tournament { size: 60 }, &expectations, 100), [0, 100, 0]);
        let alone = counts(Selection::Tournament { size: 1 }, &expectations, 30_000);
        assert!(alone.iter().all(|count| count.abs_diff(10_000) < 350), "{alone:?}");
        // Of two, the best of three wins 5 of 9, the middle one 3, the worst 1.
        let pairs = counts(Selection::Tournament { size: 2 }, &expectations, 90_000);
        assert!(pairs[1].abs_diff(50_000) < 700 && pairs[2].abs_diff(30_000) < 700, "{pairs:?}");
    }
}
