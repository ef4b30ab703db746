//! Alerts as they are kept: what was noticed of an actuator, and what became of it.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::records::{Id, UsageUnit};

/// What an alert is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlertKind {
    /// A fault's level has reached its threshold.
    Threshold,
    /// A failure within the risk window has become too probable.
    Risk,
}

impl AlertKind {
    /// Every kind.
    pub const ALL: [Self; 2] = [Self::Threshold, Self::Risk];

    /// The kind's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Threshold => "threshold",
            Self::Risk => "risk",
        }
    }
}

/// A fault that has a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlertFault {
    /// Torque-motor demagnetisation.
    Kgm,
    /// Dynamic jack friction.
    FdjN,
}

impl AlertFault {
    /// The fault's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kgm => "kgm",
            Self::FdjN => "fdj_n",
        }
    }
}

/// Where an alert is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlertState {
    /// Nobody has answered it yet.
    Open,
    /// Somebody knows of it; its cause is still there.
    Acknowledged,
    /// Its cause is gone.
    Cleared,
}

impl AlertState {
    /// Every state, in the order of an alert's life.
    pub const ALL: [Self; 3] = [Self::Open, Self::Acknowledged, Self::Cleared];

    /// The state's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Acknowledged => "acknowledged",
            Self::Cleared => "cleared",
        }
    }
}

/// Why an alert was cleared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClearedBecause {
    /// The fault's level lies well below its threshold again.
    LevelFell,
    /// The risk lies below the bound at which it is cleared.
    RiskFell,
    /// A maintenance event began a new life.
    Maintenance,
}

impl ClearedBecause {
    /// The reason's name in JSON and in the database.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LevelFell => "level_fell",
            Self::RiskFell => "risk_fell",
            Self::Maintenance => "maintenance",
        }
    }
}

/// An alert, as it is kept, served and sent.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Alert {
    /// Opaque id.
    pub id: Id,
    /// The actuator.
    pub actuator_id: Id,
    /// The part's serial number.
    pub serial_number: String,
    /// The aircraft.
    pub tail_number: String,
    /// What it is about.
    pub kind: AlertKind,
    /// The fault whose level reached its threshold; null for a risk, which is that of the actuator.
    pub fault: Option<AlertFault>,
    /// Where it is in its life.
    pub state: AlertState,
    /// When it was raised.
    pub raised_at: Timestamp,
    /// When somebody acknowledged it.
    pub acknowledged_at: Option<Timestamp>,
    /// When it was cleared.
    pub cleared_at: Option<Timestamp>,
    /// Why it was cleared.
    pub cleared_because: Option<ClearedBecause>,
    /// The actuator's usage when it was raised.
    pub usage: f64,
    /// What its usage counts.
    pub usage_unit: UsageUnit,
    /// The fault's newest level when the alert was raised, in the fault's unit (N for `fdj_n`); null for a risk.
    pub value: Option<f64>,
    /// The standard deviation of that level, where it is known.
    pub value_std: Option<f64>,
    /// The level at which the actuator counts as failed; null for a risk.
    pub threshold: Option<f64>,
    /// The probability of a failure within the window when the alert was raised, 0 to 1; null for a threshold.
    pub risk: Option<f64>,
    /// The probability from which an alert is raised; null for a threshold.
    pub limit: Option<f64>,
    /// The window that the risk is about, in the actuator's usage unit; null for a threshold.
    pub within: Option<f64>,
    /// The newest trace that it rests on.
    pub trace_id: Option<Id>,
    /// What was noted when it was acknowledged.
    pub note: String,
    /// What it says, in a sentence.
    pub message: String,
}

/// The figures for which an alert is raised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cause {
    /// A fault's level has reached its threshold.
    Threshold {
        /// The fault.
        fault: AlertFault,
        /// Its newest level, in the fault's unit.
        value: f64,
        /// The standard deviation of that level.
        value_std: Option<f64>,
        /// The level at which the actuator counts as failed.
        threshold: f64,
        /// The trace that the newest level is from.
        trace_id: Id,
    },
    /// A failure within the window has become too probable.
    Risk {
        /// The probability, 0 to 1.
        risk: f64,
        /// The probability from which an alert is raised.
        limit: f64,
        /// The window, in the actuator's usage unit.
        within: f64,
        /// The newest trace that the risk rests on.
        trace_id: Option<Id>,
    },
}

impl Cause {
    /// What the alert is about.
    #[must_use]
    pub const fn kind(&self) -> AlertKind {
        match self {
            Self::Threshold { .. } => AlertKind::Threshold,
            Self::Risk { .. } => AlertKind::Risk,
        }
    }

    /// The fault that it is about; none for a risk.
    #[must_use]
    pub const fn fault(&self) -> Option<AlertFault> {
        match self {
            Self::Threshold { fault, .. } => Some(*fault),
            Self::Risk { .. } => None,
        }
    }
}

/// An alert that is about to be raised.
#[derive(Debug, Clone, PartialEq)]
pub struct NewAlert {
    /// Opaque id.
    pub id: Id,
    /// The figures.
    pub cause: Cause,
    /// The actuator's usage.
    pub usage: f64,
    /// What it says, in a sentence.
    pub message: String,
    /// When.
    pub raised_at: Timestamp,
}

/// What a forecast changes of its actuator's alerts.
#[derive(Debug, Clone, PartialEq)]
pub enum AlertChange {
    /// Raises an alert, unless one of its kind and fault is open.
    Raise(Box<NewAlert>),
    /// Clears an alert, unless it is cleared already.
    Clear {
        /// The alert.
        id: Id,
        /// Why.
        because: ClearedBecause,
        /// When.
        at: Timestamp,
    },
}
