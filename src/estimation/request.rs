//! What an estimation is asked for: the faults, and the objective that is minimised.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::models::fault::{self, CLEARANCE_MAX_M, FDJ_MAX_N, FDJ_NOMINAL_N, Faults};

/// A fault that can be estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// Torque-motor demagnetisation KGM.
    Kgm,
    /// Dynamic jack friction FDJ.
    Fdj,
    /// Radial clearance of the sleeve beyond the nominal one: a leaking valve.
    Clearance,
    /// Filter clogging.
    Clogging,
    /// Play between the feedback spring and the spool.
    FeedbackBacklash,
    /// Offset of the torque motor's current.
    CurrentOffset,
}

impl Fault {
    /// Every fault that can be estimated, in the order of their names' columns.
    pub const ALL: [Self; 6] =
        [Self::Kgm, Self::Fdj, Self::Clearance, Self::Clogging, Self::FeedbackBacklash, Self::CurrentOffset];

    /// The fault of the models.
    const fn modelled(self) -> fault::Fault {
        match self {
            Self::Kgm => fault::Fault::Kgm,
            Self::Fdj => fault::Fault::Fdj,
            Self::Clearance => fault::Fault::Clearance,
            Self::Clogging => fault::Fault::Clogging,
            Self::FeedbackBacklash => fault::Fault::FeedbackBacklash,
            Self::CurrentOffset => fault::Fault::CurrentOffset,
        }
    }

    /// Its name on the command line and over HTTP.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.modelled().name()
    }

    /// Its figure's name in an estimate, with the unit.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Kgm => "kgm",
            Self::Fdj => "fdj_n",
            Self::Clearance => "clearance_m",
            Self::Clogging => "clogging",
            Self::FeedbackBacklash => "feedback_backlash_m",
            Self::CurrentOffset => "current_offset_a",
        }
    }

    /// The range that is searched, in SI units.
    #[must_use]
    pub const fn range(self) -> (f64, f64) {
        match self {
            Self::Kgm => (0.0, 1.0),
            Self::Fdj => (FDJ_NOMINAL_N, FDJ_MAX_N),
            Self::Clearance => (0.0, CLEARANCE_MAX_M),
            Self::Clogging => (0.0, 0.9),
            Self::FeedbackBacklash => (0.0, 5e-5),
            Self::CurrentOffset => (-0.005, 0.005),
        }
    }

    /// Its figure in a set of faults.
    #[must_use]
    pub const fn of(self, faults: &Faults) -> f64 {
        let mut faults = *faults;
        *self.of_mut(&mut faults)
    }

    /// Its place in a set of faults.
    pub const fn of_mut(self, faults: &mut Faults) -> &mut f64 {
        self.modelled().of_mut(faults)
    }
}

/// The faults that are asked for: at least one, each once. Those that are not are held at their healthy values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Requested {
    asked: [bool; Fault::ALL.len()],
}

impl Requested {
    /// Demagnetisation and friction: what is asked for unless told.
    pub const KGM_AND_FDJ: Self = Self { asked: [true, true, false, false, false, false] };

    /// Whether a fault is asked for.
    #[must_use]
    pub const fn has(&self, fault: Fault) -> bool {
        self.asked[fault as usize]
    }

    /// The faults that are asked for, in their order.
    #[must_use]
    pub fn faults(&self) -> Vec<Fault> {
        Fault::ALL.into_iter().filter(|fault| self.has(*fault)).collect()
    }
}

impl Default for Requested {
    fn default() -> Self {
        Self::KGM_AND_FDJ
    }
}

impl fmt::Display for Requested {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.faults().iter().map(|fault| fault.name()).collect::<Vec<_>>().join(","))
    }
}

impl FromStr for Requested {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut asked = [false; Fault::ALL.len()];
        for part in text.split(',').map(str::trim) {
            let fault = Fault::ALL.into_iter().find(|fault| fault.name() == part);
            let fault = fault.ok_or_else(|| {
                format!(
                    "found {part:?}, expected some of {} with commas between them",
                    Fault::ALL.map(Fault::name).join(", ")
                )
            })?;
            if std::mem::replace(&mut asked[fault as usize], true) {
                return Err(format!("found {part:?} twice, expected each fault once"));
            }
        }
        Ok(Self { asked })
    }
}

impl TryFrom<String> for Requested {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Requested> for String {
    fn from(requested: Requested) -> Self {
        requested.to_string()
    }
}

/// What is minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// The features where they suffice, the whole trace elsewhere.
    #[default]
    Auto,
    /// The thesis's two features (section 7.2): the ramp's steady current and the pressure after the step.
    Features,
    /// The residuals of every recorded channel over the whole trace.
    Trace,
}

impl Objective {
    /// Every objective.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Features, Self::Trace];

    /// Its name on the command line, over HTTP and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Features => "features",
            Self::Trace => "trace",
        }
    }
}

impl FromStr for Objective {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|objective| objective.name() == text);
        named.ok_or_else(|| format!("found {text:?}, expected one of {}", Self::ALL.map(Self::name).join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requested_faults_are_read_in_any_order_and_told_in_theirs() {
        let requested: Requested = "fdj, kgm,clearance".parse().unwrap();
        assert_eq!(requested.to_string(), "kgm,fdj,clearance");
        assert_eq!(serde_json::to_string(&requested).unwrap(), "\"kgm,fdj,clearance\"");
        assert_eq!(Requested::default().faults(), [Fault::Kgm, Fault::Fdj]);
    }

    #[test]
    fn an_unknown_a_double_and_no_fault_are_refused() {
        for (text, found) in [("kgm,rust", "\"rust\""), ("kgm,kgm", "twice"), ("", "\"\"")] {
            let error = text.parse::<Requested>().unwrap_err();
            assert!(error.contains(found), "{error}");
        }
    }
}
