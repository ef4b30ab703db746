//! Prognosis: from the history of a fault to the distribution of the remaining useful life.
//!
//! Everything here is a pure function of its arguments. The model is written down in `docs/prognostics.md`.

pub mod baseline;
mod change;
mod competing;
mod filter;
mod fleet;
mod forecast;
mod history;
mod law;
mod life;
pub mod metrics;
mod normal;
mod posterior;
mod prior;
mod remaining_life;
#[cfg(test)]
mod tests;

pub use change::{Change, ChangeKind};
pub use competing::competing;
pub use fleet::{FLEET_MODEL, Fleet, FleetPrior, LifeEvidence, tally};
pub use forecast::{BandPoint, Forecast, Prognosis, Quantiles};
pub use history::{Direction, Observation, Problem, PrognosisError, Question};
pub use prior::LifePrior;
pub use remaining_life::{life_evidence, remaining_life};
