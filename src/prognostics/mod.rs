//! Prognosis: from the history of a fault to the distribution of the remaining useful life.
//!
//! Everything here is a pure function of its arguments. The model is written down in `docs/prognostics.md`.

pub mod baseline;
mod competing;
mod forecast;
mod history;
mod life;
mod line;
pub mod metrics;
mod normal;
mod remaining_life;
#[cfg(test)]
mod tests;

pub use competing::competing;
pub use forecast::{BandPoint, Forecast, Prognosis, Quantiles};
pub use history::{Direction, Observation, Problem, PrognosisError, Question};
pub use remaining_life::remaining_life;
