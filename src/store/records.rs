//! The records: what is known of actuators, traces, jobs and health, as plain values.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

use crate::estimation::Estimate;

/// An opaque identifier that sorts by the time of its creation (UUID version 7).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(value_type = String)]
pub struct Id(Uuid);

impl Id {
    /// A new identifier, later than every one made before it in this process.
    #[must_use]
    pub fn now() -> Self {
        Self(Uuid::now_v7())
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.as_hyphenated().fmt(f)
    }
}

impl FromStr for Id {
    type Err = uuid::Error;

    fn from_str(text: &str) -> Result<Self, uuid::Error> {
        Uuid::try_parse(text).map(Self)
    }
}

/// The time now, to the microsecond that records keep.
#[must_use]
pub fn now() -> Timestamp {
    to_microsecond(Timestamp::now())
}

/// A time as records keep it: what is finer than a microsecond is cut off.
#[must_use]
pub fn to_microsecond(time: Timestamp) -> Timestamp {
    Timestamp::from_microsecond(time.as_microsecond()).expect("a time cut short is still a time")
}

/// How an actuator's usage is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UsageUnit {
    /// Hours of flight.
    FlightHours,
    /// Flights.
    FlightCycles,
}

impl UsageUnit {
    /// The unit's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FlightHours => "flight_hours",
            Self::FlightCycles => "flight_cycles",
        }
    }
}

/// The fault levels at which an actuator counts as failed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Thresholds {
    /// Torque-motor demagnetisation KGM, 0.01 to 1.
    pub kgm: f64,
    /// Dynamic jack friction FDJ, N, 210 to 2000.
    pub fdj_n: f64,
}

impl Thresholds {
    /// The range of [`Thresholds::kgm`]; nearer to a healthy actuator's 0, no forecast is possible.
    pub const KGM: RangeInclusive<f64> = 0.01..=1.0;
    /// The range of [`Thresholds::fdj_n`], N; nearer to a healthy actuator's 200 N, no forecast is possible.
    pub const FDJ_N: RangeInclusive<f64> = 210.0..=2000.0;
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { kgm: 0.4, fdj_n: 1000.0 }
    }
}

/// An actuator of the fleet.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Actuator {
    /// Opaque id.
    pub id: Id,
    /// The part's serial number, unique in the service.
    pub serial_number: String,
    /// The aircraft.
    pub tail_number: String,
    /// Where on the aircraft, in free text.
    pub location: String,
    /// The name of its parameter set.
    pub parameter_set: String,
    /// The hash of the version of it that the actuator is pinned to. The built-in set's is that of the running program.
    pub parameter_set_hash: String,
    /// Its failure thresholds.
    pub thresholds: Thresholds,
    /// What its usage counts.
    pub usage_unit: UsageUnit,
    /// When it was registered.
    pub created_at: Timestamp,
    /// Grows with every change to its history or its thresholds.
    #[serde(skip)]
    pub revision: i64,
}

/// What is to change of an actuator; what is none stays as it is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ActuatorUpdate {
    /// The name and the hash of the parameter set's version to pin it to.
    pub parameter_set: Option<(String, String)>,
    /// Its threshold of KGM.
    pub threshold_kgm: Option<f64>,
    /// Its threshold of FDJ, N.
    pub threshold_fdj_n: Option<f64>,
}

/// A version of a parameter set as it is kept. It never changes.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSetRecord {
    /// Opaque id; of two versions of a name, the newer has the greater one.
    pub id: Id,
    /// The set's name.
    pub name: String,
    /// SHA-256 of its name and values, in hexadecimal.
    pub hash: String,
    /// Its sections, as JSON (`models::parameters::ParameterSet::to_json`).
    pub parameters: serde_json::Value,
    /// When it was kept.
    pub created_at: Timestamp,
}

