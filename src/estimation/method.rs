//! The methods of the search: the thesis's genetic algorithm, and those that it names as future work.

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::Settings;
use crate::numeric::rng::Seed;
use crate::optimiser::differential::Differential;
pub use crate::optimiser::genetic::Choices;
use crate::optimiser::genetic::{self, Genetic};
use crate::optimiser::polish::multistart::Multistart;
use crate::optimiser::polish::simplex;
use crate::optimiser::swarm::{Dragonflies, Particles, Wolves};
use crate::optimiser::{Bounds, Search};

/// A method of searching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Genetic algorithm (section 7.1).
    #[default]
    Ga,
    /// Differential evolution.
    De,
    /// Particle swarm.
    Pso,
    /// Grey wolf.
    Gwo,
    /// Dragonfly.
    Dragonfly,
    /// Local searches from many starts.
    Multistart,
}

/// Evaluations of one downhill simplex from a start to its end, about; so many starts fit into the budget.
const EVALUATIONS_PER_START: usize = 60;
/// The local searches of the multi-start method.
const LOCAL: simplex::Settings = simplex::Settings { width: 0.1, width_min: 1e-4, iterations: 200, cost_enough: 1e-4 };

impl Method {
    /// Every method.
    pub const ALL: [Self; 6] = [Self::Ga, Self::De, Self::Pso, Self::Gwo, Self::Dragonfly, Self::Multistart];

    /// Its name on the command line, over HTTP and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ga => "ga",
            Self::De => "de",
            Self::Pso => "pso",
            Self::Gwo => "gwo",
            Self::Dragonfly => "dragonfly",
            Self::Multistart => "multistart",
        }
    }

    /// A search within bounds with a method's settings. The multi-start method takes as many evaluations as the others.
    pub(super) fn search(settings: &Settings, bounds: &Bounds) -> Box<dyn Search> {
        let Settings { method, ga, population, generations, seed, .. } = *settings;
        let seed = Seed(seed);
        match method {
            Self::Ga => {
                let settings = genetic::Settings { population, generations, choices: ga };
                Box::new(Genetic::new(bounds, settings, seed))
            }
            Self::De => Box::new(Differential::new(bounds, population, generations, seed)),
            Self::Pso => Box::new(Particles::new(bounds, population, generations, seed)),
            Self::Gwo => Box::new(Wolves::new(bounds, population, generations, seed)),
            Self::Dragonfly => Box::new(Dragonflies::new(bounds, population, generations, seed)),
            Self::Multistart => {
                let evaluations = population * (generations + 1);
                let starts = (evaluations / EVALUATIONS_PER_START).max(1);
                Box::new(Multistart::new(bounds, starts, LOCAL, evaluations))
            }
        }
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = Self::ALL.map(Self::name).join(", ");
        let named = Self::ALL.into_iter().find(|method| method.name() == text);
        named.ok_or_else(|| format!("found {text:?}, expected one of {names}"))
    }
}
