//! The evolved fluid: a pressure gain that falls with the spool's position beyond saturation, and leakage.
//!
//! Source: section 5.2, figure 5.4: P12 = (PSR XS - GPQ XSS QJ)/(max(|XS|, XSS) + GPQ XSS Clk), GPQ = GP/GQ.
//! Signs: as in the parent module.
//! Range: any spool position and flow; the pressure passes PSR at small positions with large flows (water hammer).
//! Limits: XSS and GPQ do not vary with the supply.

use super::Params;
use crate::numeric::lane::Lane;

/// The evolved fluid with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    supply_pa: f64,
    spool_saturation_m: f64,
    /// GPQ XSS, Pa s/m².
    loss_pa_s_per_m2: f64,
    /// GPQ XSS Clk, m.
    leakage_m: f64,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        // GPQ XSS = GP/GQ XSS = PSR/GQ.
        let loss_pa_s_per_m2 = p.supply_pressure_differential_pa / p.evolved_flow_gain_m2_per_s;
        Self {
            supply_pa: p.supply_pressure_differential_pa,
            spool_saturation_m: p.spool_saturation_m,
            loss_pa_s_per_m2,
            leakage_m: loss_pa_s_per_m2 * p.leakage_m3_per_s_per_pa,
        }
    }

    /// The load pressure, Pa.
    #[inline(always)]
    pub fn load_pressure_pa<L: Lane>(&self, spool_position_m: L, flow_m3_per_s: L, supply_factor: f64) -> L {
        let supply_pa = self.supply_pa * supply_factor;
        let reach_m = spool_position_m.abs().max(spool_position_m.same(self.spool_saturation_m)) + self.leakage_m;
        (spool_position_m * supply_pa - flow_m3_per_s * self.loss_pa_s_per_m2) / reach_m
    }

    /// The flow at a spool position and a load pressure, m³/s.
    #[must_use]
    pub fn flow_m3_per_s(&self, spool_position_m: f64, load_pressure_pa: f64) -> f64 {
        let reach_m = spool_position_m.abs().max(self.spool_saturation_m) + self.leakage_m;
        (spool_position_m * self.supply_pa - load_pressure_pa * reach_m) / self.loss_pa_s_per_m2
    }
}
