//! What is asked of each fault of an actuator, and of which observations.

use crate::models::fault::FDJ_NOMINAL_N;
use crate::prognostics::{
    Direction, LifeEvidence, LifePrior, Observation, Prognosis, PrognosisError, Question, life_evidence, remaining_life,
};
use crate::store::LifeHistory;
use crate::store::records::{Actuator, HealthRecord};

/// A part whose life no event began counts as seen from new where its first observation comes within this many risk windows
/// of usage, and within this part of the way to the threshold, two standard deviations apart.
const NEW_WINDOWS: f64 = 10.0;
const NEW_LEVEL: f64 = 0.1;

/// A value and its standard deviation.
type Figure = (Option<f64>, Option<f64>);

/// A fault whose remaining life is asked.
#[derive(Debug, Clone, Copy)]
pub(super) struct AskedFault {
    /// Its name in the forecast.
    pub name: &'static str,
    /// Its value in an actuator without it.
    pub healthy: f64,
    /// The value at which life ends.
    pub threshold: f64,
    figure: fn(&HealthRecord) -> Figure,
    risk_window: f64,
}

impl AskedFault {
    /// KGM and FDJ of an actuator.
    pub fn all(actuator: &Actuator, risk_window: f64) -> [Self; 2] {
        let kgm: fn(&HealthRecord) -> Figure = |record| (record.kgm, record.kgm_std);
        let fdj: fn(&HealthRecord) -> Figure = |record| (record.fdj_n, record.fdj_n_std);
        let fault = |name, healthy, threshold, figure| Self { name, healthy, threshold, figure, risk_window };
        let thresholds = actuator.thresholds;
        [fault("kgm", 0.0, thresholds.kgm, kgm), fault("fdj_n", FDJ_NOMINAL_N, thresholds.fdj_n, fdj)]
    }

    /// The remaining life in a life.
    pub fn remaining(&self, life: &LifeHistory, prior: LifePrior) -> Result<Prognosis, PrognosisError> {
        remaining_life(&self.observations(&life.records), &self.question(life, prior))
    }

    /// What a life that is over says of the length of lives; nothing where its history cannot be used.
    pub fn evidence(&self, life: &LifeHistory) -> Option<LifeEvidence> {
        life_evidence(&self.observations(&life.records), &self.question(life, LifePrior::Watched)).ok()?
    }

    fn question(&self, life: &LifeHistory, prior: LifePrior) -> Question {
        let at = usage(life);
        Question {
            threshold: self.threshold,
            direction: Direction::Rising,
            healthy: Some(self.healthy),
            at,
            life_start: life.life_start_usage.filter(|&start| start <= at),
            horizon: None,
            risk_window: self.risk_window,
            prior,
        }
    }

    /// Whether a life is known from its beginning. Where traces begin with a part in service, its life counts from the first of
    /// them, and can be compared with none.
    pub fn is_seen_from_new(&self, life: &LifeHistory) -> bool {
        let near_new = |first: Observation| {
            let level = (first.value - 2.0 * first.std.unwrap_or(0.0) - self.healthy) / (self.threshold - self.healthy);
            first.usage <= NEW_WINDOWS * self.risk_window && level < NEW_LEVEL
        };
        let first = || self.observed(&life.records).min_by(|a, b| a.usage.total_cmp(&b.usage));
        life.life_start_usage.is_some() || first().is_none_or(near_new)
    }

    /// What was observed, in the order of usage.
    fn observations(&self, history: &[HealthRecord]) -> Vec<Observation> {
        let mut observations: Vec<_> = self.observed(history).collect();
        observations.sort_by(|a, b| a.usage.total_cmp(&b.usage));
        observations
    }

    fn observed(&self, history: &[HealthRecord]) -> impl Iterator<Item = Observation> {
        history.iter().filter_map(|record| {
            let (value, std) = (self.figure)(record);
            Some(Observation { usage: record.usage, value: value?, std })
        })
    }
}

/// The usage of a life's newest state. Usage never falls: a newer trace with less usage is in doubt, not all those before it.
pub(super) fn usage(life: &LifeHistory) -> f64 {
    life.records.iter().map(|record| record.usage).reduce(f64::max).or(life.life_start_usage).unwrap_or(0.0)
}
