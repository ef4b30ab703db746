//! An actuator's baseline, and a history with the growth since.

use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;

use crate::jobs::baselines::{self, Grown, LOOKED_AT_MAX, Opening};
use crate::prognostics::baseline::{Healthy, Mean, PassedOver};
use crate::store::records::{Actuator, HealthRecord, Id};

/// One estimate in an actuator's history, with the growth since the baseline of its life. Growth is null until the baseline
/// is complete, for the traces that it is made of, and for what was recorded before the last of them.
#[derive(Debug, Serialize, ToSchema)]
pub struct HealthItem {
    /// The estimate.
    #[serde(flatten)]
    record: HealthRecord,
    /// Growth of the torque-motor demagnetisation since the baseline.
    kgm_growth: Option<f64>,
    /// Its standard deviation: that of the estimate and that of the baseline together.
    kgm_growth_std: Option<f64>,
    /// Growth of the dynamic jack friction since the baseline, N.
    fdj_n_growth: Option<f64>,
    /// Its standard deviation, N: that of the estimate and that of the baseline together.
    fdj_n_growth_std: Option<f64>,
}

impl From<Grown> for HealthItem {
    fn from(Grown { record, kgm, fdj_n }: Grown) -> Self {
        let ((kgm_growth, kgm_growth_std), (fdj_n_growth, fdj_n_growth_std)) = (kgm, fdj_n);
        Self { record, kgm_growth, kgm_growth_std, fdj_n_growth, fdj_n_growth_std }
    }
}

/// An actuator's own bias when its current life began, from its first healthy traces.
#[derive(Debug, Serialize, ToSchema)]
pub struct BaselineDocument {
    /// The actuator.
    actuator_id: Id,
    /// When this life began; null for the first, which began with the actuator.
    life_start: Option<Timestamp>,
    /// The usage at which it began; null for the first.
    life_start_usage: Option<f64>,
    /// Healthy traces that the baseline is made of, once they are there.
    traces_wanted: usize,
    /// Whether they are.
    complete: bool,
    /// Torque-motor demagnetisation, 0 to 1; null until the baseline is complete.
    kgm: Option<BaselineFigure>,
    /// Gain of the torque motor, 1 less its demagnetisation; null until the baseline is complete.
    gain: Option<BaselineFigure>,
    /// Dynamic jack friction, N; null until the baseline is complete.
    fdj_n: Option<BaselineFigure>,
    /// Offset of the torque motor's current, A; null until the baseline is complete, and where no trace determines it.
    current_offset_a: Option<BaselineFigure>,
    /// The level of each fault below which a trace counts as healthy.
    healthy_below: HealthyBelow,
    /// The traces that are taken so far, ascending by time of recording.
    traces: Vec<BaselineTrace>,
    /// Conclusive traces among them that are not taken.
    passed_over: Vec<PassedOverTrace>,
    /// Why there is no baseline, or what to know of it.
    reasons: Vec<String>,
}

/// A figure of a baseline.
#[derive(Debug, Serialize, ToSchema)]
struct BaselineFigure {
    /// The mean over its traces, weighted by their certainty.
    value: f64,
    /// Its standard deviation.
    std: f64,
    /// The traces that determine it.
    traces: usize,
}

impl From<Mean> for BaselineFigure {
    fn from(Mean { value, std, traces }: Mean) -> Self {
        Self { value, std, traces }
    }
}

/// Half of the way from a new actuator to its thresholds.
#[derive(Debug, Serialize, ToSchema)]
struct HealthyBelow {
    /// Torque-motor demagnetisation, 0 to 1.
    kgm: f64,
    /// Dynamic jack friction, N.
    fdj_n: f64,
}

/// A trace of a baseline.
#[derive(Debug, Serialize, ToSchema)]
struct BaselineTrace {
    /// The trace.
    trace_id: Id,
    /// When it was recorded.
    recorded_at: Timestamp,
    /// The actuator's usage then.
    usage: f64,
}

/// A trace that is not taken into a baseline.
#[derive(Debug, Serialize, ToSchema)]
struct PassedOverTrace {
    /// The trace.
    trace_id: Id,
    /// When it was recorded.
    recorded_at: Timestamp,
    /// Why it is not taken.
    reason: String,
}

impl BaselineDocument {
    /// What is served of the beginning of an actuator's life.
    #[must_use]
    pub fn of(actuator: &Actuator, opening: Opening, traces_wanted: usize) -> Self {
        let healthy = baselines::healthy(&actuator.thresholds);
        let reasons = reasons(&opening, traces_wanted);
        let Opening { life, taken, passed_over, baseline, .. } = opening;
        let gain = |kgm: Mean| Mean { value: 1.0 - kgm.value, ..kgm };
        Self {
            actuator_id: actuator.id,
            life_start: life.since(),
            life_start_usage: life.start.map(|event| event.usage),
            traces_wanted,
            complete: baseline.is_some(),
            kgm: baseline.map(|baseline| baseline.kgm.into()),
            gain: baseline.map(|baseline| gain(baseline.kgm).into()),
            fdj_n: baseline.map(|baseline| baseline.fdj_n.into()),
            current_offset_a: baseline.and_then(|baseline| baseline.current_offset_a).map(BaselineFigure::from),
            healthy_below: HealthyBelow { kgm: healthy.kgm_below, fdj_n: healthy.fdj_n_below },
            traces: taken.into_iter().map(BaselineTrace::from).collect(),
            passed_over: passed_over.iter().map(|(record, why)| PassedOverTrace::of(record, *why, &healthy)).collect(),
            reasons,
        }
    }
}

fn reasons(opening: &Opening, wanted: usize) -> Vec<String> {
    let taken = opening.taken.len();
    let mut reasons = Vec::new();
    if opening.given_up {
        reasons.push(format!(
            "only {taken} of the first {LOOKED_AT_MAX} traces of this life are healthy, {wanted} are needed: how the actuator \
             was when new is not known"
        ));
    } else if opening.baseline.is_none() {
        reasons
            .push(format!("{taken} of {wanted} healthy traces of this life are there: the baseline is being gathered"));
    }
    match opening.passed_over.len() {
        0 => {}
        1 => reasons.push("1 conclusive trace was not taken".into()),
        more => reasons.push(format!("{more} conclusive traces were not taken")),
    }
    reasons
}

impl From<HealthRecord> for BaselineTrace {
    fn from(HealthRecord { trace_id, recorded_at, usage, .. }: HealthRecord) -> Self {
        Self { trace_id, recorded_at, usage }
    }
}

impl PassedOverTrace {
    fn of(record: &HealthRecord, why: PassedOver, healthy: &Healthy) -> Self {
        let found = |value: Option<f64>| value.map_or("none".into(), |value| value.to_string());
        let (kgm, fdj_n) = (found(record.kgm), found(record.fdj_n));
        let kgm_told = format!("kgm: found {kgm}, expected below {}", healthy.kgm_below);
        let fdj_n_told = format!("fdj_n: found {fdj_n}, expected below {}", healthy.fdj_n_below);
        let reason = match why {
            PassedOver::Undetermined => "kgm and fdj_n are not both determined with their standard deviations".into(),
            PassedOver::Beyond { kgm: true, fdj_n: true } => format!("{kgm_told}; {fdj_n_told}"),
            PassedOver::Beyond { kgm: true, .. } => kgm_told,
            PassedOver::Beyond { .. } => fdj_n_told,
        };
        Self { trace_id: record.trace_id, recorded_at: record.recorded_at, reason }
    }
}
