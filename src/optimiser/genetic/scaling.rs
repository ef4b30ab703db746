//! Fitness scaling: from costs to how many children each candidate may expect (section 7.1).

use crate::optimiser::{key, ranking};

/// How costs become expectations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// By rank: the expectation falls with the square root of the place, whatever the costs.
    Rank,
    /// In proportion to the inverse of the cost; the thesis's choice.
    Proportional,
}

impl Scaling {
    /// The expectations of candidates, in their order; in no unit. A cost that is not finite gets nothing, unless none is.
    pub(super) fn expectations(self, costs: &[f64]) -> Vec<f64> {
        if costs.iter().all(|&cost| key(cost).is_infinite()) {
            return vec![1.0; costs.len()];
        }
        match self {
            Self::Rank => {
                let mut expectations = vec![0.0; costs.len()];
                for (place, index) in ranking(costs).into_iter().enumerate() {
                    expectations[index] =
                        if key(costs[index]).is_finite() { 1.0 / (1.0 + place as f64).sqrt() } else { 0.0 };
                }
                expectations
            }
            Self::Proportional => proportional(costs),
        }
    }
}

fn proportional(costs: &[f64]) -> Vec<f64> {
    let least = costs.iter().map(|&c| key(c)).fold(f64::INFINITY, f64::min);
    // A cost near zero must not take the whole wheel: costs count from a hundredth of their spread.
    let worst = costs.iter().map(|&c| key(c)).filter(|c| c.is_finite()).fold(least, f64::max);
    let floor = (0.01 * (worst - least)).max(f64::MIN_POSITIVE);
    costs.iter().map(|&c| if key(c).is_finite() { floor / (c - least + floor) } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validate_section_7_1_proportional_scaling_goes_as_the_inverse_of_the_cost() {
        let expectations = Scaling::Proportional.expectations(&[1.0, 2.0, f64::NAN, 101.0]);
        assert_eq!(expectations, [1.0, 0.5, 0.0, 1.0 / 101.0]);
    }

    #[test]
    fn validate_section_7_1_rank_scaling_does_not_depend_on_how_far_costs_are_apart() {
        let near = Scaling::Rank.expectations(&[3.0, 1.0, 2.0, f64::INFINITY]);
        assert_eq!(near, Scaling::Rank.expectations(&[3e9, 1e-9, 1.0, f64::NAN]));
        assert_eq!(near, [1.0 / 3f64.sqrt(), 1.0, 1.0 / 2f64.sqrt(), 0.0]);
    }

    #[test]
    fn where_no_cost_is_finite_all_are_alike() {
        for scaling in [Scaling::Rank, Scaling::Proportional] {
            assert_eq!(scaling.expectations(&[f64::NAN, f64::INFINITY]), [1.0, 1.0]);
        }
    }
}
