//! What a genetic algorithm does at each of its stages, and how that is written down.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use thiserror::Error;

use super::{Crossover, Mutation, Scaling, Selection};

/// The choices of section 7.1. As text: `thesis`, or what differs from it, as `scaling=rank,crossover=heuristic:1.2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choices {
    /// From costs to expectations.
    pub scaling: Scaling,
    /// From expectations to parents.
    pub selection: Selection,
    /// From two parents to a child.
    pub crossover: Crossover,
    /// Share of the children that come from crossover, 0 to 1; the others are mutants.
    pub crossover_share: f64,
    /// From one parent to a mutant.
    pub mutation: Mutation,
    /// Share of a generation that survives unchanged, rounded up, 0 to 1.
    pub elite_share: f64,
}

impl Choices {
    /// The thesis's (section 7.2): proportional scaling and adaptive feasible mutation, the rest as MATLAB's `ga` has it:
    /// stochastic uniform selection, scattered crossover of 80 %, an elite of 5 %.
    pub const THESIS: Self = Self {
        scaling: Scaling::Proportional,
        selection: Selection::StochasticUniform,
        crossover: Crossover::Scattered,
        crossover_share: 0.8,
        mutation: Mutation::AdaptiveFeasible,
        elite_share: 0.05,
    };
}

impl Default for Choices {
    fn default() -> Self {
        Self::THESIS
    }
}

/// Why choices could not be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("ga: found {found:?}, expected {expected}")]
pub struct ChoicesError {
    /// The part that could not be read.
    pub found: String,
    /// What would have been right.
    pub expected: &'static str,
}

const KEYS: &str =
    "thesis, or scaling, selection, crossover, crossover_share, mutation or elite_share, each as KEY=VALUE";
const SCALING: &str = "rank or proportional";
const SELECTION: &str = "roulette, stochastic_uniform or tournament:SIZE (1 to 1000)";
const CROSSOVER: &str =
    "scattered, single_point, two_points, arithmetic, intermediate:RATIO or heuristic:RATIO (above 0, at most 10)";
const MUTATION: &str = "gaussian:SCALE:SHRINK (above 0 to 1, 0 to 1), uniform:RATE (0 to 1) or adaptive_feasible";
const SHARE: &str = "0 to 1";

impl FromStr for Choices {
    type Err = ChoicesError;

    fn from_str(text: &str) -> Result<Self, ChoicesError> {
        let mut choices = Self::THESIS;
        for part in text.split(',').map(str::trim).filter(|part| *part != "thesis") {
            let (key, value) = part.split_once('=').ok_or_else(|| wrong(part, KEYS))?;
            match key.trim() {
                "scaling" => choices.scaling = scaling(value.trim()).ok_or_else(|| wrong(part, SCALING))?,
                "selection" => choices.selection = selection(value.trim()).ok_or_else(|| wrong(part, SELECTION))?,
                "crossover" => choices.crossover = crossover(value.trim()).ok_or_else(|| wrong(part, CROSSOVER))?,
                "mutation" => choices.mutation = mutation(value.trim()).ok_or_else(|| wrong(part, MUTATION))?,
                "crossover_share" => {
                    choices.crossover_share = within(value, 0.0, 1.0).ok_or_else(|| wrong(part, SHARE))?;
                }
                "elite_share" => choices.elite_share = within(value, 0.0, 1.0).ok_or_else(|| wrong(part, SHARE))?,
                _ => return Err(wrong(part, KEYS)),
            }
        }
        Ok(choices)
    }
}

fn wrong(found: &str, expected: &'static str) -> ChoicesError {
    ChoicesError { found: found.into(), expected }
}

fn within(text: &str, min: f64, max: f64) -> Option<f64> {
    text.trim().parse().ok().filter(|value| (min..=max).contains(value))
}

fn scaling(text: &str) -> Option<Scaling> {
    match text {
        "rank" => Some(Scaling::Rank),
        "proportional" => Some(Scaling::Proportional),
        _ => None,
    }
}

fn selection(text: &str) -> Option<Selection> {
    match text.split_once(':') {
        None if text == "roulette" => Some(Selection::Roulette),
        None if text == "stochastic_uniform" => Some(Selection::StochasticUniform),
        Some(("tournament", size)) => {
            let size = size.parse().ok().filter(|size| (1..=1000).contains(size))?;
            Some(Selection::Tournament { size })
        }
        _ => None,
    }
}

