//! The developed fluid: the load pressure that a spool position commands, less what the flow costs, after a lag.
//!
//! Source: section 5.3, final version, with the bell as a lag of `lag_scale_s` (docs/conventions.md).
//! Signs: as in the parent module.
//! Range: calibrated for large flows; |XS| to several times XSS.
//! Limits: GQ/GP does not vary with the supply.

use super::super::State;
use super::Params;
use crate::numeric::lane::Lane;
use crate::numeric::tanh::tanh;

/// The developed fluid with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    supply_pa: f64,
    /// 1/XSS, 1/m.
    per_saturation: f64,
    /// GQ/GP, m³/(s Pa).
    flow_per_pressure: f64,
    leakage_m3_per_s_per_pa: f64,
    per_flow_reference: f64,
    /// Scale times a, s.
    lag_numerator_s: f64,
    lag_bell_b: f64,
    lag_bell_c: f64,
    lag_flow_slope_s_per_m3: f64,
}

/// What the spool's position makes of the fluid.
#[derive(Debug, Clone, Copy)]
pub struct AtSpool<L> {
    /// Pressure at zero flow (P12P), Pa.
    pub commanded_pa: L,
    /// Loss per squared flow, Pa s²/m⁶.
    pub loss: L,
    /// Lag at zero flow, s.
    pub lag_s: L,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        Self {
            supply_pa: p.supply_pressure_differential_pa,
            per_saturation: 1.0 / p.spool_saturation_m,
            flow_per_pressure: p.flow_gain_m2_per_s / p.pressure_gain_pa_per_m(),
            leakage_m3_per_s_per_pa: p.leakage_m3_per_s_per_pa,
            per_flow_reference: 1.0 / p.flow_reference_m3_per_s,
            lag_numerator_s: p.lag_scale_s * p.lag_bell_a,
            lag_bell_b: p.lag_bell_b,
            lag_bell_c: p.lag_bell_c,
            lag_flow_slope_s_per_m3: p.lag_flow_slope_s_per_m3,
        }
    }

    /// What a spool position makes of the fluid, the supply being a part of PSR.
    #[inline(always)]
    pub fn at_spool<L: Lane>(&self, spool_position_m: L, supply_factor: f64) -> AtSpool<L> {
        let u = spool_position_m * self.per_saturation;
        let u_squared = u * u;
        let conductance = u_squared * self.flow_per_pressure + self.leakage_m3_per_s_per_pa;
        let bell = u_squared * self.lag_bell_b + self.lag_bell_c;
        AtSpool {
            commanded_pa: tanh(u) * (self.supply_pa * supply_factor),
            loss: u.same(self.per_flow_reference) / conductance,
            lag_s: u.same(self.lag_numerator_s) / bell,
        }
    }

    /// The factor by which a flow lengthens the lag.
    #[inline(always)]
    pub fn lag_factor<L: Lane>(&self, flow_magnitude_m3_per_s: L) -> L {
        flow_magnitude_m3_per_s * self.lag_flow_slope_s_per_m3 + 1.0
    }

    /// The load pressure without the lag, Pa.
    #[inline(always)]
    pub fn steady_pa<L: Lane>(&self, spool_position_m: L, flow_m3_per_s: L, supply_factor: f64) -> L {
        target_pa(&self.at_spool(spool_position_m, supply_factor), flow_m3_per_s)
    }

    /// The flow at a spool position and a load pressure, m³/s.
    #[must_use]
    pub fn flow_m3_per_s(&self, spool_position_m: f64, load_pressure_pa: f64) -> f64 {
        let at = self.at_spool(spool_position_m, 1.0);
        let lost_pa = at.commanded_pa - load_pressure_pa;
        (lost_pa.abs() / at.loss).sqrt().copysign(lost_pa)
    }

    /// The load pressure after a step with the lag taken implicitly, Pa.
    #[inline(always)]
    pub fn step<L: Lane>(
        &self,
        s: &State<L>,
        spool_position_m: L,
        flow_m3_per_s: L,
        supply_factor: f64,
        time_step_s: f64,
    ) -> L {
        let at = self.at_spool(spool_position_m, supply_factor);
        let lag_s = at.lag_s * self.lag_factor(flow_m3_per_s.abs());
        let target_pa = target_pa(&at, flow_m3_per_s);
        s.load_pressure_pa + (target_pa - s.load_pressure_pa) * time_step_s / (lag_s + time_step_s)
    }
}

/// What the pressure tends to, Pa.
#[inline(always)]
fn target_pa<L: Lane>(at: &AtSpool<L>, flow_m3_per_s: L) -> L {
    at.commanded_pa - flow_m3_per_s * flow_m3_per_s.abs() * at.loss
}
