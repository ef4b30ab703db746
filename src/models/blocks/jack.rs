//! The jack's parameters and the active force on its piston; each model adds its own friction.
//!
//! Source: section 4.1.4.
//! Signs: a positive load pressure (port 1 above port 2) drives a positive velocity; loads are positive against it.
//! Range: the end stops hold the position within ±XJM.
//! Limits: rigid piston rod and surface.

use serde::{Deserialize, Serialize};

use super::friction::Levels;
use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// The time step whose stability the jack's own parameters must allow, s: the thesis's.
const TIME_STEP_S: f64 = 1e-5;

/// The jack's parameters; the friction level is the fault FDJ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Effective piston area, m².
    #[doc(alias = "AJ")]
    pub area_m2: f64,
    /// Moving mass, kg.
    #[doc(alias = "MJ")]
    pub mass_kg: f64,
    /// Viscous damping, N s/m.
    #[doc(alias = "CJ")]
    pub damping_n_s_per_m: f64,
    /// Aerodynamic stiffness, N/m.
    #[doc(alias = "Kaer")]
    pub aerodynamic_stiffness_n_per_m: f64,
    /// Constant external load, N.
    pub external_load_n: f64,
    /// Static over dynamic friction, dimensionless; 2 in section 6.2.
    #[doc(alias = "FSJ")]
    pub friction_static_ratio: f64,
    /// Play between jack and surface, where the position is measured, m. Reference model only.
    #[doc(alias = "BLK")]
    pub backlash_m: f64,
    /// Step of the measured position, m; 0 for none. Reference model only.
    pub position_quantum_m: f64,
    /// End stop, m.
    #[doc(alias = "XJM")]
    pub position_max_m: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("jack.area_m2", self.area_m2, 1e-6, 1.0, "m2");
        checks.within("jack.mass_kg", self.mass_kg, 1e-2, 1e4, "kg");
        // A step must not take more than the jack's whole momentum away: CJ dt/MJ and Kaer dt²/MJ are at most 1.
        let damping_max = self.mass_kg / TIME_STEP_S;
        let damping = self.damping_n_s_per_m;
        checks.within_drawn("jack.damping_n_s_per_m", damping, (0.0, 1e6), (0.0, damping_max), "N s/m");
        let stiffness_max = damping_max / TIME_STEP_S;
        let stiffness = self.aerodynamic_stiffness_n_per_m;
        checks.within_drawn("jack.aerodynamic_stiffness_n_per_m", stiffness, (0.0, 1e9), (0.0, stiffness_max), "N/m");
        checks.within("jack.external_load_n", self.external_load_n, -1e6, 1e6, "N");
        checks.within("jack.friction_static_ratio", self.friction_static_ratio, 1.0, 10.0, "");
        checks.within("jack.backlash_m", self.backlash_m, 0.0, 0.1, "m");
        checks.within("jack.position_quantum_m", self.position_quantum_m, 0.0, 0.01, "m");
        checks.within("jack.position_max_m", self.position_max_m, 1e-3, 10.0, "m");
    }

    /// The friction levels at a dynamic friction FDJ.
    #[inline(always)]
    pub fn friction<L: Lane>(&self, dynamic_n: L) -> Levels<L> {
        Levels { static_n: dynamic_n * self.friction_static_ratio, dynamic_n }
    }

    /// The force that does not depend on the velocity, N: pressure, aerodynamic stiffness, load.
    #[inline(always)]
    pub fn driving_force_n<L: Lane>(&self, load_pressure_pa: L, position_m: L) -> L {
        load_pressure_pa * self.area_m2 - position_m * self.aerodynamic_stiffness_n_per_m - self.external_load_n
    }
}