/// What is known of a trace beside its bytes.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct TraceRecord {
    /// Opaque id.
    pub id: Id,
    /// The actuator it was recorded on; null for a simulated trace.
    pub actuator_id: Option<Id>,
    /// When it was recorded.
    pub recorded_at: Option<Timestamp>,
    /// The actuator's usage then.
    pub usage: Option<f64>,
    /// The media type of the kept bytes.
    pub media_type: String,
    /// How its columns were named, as the query said it (`from:to,...`); empty when they have their own names.
    pub columns: String,
    /// The sampling rate that the query gave for a trace without times, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Number of kept bytes.
    pub size_bytes: u64,
    /// SHA-256 of the kept bytes, in hexadecimal.
    pub sha256: String,
    /// Number of samples.
    pub samples: u64,
    /// Time from the first sample to the last, s.
    pub duration_s: f64,
    /// Whether it is excluded from its actuator's history.
    pub excluded: bool,
    /// Why; empty when it is not excluded.
    pub reason: String,
    /// When it was kept.
    pub created_at: Timestamp,
}

/// What a job does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    /// Estimates faults from a trace.
    Estimation,
    /// Makes a trace with a model.
    Simulation,
}

impl JobKind {
    /// The kind's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Estimation => "estimation",
            Self::Simulation => "simulation",
        }
    }
}

/// Where a job is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Waits for a worker.
    Queued,
    /// Is being worked on.
    Running,
    /// Ended with a result.
    Succeeded,
    /// Ended without one; `error` says why.
    Failed,
    /// Was cancelled before it ended.
    Cancelled,
}

impl JobState {
    /// Every state, in the order of a job's life.
    pub const ALL: [Self; 5] = [Self::Queued, Self::Running, Self::Succeeded, Self::Failed, Self::Cancelled];

    /// The state's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Succeeded => "succeeded",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }

    /// Whether nothing more will happen to the job.
    #[must_use]
    pub const fn is_final(self) -> bool {
        matches!(self, Self::Succeeded | Self::Failed | Self::Cancelled)
    }
}

/// A job that is about to be queued.
#[derive(Debug, Clone, PartialEq)]
pub struct NewJob {
    /// Opaque id.
    pub id: Id,
    /// What it does.
    pub kind: JobKind,
    /// What it needs to know, as JSON (`jobs::kind::JobSpec`).
    pub spec: serde_json::Value,
    /// When it was asked for.
    pub created_at: Timestamp,
}

/// A job as the store knows it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Job {
    /// Opaque id.
    pub id: Id,
    /// What it does.
    pub kind: JobKind,
    /// Where it is in its life.
    pub state: JobState,
    /// How far it has come, 0 to 1.
    pub progress: f64,
    /// How often it was started.
    pub attempt: u32,
    /// When it was asked for.
    pub created_at: Timestamp,
    /// When its newest attempt started.
    pub started_at: Option<Timestamp>,
    /// When it ended.
    pub finished_at: Option<Timestamp>,
    /// What it found.
    pub result: Option<serde_json::Value>,
    /// Why it failed.
    pub error: Option<String>,
    /// What it needs to know.
    #[serde(skip)]
    pub spec: serde_json::Value,
}

/// How an attempt ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// An estimation ended: with figures, or inconclusive.
    Estimated {
        /// The trace.
        trace_id: Id,
        /// What was found.
        estimate: Box<Estimate>,
        /// The job's `result`.
        result: serde_json::Value,
    },
    /// A simulation ended with a trace, whose bytes are in the trace store already.
    Simulated {
        /// The trace's record.
        trace: Box<TraceRecord>,
        /// The job's `result`.
        result: serde_json::Value,
    },
    /// The attempt failed.
    Failed {
        /// Why.
        error: String,
    },
}

/// One estimate in an actuator's history.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct HealthRecord {
    /// The trace that was estimated.
    pub trace_id: Id,
    /// The job that did it.
    pub job_id: Id,
    /// When the trace was recorded.
    pub recorded_at: Timestamp,
    /// The actuator's usage then.
    pub usage: f64,
    /// Torque-motor demagnetisation, 0 to 1.
    pub kgm: Option<f64>,
    /// Its standard deviation.
    pub kgm_std: Option<f64>,
    /// Dynamic jack friction, N.
    pub fdj_n: Option<f64>,
    /// Its standard deviation, N.
    pub fdj_n_std: Option<f64>,
    /// The other faults that were asked for, by their names with units, and their standard deviations under `..._std`.
    #[schema(example = json!({"clearance_m": 2.1e-6, "clearance_m_std": 1e-7}))]
    pub faults: BTreeMap<String, Option<f64>>,
    /// Whether the trace determined at least one fault.
    pub verdict: crate::estimation::Verdict,
}

