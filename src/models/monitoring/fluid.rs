//! The developed fluid: the load pressure that a spool position commands, less what the flow costs, after a lag.
//!
//! Source: section 5.3, final version, with the bell as a lag of `lag_scale_s` (docs/conventions.md).
//! Signs: a positive spool position commands a positive load pressure; a positive flow lowers it.
//! Range: calibrated for large flows; |XS| to several times XSS.
//! Limits: constant supply; symmetrical edges.

use serde::{Deserialize, Serialize};

use super::State;
use crate::models::checks::Checks;
use crate::numeric::lane::Lane;
use crate::numeric::tanh::tanh;

/// The fluid's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Supply minus return pressure, Pa.
    #[doc(alias = "PSR")]
    pub supply_pressure_differential_pa: f64,
    /// Spool position of saturation, m.
    #[doc(alias = "XSS")]
    pub spool_saturation_m: f64,
    /// Flow gain, m²/s.
    #[doc(alias = "GQ")]
    pub flow_gain_m2_per_s: f64,
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
}

/// The fluid with what can be worked out before a run.
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
        let pressure_gain_pa_per_m = p.supply_pressure_differential_pa / p.spool_saturation_m;
        Self {
            supply_pa: p.supply_pressure_differential_pa,
            per_saturation: 1.0 / p.spool_saturation_m,
            flow_per_pressure: p.flow_gain_m2_per_s / pressure_gain_pa_per_m,
            leakage_m3_per_s_per_pa: p.leakage_m3_per_s_per_pa,
            per_flow_reference: 1.0 / p.flow_reference_m3_per_s,
            lag_numerator_s: p.lag_scale_s * p.lag_bell_a,
            lag_bell_b: p.lag_bell_b,
            lag_bell_c: p.lag_bell_c,
            lag_flow_slope_s_per_m3: p.lag_flow_slope_s_per_m3,
        }
    }

    /// What a spool position makes of the fluid.
    #[inline(always)]
    pub fn at_spool<L: Lane>(&self, spool_position_m: L) -> AtSpool<L> {
        let u = spool_position_m * self.per_saturation;
        let u_squared = u * u;
        let conductance = u_squared * self.flow_per_pressure + self.leakage_m3_per_s_per_pa;
        let bell = u_squared * self.lag_bell_b + self.lag_bell_c;
        AtSpool {
            commanded_pa: tanh(u) * self.supply_pa,
            loss: u.same(self.per_flow_reference) / conductance,
            lag_s: u.same(self.lag_numerator_s) / bell,
        }
    }

    /// The factor by which a flow lengthens the lag.
    #[inline(always)]
    pub fn lag_factor<L: Lane>(&self, flow_magnitude_m3_per_s: L) -> L {
        flow_magnitude_m3_per_s * self.lag_flow_slope_s_per_m3 + 1.0
    }

    /// The load pressure after a step with the lag taken implicitly, Pa.
    #[inline(always)]
    pub fn step<L: Lane>(&self, s: &State<L>, spool_position_m: L, flow_m3_per_s: L, time_step_s: f64) -> L {
        let at = self.at_spool(spool_position_m);
        let magnitude = flow_m3_per_s.abs();
        let target_pa = at.commanded_pa - flow_m3_per_s * magnitude * at.loss;
        let lag_s = at.lag_s * self.lag_factor(magnitude);
        s.load_pressure_pa + (target_pa - s.load_pressure_pa) * time_step_s / (lag_s + time_step_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    fn steady_pa(spool_position_m: f64, flow_m3_per_s: f64) -> f64 {
        let block = Block::new(&ParameterSet::reference().monitoring_model().fluid);
        let mut s = State::<f64>::start((), 0.0);
        for _ in 0..5_000 {
            s.load_pressure_pa = block.step(&s, spool_position_m, flow_m3_per_s, 1e-4);
        }
        s.load_pressure_pa
    }

    #[test]
    fn validate_section_5_3_the_settled_pressure_is_the_thesis_s_function() {
        let (psr, xss, gq, clk) = (20.0e6, 43.5e-6, 0.2062, 5.68e-14);
        for (xs, q) in [(20e-6, 0.0), (300e-6, 3e-5), (300e-6, -3e-5), (-100e-6, 1e-5)] {
            let u: f64 = xs / xss;
            let expected = psr * u.tanh() - q * f64::abs(q) / 4.5e-6 / (u * u * gq / (psr / xss) + clk);
            assert!((steady_pa(xs, q) - expected).abs() < 1e-6 * psr, "{xs} {q}: {}", steady_pa(xs, q));
        }
    }

    #[test]
    fn the_pressure_curve_is_odd_and_saturates_at_the_supply() {
        assert_eq!(steady_pa(50e-6, 1e-5), -steady_pa(-50e-6, -1e-5));
        assert!((steady_pa(1e-3, 0.0) - 20e6).abs() < 1.0);
    }
}
