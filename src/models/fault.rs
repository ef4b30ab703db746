//! Faults: what grows in an actuator, as changes of a model's parameters made before a run.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Nominal dynamic jack friction, N (thesis, section 6.2).
pub const FDJ_NOMINAL_N: f64 = 200.0;
/// The most dynamic jack friction that is searched or simulated, N (thesis, section 7.2).
pub const FDJ_MAX_N: f64 = 2000.0;
/// The most extra radial clearance of the sleeve that is simulated, m.
pub const CLEARANCE_MAX_M: f64 = 1e-4;

/// The faults of one run. The default is a healthy actuator.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Faults {
    /// Torque-motor demagnetisation KGM, 0 (none) to 1 (no force left); section 6.1.
    #[schema(minimum = 0, maximum = 1)]
    pub kgm: f64,
    /// Dynamic jack friction FDJ, N, 200 (nominal) to 2000; section 6.2.
    #[schema(minimum = 200, maximum = 2000)]
    pub fdj_n: f64,
    /// Radial clearance of the sleeve beyond the nominal one, m, 0 to 1e-4; section 7.2, third test. Reference model only.
    #[schema(minimum = 0, maximum = 0.0001)]
    pub clearance_m: f64,
    /// Filter clogging (Kintas), 0 (clean) to 1 (closed); section 4.1.2. Reference model only.
    #[schema(minimum = 0, maximum = 1)]
    pub clogging: f64,
    /// Play between the feedback spring and the spool (Kgioco), m, 0 to 1e-4; section 4.1.2. Reference model only.
    #[schema(minimum = 0, maximum = 0.0001)]
    pub feedback_backlash_m: f64,
    /// Play between jack and surface, m, 0 to 0.01; section 4.1.4. Reference model only.
    #[schema(minimum = 0, maximum = 0.01)]
    pub jack_backlash_m: f64,
    /// Offset of the torque motor's current, A, -0.02 to 0.02; section 4.1.1. Reference model only.
    #[schema(minimum = -0.02, maximum = 0.02)]
    pub current_offset_a: f64,
    /// Hysteresis of the torque motor (His), A, 0 to 0.02; section 4.1.1. Reference model only.
    #[schema(minimum = 0, maximum = 0.02)]
    pub hysteresis_a: f64,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            kgm: 0.0,
            fdj_n: FDJ_NOMINAL_N,
            clearance_m: 0.0,
            clogging: 0.0,
            feedback_backlash_m: 0.0,
            jack_backlash_m: 0.0,
            current_offset_a: 0.0,
            hysteresis_a: 0.0,
        }
    }
}

/// A fault by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// Play between jack and surface.
    JackBacklash,
    /// Offset of the torque motor's current.
    CurrentOffset,
    /// Hysteresis of the torque motor.
    Hysteresis,
}

impl Fault {
    /// Every fault.
    pub const ALL: [Self; 8] = [
        Self::Kgm,
        Self::Fdj,
        Self::Clearance,
        Self::Clogging,
        Self::FeedbackBacklash,
        Self::JackBacklash,
        Self::CurrentOffset,
        Self::Hysteresis,
    ];

    /// Its name on the command line and over HTTP.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kgm => "kgm",
            Self::Fdj => "fdj",
            Self::Clearance => "clearance",
            Self::Clogging => "clogging",
            Self::FeedbackBacklash => "feedback_backlash",
            Self::JackBacklash => "jack_backlash",
            Self::CurrentOffset => "current_offset",
            Self::Hysteresis => "hysteresis",
        }
    }

    /// Its place in a set of faults, in SI units.
    pub const fn of_mut(self, faults: &mut Faults) -> &mut f64 {
        match self {
            Self::Kgm => &mut faults.kgm,
            Self::Fdj => &mut faults.fdj_n,
            Self::Clearance => &mut faults.clearance_m,
            Self::Clogging => &mut faults.clogging,
            Self::FeedbackBacklash => &mut faults.feedback_backlash_m,
            Self::JackBacklash => &mut faults.jack_backlash_m,
            Self::CurrentOffset => &mut faults.current_offset_a,
            Self::Hysteresis => &mut faults.hysteresis_a,
        }
    }
}
