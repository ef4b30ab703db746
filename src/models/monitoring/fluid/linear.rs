//! The linear fluid: superposition on the spool's position of what makes pressure and what makes flow.
//!
//! Source: section 5.1, figure 5.1: P12 = GP (XS - QJ/GQ), held within ±PSR.
//! Signs: as in the parent module.
//! Range: any spool position and flow.
//! Limits: no leakage; what the spool opens beyond saturation is lost. GP and GQ follow the supply as section 5.2 says.

use super::Params;
use crate::numeric::lane::Lane;

/// The linear fluid with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    supply_pa: f64,
    /// GP, Pa/m.
    pressure_gain_pa_per_m: f64,
    /// GP/GQ, Pa s/m³.
    pressure_per_flow: f64,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        let pressure_gain_pa_per_m = p.pressure_gain_pa_per_m();
        Self {
            supply_pa: p.supply_pressure_differential_pa,
            pressure_gain_pa_per_m,
            pressure_per_flow: pressure_gain_pa_per_m / p.linear_flow_gain_m2_per_s,
        }
    }

    /// The load pressure, Pa.
    #[inline(always)]
    pub fn load_pressure_pa<L: Lane>(&self, spool_position_m: L, flow_m3_per_s: L, supply_factor: f64) -> L {
        let gain_pa_per_m = self.pressure_gain_pa_per_m * supply_factor;
        let load_pa = spool_position_m * gain_pa_per_m - flow_m3_per_s * self.pressure_per_flow;
        load_pa.clip(load_pa.same(self.supply_pa * supply_factor))
    }

    /// The flow at a spool position and a load pressure, m³/s: QJ = GQ (XS - P12/GP), the section's second relation.
    #[must_use]
    pub fn flow_m3_per_s(&self, spool_position_m: f64, load_pressure_pa: f64) -> f64 {
        (spool_position_m * self.pressure_gain_pa_per_m - load_pressure_pa) / self.pressure_per_flow
    }
}
