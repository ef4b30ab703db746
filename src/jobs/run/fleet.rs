//! Fleet learning: what a forecast takes from the lives of its cohort and from its actuator's earlier ones, and what it adds.
//!
//! A cohort is the actuators of one parameter set whose lives can be compared: one usage unit, one fault, one threshold.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::asked::AskedFault;
use super::predict::RiskQuestion;
use crate::jobs::lives;
use crate::prognostics::{FLEET_MODEL, Fleet, FleetPrior, LifeEvidence, LifePrior, tally};
use crate::store::records::{Actuator, FleetShare, FleetTally, ForecastRecord};
use crate::store::{LifeHistory, Records, StoreError};

/// The most earlier lives of an actuator that count: the newest.
const EARLIER_MAX: usize = 4;

/// What is known of lives beside the history of an actuator's current one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct KnownLives {
    /// What the others of its cohorts say, fault by fault.
    pub others: [FleetTally; 2],
    /// The earlier lives of the same actuator of which something was recorded, the newest first.
    pub earlier: Vec<LifeHistory>,
    /// What a forecast that is kept took from all these, fault by fault: another question about it rests on the same.
    pub taken: Option<[Taken; 2]>,
}

/// What a forecast of a fault took from other lives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Taken {
    /// Its prior; none where that was from the age alone.
    pub prior: Option<FleetPrior>,
    /// Whose lives it rests on.
    pub learnt_from: LearntFrom,
}

/// The lives that a forecast rests on beside the one that it is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LearntFrom {
    /// Other actuators of its parameter set, with its usage unit and this fault's threshold.
    pub actuators: u64,
    /// Earlier lives of the same actuator.
    pub earlier_lives: usize,
}

/// Reads what is known beside the history of a life of an actuator: of the actuator, what ended before that life began.
pub(super) async fn known(
    records: &dyn Records,
    actuator: &Actuator,
    history: &LifeHistory,
    asked: &RiskQuestion,
) -> Result<KnownLives, StoreError> {
    let mut earlier = Vec::new();
    if let Some(began) = history.life_started_at {
        for life in lives::lives(records, actuator.id).await?.iter().rev() {
            if life.end.is_none_or(|end| end > began) {
                continue;
            }
            let ended = lives::records_of(records, actuator.id, life, life.end).await?;
            earlier.extend(Some(ended).filter(|ended| !ended.records.is_empty()));
            if earlier.len() == EARLIER_MAX {
                break;
            }
        }
    }
    let [kgm, fdj_n] = AskedFault::all(actuator, asked.risk_window).map(|fault| cohort(actuator, &fault));
    let others = [records.fleet_tally(&kgm, actuator.id).await?, records.fleet_tally(&fdj_n, actuator.id).await?];
    Ok(KnownLives { others, earlier, taken: None })
}

/// Reads what the kept forecast of a revision took from other lives.
pub(super) async fn taken(
    records: &dyn Records,
    actuator: &Actuator,
    forecast: &ForecastRecord,
    asked: &RiskQuestion,
) -> Result<KnownLives, StoreError> {
    let mut taken = <[Taken; 2]>::default();
    for (taken, fault) in taken.iter_mut().zip(AskedFault::all(actuator, asked.risk_window)) {
        let density = records.forecast_prior(actuator.id, forecast.revision, fault.name).await?;
        let told = &forecast.document["faults"][fault.name]["learnt_from"];
        *taken = Taken {
            prior: FleetPrior::of_density(density),
            learnt_from: LearntFrom::deserialize(told).unwrap_or_default(),
        };
    }
    Ok(KnownLives { taken: Some(taken), ..KnownLives::default() })
}

/// The name of the cohort of a fault of an actuator.
fn cohort(actuator: &Actuator, fault: &AskedFault) -> String {
    let AskedFault { name, healthy, threshold, .. } = fault;
    let (set, unit) = (&actuator.parameter_set, actuator.usage_unit.name());
    format!("model {FLEET_MODEL}, {set}, {unit}, {name} from {healthy} to {threshold}")
}

/// What the earlier lives of an actuator say of the length of its lives. One that was not seen from new, or whose history cannot
/// be used, says nothing.
pub(super) fn evidence(earlier: &[LifeHistory], fault: &AskedFault) -> Vec<LifeEvidence> {
    earlier.iter().filter(|life| fault.is_seen_from_new(life)).filter_map(|life| fault.evidence(life)).collect()
}

/// The prior of a life after what the others say and the actuator's earlier lives, and what it rests on.
pub(super) fn prior(others: &FleetTally, earlier: &[LifeEvidence]) -> (LifePrior, LearntFrom) {
    let prior = Fleet::new(&others.tally, earlier).map_or(LifePrior::Watched, LifePrior::Fleet);
    (prior, LearntFrom { actuators: others.actuators, earlier_lives: earlier.len() })
}

/// What the lives of an actuator say of those of its cohort, and what its own forecast took from it.
pub(super) fn share(
    actuator: &Actuator,
    fault: &AskedFault,
    lives: &[LifeEvidence],
    prior: Option<&FleetPrior>,
) -> FleetShare {
    let tally = tally(lives).unwrap_or_default();
    let prior = prior.map(|prior| prior.density().to_vec()).unwrap_or_default();
    FleetShare { fault: fault.name.to_owned(), cohort: cohort(actuator, fault), tally, prior }
}
