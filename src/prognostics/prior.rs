//! The prior of a life: from the age alone, or from the lives of a fleet.

use super::fleet::{Fleet, FleetPrior};
use super::normal::log_density;

/// The median of the life over the age (chosen: the question comes at a moment unrelated to the end, as likely in the first half
/// of the life as in the second).
const AGES: f64 = 2.0;
/// The standard deviation of its logarithm (chosen: nine lives in ten are between 1 and 4 ages long).
const DEVIATION: f64 = 0.45;
/// The same where parts are watched that mostly are healthy: the law of Student with heavy tails, so that a life of many ages
/// is not ruled out.
const WATCHED_DEVIATION: f64 = 0.4;
const WATCHED_DEGREES: f64 = 3.0;

/// The prior of the life of one fault: of the usage at which the mean of its growth comes to the threshold.
#[derive(Debug, Clone, Default)]
pub enum LifePrior {
    /// Log-normal in life over age: for a history by itself.
    #[default]
    Age,
    /// The same with the tails of Student's law with 3 degrees of freedom: for parts that are watched from new on.
    Watched,
    /// From the lives of others of its type.
    Fleet(Fleet),
    /// The prior that an earlier forecast had from its fleet.
    Kept(FleetPrior),
}

impl LifePrior {
    /// The prior of the life of a part with a scale, in usage.
    pub(super) fn at(&self, scale: f64) -> ScaledPrior {
        match self {
            Self::Age => ScaledPrior::Age,
            Self::Watched => ScaledPrior::Watched,
            Self::Fleet(fleet) => ScaledPrior::Fleet { prior: fleet.prior(scale), scale },
            Self::Kept(prior) => ScaledPrior::Fleet { prior: prior.clone(), scale },
        }
    }
}

/// The prior of the life of one part.
#[derive(Debug)]
pub(super) enum ScaledPrior {
    Age,
    Watched,
    /// The fleet's, with the usage of one scale.
    Fleet {
        prior: FleetPrior,
        scale: f64,
    },
}

impl ScaledPrior {
    /// What the fleet has to it.
    pub(super) fn into_fleet(self) -> Option<FleetPrior> {
        match self {
            Self::Fleet { prior, .. } => Some(prior),
            Self::Age | Self::Watched => None,
        }
    }

    /// The logarithm of the density of the logarithm of a life of so many scales.
    pub(super) fn log_density(&self, life: f64) -> f64 {
        match self {
            Self::Age => log_density((life / AGES).ln() / DEVIATION, DEVIATION),
            Self::Watched => watched(life),
            Self::Fleet { prior, scale } => prior.log_density(life * scale, watched(life)),
        }
    }
}

/// The logarithm of the density of the logarithm of a life over the age of a watched part.
pub(super) fn watched(life: f64) -> f64 {
    let z = (life / AGES).ln() / WATCHED_DEVIATION;
    // The constant is the logarithm of the density of Student's law with 3 degrees of freedom at 0.
    -1.000_888_8 - 0.5 * (WATCHED_DEGREES + 1.0) * (z * z / WATCHED_DEGREES).ln_1p() - WATCHED_DEVIATION.ln()
}