/// What was done to an actuator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MaintenanceKind {
    /// Another part took its place: a new life.
    Replaced,
    /// It was brought back to new: a new life.
    Overhauled,
    /// It was looked at: its life goes on.
    Inspected,
}

impl MaintenanceKind {
    /// The kind's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Replaced => "replaced",
            Self::Overhauled => "overhauled",
            Self::Inspected => "inspected",
        }
    }
}

/// A maintenance event.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Maintenance {
    /// Opaque id.
    pub id: Id,
    /// The actuator.
    pub actuator_id: Id,
    /// What was done.
    pub kind: MaintenanceKind,
    /// When.
    pub at: Timestamp,
    /// The actuator's usage then.
    pub usage: f64,
    /// What else was noted.
    pub note: String,
    /// When the event was reported.
    pub created_at: Timestamp,
}

/// A forecast as it is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct ForecastRecord {
    /// The actuator.
    pub actuator_id: Id,
    /// The actuator's revision that it was made from.
    pub revision: i64,
    /// Probability that a threshold is passed within the service's risk horizon, 0 to 1; the fleet's order.
    pub risk: Option<f64>,
    /// Median remaining life, in the actuator's usage unit; null when unknown or beyond the forecast's horizon.
    pub median_remaining: Option<f64>,
    /// The forecast as it is served.
    pub document: serde_json::Value,
    /// What it rests on besides the history, such as the version that made it.
    pub basis: String,
    /// When it was made.
    pub created_at: Timestamp,
}

/// What a forecast said of an actuator or of one of its faults, as the trend keeps it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrendFigures {
    /// Remaining life is shorter than this with probability 0.05, in the actuator's usage unit; none beyond the horizon.
    pub q05: Option<f64>,
    /// The median of the remaining life.
    pub q50: Option<f64>,
    /// Remaining life is shorter than this with probability 0.95.
    pub q95: Option<f64>,
    /// The mean of the remaining life up to the horizon.
    pub mean: Option<f64>,
    /// Whether a threshold was passed already.
    pub reached: bool,
    /// The probability that a threshold is passed within the risk window, 0 to 1.
    pub risk: Option<f64>,
}

/// The figures of the faults; none where a fault could not be forecast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrendFaults {
    /// Torque-motor demagnetisation.
    pub kgm: Option<TrendFigures>,
    /// Dynamic jack friction.
    pub fdj_n: Option<TrendFigures>,
}

/// What the lives of one actuator say of those of its cohort, by one fault: numbers that are added up over a cohort.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetShare {
    /// The fault.
    pub fault: String,
    /// The name of the cohort; shares of one name have as many numbers.
    pub cohort: String,
    /// The numbers; none where nothing is known.
    pub tally: Vec<i32>,
    /// The prior that the actuator's own forecast had from its fleet, as a density; none without.
    pub prior: Vec<f64>,
}

/// The shares of a cohort, added up.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FleetTally {
    /// The actuators that have one.
    pub actuators: u64,
    /// The sums; none without an actuator.
    pub tally: Vec<i64>,
}

/// A step of an actuator's trend: what was forecast from the traces of a life up to one, the newest then.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendRecord {
    /// The actuator.
    pub actuator_id: Id,
    /// When the life began; none for the first, which began with the actuator.
    pub life_started_at: Option<Timestamp>,
    /// The usage at which it began; none for the first.
    pub life_start_usage: Option<f64>,
    /// The newest trace of the life.
    pub trace_id: Id,
    /// When that trace was recorded.
    pub recorded_at: Timestamp,
    /// The usage from which remaining life counts.
    pub usage: f64,
    /// When the forecast was made.
    pub made_at: Timestamp,
    /// The usage ahead that the risks are about.
    pub risk_window: f64,
    /// The figures of the actuator, whichever fault comes first; none without a forecast.
    pub actuator: Option<TrendFigures>,
    /// The figures of its faults.
    pub faults: TrendFaults,
    /// What the forecast rests on besides the history.
    pub basis: String,
    /// The elevon version that made it.
    pub version: String,
}