fn crossover(text: &str) -> Option<Crossover> {
    let ratio = |text: &str| within(text, f64::MIN_POSITIVE, 10.0);
    match text.split_once(':') {
        None => match text {
            "scattered" => Some(Crossover::Scattered),
            "single_point" => Some(Crossover::SinglePoint),
            "two_points" => Some(Crossover::TwoPoints),
            "arithmetic" => Some(Crossover::Arithmetic),
            _ => None,
        },
        Some(("intermediate", text)) => ratio(text).map(|ratio| Crossover::Intermediate { ratio }),
        Some(("heuristic", text)) => ratio(text).map(|ratio| Crossover::Heuristic { ratio }),
        _ => None,
    }
}

fn mutation(text: &str) -> Option<Mutation> {
    match text.split_once(':') {
        None => (text == "adaptive_feasible").then_some(Mutation::AdaptiveFeasible),
        Some(("gaussian", rest)) => {
            let (scale, shrink) = rest.split_once(':')?;
            let (scale, shrink) = (within(scale, f64::MIN_POSITIVE, 1.0)?, within(shrink, 0.0, 1.0)?);
            Some(Mutation::Gaussian { scale, shrink })
        }
        Some(("uniform", rate)) => within(rate, 0.0, 1.0).map(|rate| Mutation::Uniform { rate }),
        _ => None,
    }
}

impl fmt::Display for Choices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        let thesis = Self::THESIS;
        if self.scaling != thesis.scaling {
            parts.push("scaling=rank".to_owned());
        }
        match self.selection {
            Selection::StochasticUniform => {}
            Selection::Roulette => parts.push("selection=roulette".into()),
            Selection::Tournament { size } => parts.push(format!("selection=tournament:{size}")),
        }
        match self.crossover {
            Crossover::Scattered => {}
            Crossover::SinglePoint => parts.push("crossover=single_point".into()),
            Crossover::TwoPoints => parts.push("crossover=two_points".into()),
            Crossover::Arithmetic => parts.push("crossover=arithmetic".into()),
            Crossover::Intermediate { ratio } => parts.push(format!("crossover=intermediate:{ratio}")),
            Crossover::Heuristic { ratio } => parts.push(format!("crossover=heuristic:{ratio}")),
        }
        if self.crossover_share != thesis.crossover_share {
            parts.push(format!("crossover_share={}", self.crossover_share));
        }
        match self.mutation {
            Mutation::AdaptiveFeasible => {}
            Mutation::Gaussian { scale, shrink } => parts.push(format!("mutation=gaussian:{scale}:{shrink}")),
            Mutation::Uniform { rate } => parts.push(format!("mutation=uniform:{rate}")),
        }
        if self.elite_share != thesis.elite_share {
            parts.push(format!("elite_share={}", self.elite_share));
        }
        f.write_str(&if parts.is_empty() { "thesis".into() } else { parts.join(",") })
    }
}

impl Serialize for Choices {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Choices {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_back_from_what_they_are_written_as() {
        for text in [
            "thesis",
            "scaling=rank",
            "selection=roulette,crossover=single_point",
            "selection=tournament:3,crossover=two_points,crossover_share=0.6",
            "crossover=arithmetic,mutation=gaussian:0.25:1,elite_share=0.1",
            "crossover=intermediate:0.5,mutation=uniform:0.01",
            "crossover=heuristic:1.2",
        ] {
            assert_eq!(text.parse::<Choices>().unwrap().to_string(), text);
        }
        let spaced: Choices = "thesis, scaling = rank".parse().unwrap();
        assert_eq!(spaced, Choices { scaling: Scaling::Rank, ..Choices::THESIS });
    }

    #[test]
    fn what_cannot_be_read_is_named_with_what_was_expected() {
        for (text, expected) in [
            ("best", KEYS),
            ("luck=high", KEYS),
            ("scaling=top", SCALING),
            ("selection=tournament:0", SELECTION),
            ("crossover=heuristic", CROSSOVER),
            ("crossover=heuristic:-1", CROSSOVER),
            ("mutation=gaussian:0.1", MUTATION),
            ("mutation=uniform:nan", MUTATION),
            ("scaling=rank,elite_share=2", SHARE),
        ] {
            assert_eq!(text.parse::<Choices>().unwrap_err().expected, expected, "{text}");
        }
    }
}
