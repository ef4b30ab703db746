//! The monitoring model's fluid: from the spool's position and the flow to the load pressure, in four forms.
//!
//! Source: chapter 5, in order of increasing complexity: sections 5.1, 5.2, 5.3's first version, 5.3's final one.
//! Signs: a positive spool position commands a positive load pressure; a positive flow lowers it.
//! Range: |XS| to several times XSS; the supply's factor 0 and above.
//! Limits: symmetrical edges; XSS and GP/GQ do not vary with the supply (section 5.2).

pub mod developed;
pub mod evolved;
pub mod linear;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::State;
use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// Which of chapter 5's fluids the monitoring model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FluidModel {
    /// Section 5.1: pressure and flow each in proportion to the spool's position.
    Linear,
    /// Section 5.2: a pressure gain that falls beyond saturation, with leakage.
    Evolved,
    /// Section 5.3's first version: tanh and a loss quadratic in the flow, at once. For characteristic curves: in the
    /// closed loop it oscillates from step to step.
    DevelopedWithoutLag,
    /// Section 5.3's final version: the same after a lag.
    #[default]
    Developed,
}

impl FluidModel {
    /// Every fluid, in the order of the thesis.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Evolved, Self::DevelopedWithoutLag, Self::Developed];
}

/// The fluids' parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Supply minus return pressure, Pa.
    #[doc(alias = "PSR")]
    pub supply_pressure_differential_pa: f64,
    /// Spool position of saturation, m.
    #[doc(alias = "XSS")]
    pub spool_saturation_m: f64,
    /// Flow gain of the developed fluid, m²/s.
    #[doc(alias = "GQ")]
    pub flow_gain_m2_per_s: f64,
    /// Flow gain of the linear fluid, m²/s.
    #[doc(alias = "GQ")]
    pub linear_flow_gain_m2_per_s: f64,
    /// Flow gain of the evolved fluid, m²/s.
    #[doc(alias = "GQ")]
    pub evolved_flow_gain_m2_per_s: f64,
    /// Leakage, m³/(s Pa).
    #[doc(alias = "Clk")]
    pub leakage_m3_per_s_per_pa: f64,
    /// The flow at which the quadratic loss equals the linear one, m³/s.
    pub flow_reference_m3_per_s: f64,
    /// Scale of the lag, s.
    pub lag_scale_s: f64,
    /// Numerator of the lag's bell, dimensionless.
    pub lag_bell_a: f64,
    /// Factor of the squared spool position in the bell's denominator, dimensionless.
    pub lag_bell_b: f64,
    /// Constant of the bell's denominator, dimensionless.
    pub lag_bell_c: f64,
    /// Growth of the lag with the flow, s/m³.
    pub lag_flow_slope_s_per_m3: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        let supply_pa = self.supply_pressure_differential_pa;
        checks.within("monitoring.fluid.supply_pressure_differential_pa", supply_pa, 1e4, 1e9, "Pa");
        checks.within("monitoring.fluid.spool_saturation_m", self.spool_saturation_m, 1e-7, 1e-2, "m");
        checks.within("monitoring.fluid.flow_gain_m2_per_s", self.flow_gain_m2_per_s, 1e-6, 1e3, "m2/s");
        let linear = self.linear_flow_gain_m2_per_s;
        checks.within("monitoring.fluid.linear_flow_gain_m2_per_s", linear, 1e-6, 1e3, "m2/s");
        let evolved = self.evolved_flow_gain_m2_per_s;
        checks.within("monitoring.fluid.evolved_flow_gain_m2_per_s", evolved, 1e-6, 1e3, "m2/s");
        let leakage = self.leakage_m3_per_s_per_pa;
        checks.within("monitoring.fluid.leakage_m3_per_s_per_pa", leakage, 1e-18, 1e-8, "m3/(s Pa)");
        let reference = self.flow_reference_m3_per_s;
        checks.within("monitoring.fluid.flow_reference_m3_per_s", reference, 1e-9, 1.0, "m3/s");
        checks.within("monitoring.fluid.lag_scale_s", self.lag_scale_s, 1e-5, 1.0, "s");
        checks.within("monitoring.fluid.lag_bell_a", self.lag_bell_a, 1e-3, 1e3, "");
        checks.within("monitoring.fluid.lag_bell_b", self.lag_bell_b, 0.0, 1e3, "");
        checks.within("monitoring.fluid.lag_bell_c", self.lag_bell_c, 1e-3, 1e3, "");
        checks.within("monitoring.fluid.lag_flow_slope_s_per_m3", self.lag_flow_slope_s_per_m3, 0.0, 1e9, "s/m3");
    }

    /// GP = PSR/XSS, Pa/m.
    #[must_use]
    pub fn pressure_gain_pa_per_m(&self) -> f64 {
        self.supply_pressure_differential_pa / self.spool_saturation_m
    }
}

/// The chosen fluid with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub enum Block {
    /// Section 5.1.
    Linear(linear::Block),
    /// Section 5.2.
    Evolved(evolved::Block),
    /// Section 5.3 without the lag.
    DevelopedWithoutLag(developed::Block),
    /// Section 5.3.
    Developed(developed::Block),
}

impl Block {
    /// Prepares a fluid.
    #[must_use]
    pub fn new(p: &Params, fluid: FluidModel) -> Self {
        match fluid {
            FluidModel::Linear => Self::Linear(linear::Block::new(p)),
            FluidModel::Evolved => Self::Evolved(evolved::Block::new(p)),
            FluidModel::DevelopedWithoutLag => Self::DevelopedWithoutLag(developed::Block::new(p)),
            FluidModel::Developed => Self::Developed(developed::Block::new(p)),
        }
    }

    /// The load pressure in the long run at a spool position, a flow and a supply as a part of PSR, Pa.
    #[inline(always)]
    pub fn steady_pa<L: Lane>(&self, spool_position_m: L, flow_m3_per_s: L, supply_factor: f64) -> L {
        match self {
            Self::Linear(block) => block.load_pressure_pa(spool_position_m, flow_m3_per_s, supply_factor),
            Self::Evolved(block) => block.load_pressure_pa(spool_position_m, flow_m3_per_s, supply_factor),
            Self::DevelopedWithoutLag(block) | Self::Developed(block) => {
                block.steady_pa(spool_position_m, flow_m3_per_s, supply_factor)
            }
        }
    }

    /// The flow at a spool position and a load pressure at the set's supply, m³/s: the steady pressure's inverse.
    #[must_use]
    pub fn flow_m3_per_s(&self, spool_position_m: f64, load_pressure_pa: f64) -> f64 {
        match self {
            Self::Linear(block) => block.flow_m3_per_s(spool_position_m, load_pressure_pa),
            Self::Evolved(block) => block.flow_m3_per_s(spool_position_m, load_pressure_pa),
            Self::DevelopedWithoutLag(block) | Self::Developed(block) => {
                block.flow_m3_per_s(spool_position_m, load_pressure_pa)
            }
        }
    }

    /// The load pressure after a step, Pa.
    #[inline(always)]
    pub fn step<L: Lane>(
        &self,
        s: &State<L>,
        spool_position_m: L,
        flow_m3_per_s: L,
        supply_factor: f64,
        time_step_s: f64,
    ) -> L {
        match self {
            Self::Developed(block) => block.step(s, spool_position_m, flow_m3_per_s, supply_factor, time_step_s),
            _ => self.steady_pa(spool_position_m, flow_m3_per_s, supply_factor),
        }
    }
}

#[cfg(test)]
mod tests;
