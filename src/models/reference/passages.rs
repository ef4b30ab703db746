//! The four passages between the spool's edges and the sleeve: how much oil flows through each.
//!
//! Source: section 4.1.3, figures 4.10 to 4.13, with the corrections of docs/conventions.md.
//! Signs: each flow is positive from supply to chamber or from chamber to return.
//! Range: any pressures; a flow is zero where its pressure drop is, or is too small to be computed with (1e-200 Pa).
//! Limits: one temperature; the same geometry at all four edges.

use serde::{Deserialize, Serialize};

use super::oil::Properties;
use super::{second_stage, stability};
use crate::models::blocks::jack;
use crate::models::checks::Checks;
use crate::numeric::lane::{Four, Lane, Plain};

/// Oil, passages and pipe capacities.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Absolute supply pressure, Pa.
    #[doc(alias = "PS")]
    pub supply_pressure_pa: f64,
    /// Absolute return pressure, Pa.
    #[doc(alias = "PR")]
    pub return_pressure_pa: f64,
    /// Density, kg/m³.
    pub density_kg_per_m3: f64,
    /// Kinematic viscosity, m²/s.
    pub kinematic_viscosity_m2_per_s: f64,
    /// Circumferential opening, m.
    #[doc(alias = "w")]
    pub port_width_m: f64,
    /// Radial clearance, m.
    #[doc(alias = "HSV")]
    pub radial_clearance_m: f64,
    /// Wear factor on the clearance, dimensionless.
    #[doc(alias = "Khsv")]
    pub clearance_factor: f64,
    /// Clearance beyond the nominal one, m.
    pub clearance_extra_m: f64,
    /// Eccentricity of spool in sleeve over clearance, 0 to 1.
    pub eccentricity_ratio: f64,
    /// Overlap on the supply side, m; negative for an underlap.
    #[doc(alias = "OSSV")]
    pub overlap_supply_m: f64,
    /// Overlap on the return side, m; negative for an underlap.
    #[doc(alias = "ORSV")]
    pub overlap_return_m: f64,
    /// Discharge coefficient in turbulent flow, dimensionless.
    #[doc(alias = "Cd")]
    pub discharge_coefficient: f64,
    /// Reynolds number at which the discharge coefficient has fallen to 1/sqrt 2 of that, dimensionless.
    pub transition_reynolds: f64,
    /// Correction of the discharge coefficient when the passage is closed, dimensionless.
    pub discharge_geometry_correction: f64,
    /// Bulk modulus, Pa.
    #[doc(alias = "Bet")]
    pub bulk_modulus_pa: f64,
    /// Volume of one capacity, m³.
    #[doc(alias = "Vol")]
    pub chamber_volume_m3: f64,
    /// Leakage past the piston per pressure, m³/(s Pa).
    #[doc(alias = "Clk")]
    pub leakage_m3_per_s_per_pa: f64,
    /// Vapour pressure, Pa.
    #[doc(alias = "PVap")]
    pub vapour_pressure_pa: f64,
}

/// The least pressure drop that moves oil, Pa: below, the Reynolds number would underflow to zero, and the flow to 0/0.
const DROP_MIN_PA: f64 = 1e-200;

impl Params {
    pub(crate) fn check(&self, jack: &jack::Params, spool: &second_stage::Params, checks: &mut Checks) {
        let supply_min_pa = self.return_pressure_pa + 1e4;
        checks.within("reference.fluid.supply_pressure_pa", self.supply_pressure_pa, supply_min_pa, 1e9, "Pa");
        checks.within("reference.fluid.return_pressure_pa", self.return_pressure_pa, 0.0, 1e8, "Pa");
        checks.within("reference.fluid.density_kg_per_m3", self.density_kg_per_m3, 100.0, 5000.0, "kg/m3");
        let viscosity = self.kinematic_viscosity_m2_per_s;
        checks.within("reference.fluid.kinematic_viscosity_m2_per_s", viscosity, 1e-7, 1e-1, "m2/s");
        checks.within("reference.fluid.port_width_m", self.port_width_m, 1e-5, 1.0, "m");
        checks.within("reference.fluid.radial_clearance_m", self.radial_clearance_m, 1e-7, 1e-3, "m");
        checks.within("reference.fluid.clearance_factor", self.clearance_factor, 0.1, 100.0, "");
        checks.within("reference.fluid.clearance_extra_m", self.clearance_extra_m, 0.0, 1e-3, "m");
        checks.within("reference.fluid.eccentricity_ratio", self.eccentricity_ratio, 0.0, 1.0, "");
        checks.within("reference.fluid.overlap_supply_m", self.overlap_supply_m, -1e-3, 1e-3, "m");
        checks.within("reference.fluid.overlap_return_m", self.overlap_return_m, -1e-3, 1e-3, "m");
        checks.within("reference.fluid.discharge_coefficient", self.discharge_coefficient, 0.1, 1.0, "");
        checks.within("reference.fluid.transition_reynolds", self.transition_reynolds, 0.0, 1e5, "");
        let correction = self.discharge_geometry_correction;
        checks.within("reference.fluid.discharge_geometry_correction", correction, -0.9, 0.9, "");
        checks.within("reference.fluid.bulk_modulus_pa", self.bulk_modulus_pa, 1e7, 1e10, "Pa");
        let leakage = self.leakage_m3_per_s_per_pa;
        checks.within("reference.fluid.leakage_m3_per_s_per_pa", leakage, 0.0, 1e-8, "m3/(s Pa)");
        let vapour_max_pa = self.return_pressure_pa.max(1.0);
        checks.within("reference.fluid.vapour_pressure_pa", self.vapour_pressure_pa, 0.0, vapour_max_pa, "Pa");
        let volume_min_m3 = stability::chamber_volume_min_m3(self, jack, spool);
        let volume_m3 = self.chamber_volume_m3;
        checks.within_drawn("reference.fluid.chamber_volume_m3", volume_m3, (1e-6, 1.0), (volume_min_m3, 1.0), "m3");
    }
}

impl Params {
    /// The oil's properties where they do not depend on the temperature.
    pub(super) fn oil(&self) -> Properties {
        Properties {
            density_kg_per_m3: self.density_kg_per_m3,
            kinematic_viscosity_m2_per_s: self.kinematic_viscosity_m2_per_s,
        }
    }
}

/// The flows through the four passages, m³/s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flows {
    /// Supply to chamber 1 (Q1S).
    pub supply_to_1: f64,
    /// Chamber 1 to return (Q1R).
    pub from_1_to_return: f64,
    /// Supply to chamber 2 (Q2S).
    pub supply_to_2: f64,
    /// Chamber 2 to return (Q2R).
    pub from_2_to_return: f64,
}

/// The passages with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    return_pa: f64,
    supply_differential_pa: f64,
    overlap_supply_m: f64,
    overlap_return_m: f64,
    clearance_squared_m2: f64,
    /// 12 mu/(w c³ (1 + 1.5 (e/c)²)): laminar resistance per metre of covered length, Pa s/m⁴.
    laminar_per_length: f64,
    /// 2/rho, m³/kg.
    two_over_density: f64,
    /// 2/nu, s/m².
    two_over_viscosity: f64,
    transition_reynolds: f64,
    /// g c²: the geometric correction times the squared clearance, m².
    correction_m2: f64,
    /// rho/(2 Cd² w²), the quadratic resistance of a passage of unit gap, kg/m⁵.
    quadratic: f64,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        let clearance_m = p.radial_clearance_m * p.clearance_factor + p.clearance_extra_m;
        let dynamic_viscosity_pa_s = p.kinematic_viscosity_m2_per_s * p.density_kg_per_m3;
        let eccentric = 1.0 + 1.5 * p.eccentricity_ratio * p.eccentricity_ratio;
        let discharge_width = p.discharge_coefficient * p.port_width_m;
        Self {
            return_pa: p.return_pressure_pa,
            supply_differential_pa: p.supply_pressure_pa - p.return_pressure_pa,
            overlap_supply_m: p.overlap_supply_m,
            overlap_return_m: p.overlap_return_m,
            clearance_squared_m2: clearance_m * clearance_m,
            laminar_per_length: 12.0 * dynamic_viscosity_pa_s / (p.port_width_m * clearance_m.powi(3) * eccentric),
            two_over_density: 2.0 / p.density_kg_per_m3,
            two_over_viscosity: 2.0 / p.kinematic_viscosity_m2_per_s,
            transition_reynolds: p.transition_reynolds,
            correction_m2: p.discharge_geometry_correction * clearance_m * clearance_m,
            quadratic: p.density_kg_per_m3 / (2.0 * discharge_width * discharge_width),
        }
    }

    /// The absolute supply pressure, Pa, at a part of its nominal differential over the return.
    #[inline(always)]
    #[must_use]
    pub fn supply_pa(&self, factor: f64) -> f64 {
        self.return_pa + self.supply_differential_pa * factor
    }

    /// The flows with the spool and the pressures where they are.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, spool_position_m: f64, supply_pa: f64, port_1_pa: f64, port_2_pa: f64) -> Flows {
        self.step_in::<Plain>((), spool_position_m, supply_pa, port_1_pa, port_2_pa)
    }

    /// The same with the four passages in one lane: the same operations on each, the same bits.
    #[inline(always)]
    #[must_use]
    pub fn step_in<F: Four>(
        &self,
        token: F::Token,
        spool_position_m: f64,
        supply_pa: f64,
        port_1_pa: f64,
        port_2_pa: f64,
    ) -> Flows {
        let (xs, ossv, orsv) = (spool_position_m, self.overlap_supply_m, self.overlap_return_m);
        let (ps, pr, p1, p2) = (supply_pa, self.return_pa, port_1_pa, port_2_pa);
        let covered_m = F::of(token, [ossv - xs, orsv + xs, ossv + xs, orsv - xs]);
        let drop_pa = F::of(token, [ps - p1, p1 - pr, ps - p2, p2 - pr]);
        let [supply_to_1, from_1_to_return, supply_to_2, from_2_to_return] = self.flow(covered_m, drop_pa).numbers();
        Flows { supply_to_1, from_1_to_return, supply_to_2, from_2_to_return }
    }

    /// The flow through a passage, m³/s: the root of dp = RL Q + RQ Q|Q|, in the form that has no 0/0 where RL is
    /// zero. `covered_m` (X0) is the covered length, negative where the passage is open.
    #[inline(always)]
    fn flow<L: Lane>(&self, covered_m: L, drop_pa: L) -> L {
        let zero = drop_pa.same(0.0);
        let magnitude_pa = drop_pa.abs();
        let opening_m = (-covered_m).max(zero);
        let gap_squared_m2 = opening_m * opening_m + self.clearance_squared_m2;
        let laminar = covered_m.max(zero) * self.laminar_per_length;
        let speed_squared = magnitude_pa * self.two_over_density;
        let reynolds = (gap_squared_m2 * speed_squared).sqrt() * self.two_over_viscosity;
        let geometry = zero.same(self.correction_m2) / gap_squared_m2 + 1.0;
        // RQ |dp| with Cd² = Cd_inf² Re/(Re + Re_t) geometry².
        let quadratic_pa = (reynolds + self.transition_reynolds) * self.quadratic * magnitude_pa
            / (reynolds * geometry * geometry * gap_squared_m2);
        let flow = magnitude_pa * 2.0 / (laminar + (laminar * laminar + quadratic_pa * 4.0).sqrt());
        magnitude_pa.if_less(zero.same(DROP_MIN_PA), zero, drop_pa.sign_times(flow))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    fn params() -> Params {
        ParameterSet::reference().reference_model().fluid
    }

    #[test]
    fn the_flow_satisfies_the_thesis_s_pressure_balance() {
        // Section 4.1.3: dp = RL Q + RQ Q|Q|, evaluated independently of the solver's rearranged terms.
        let p = params();
        let block = Block::new(&p);
        for (covered_m, drop_pa) in [(7e-6, 1e7), (-2e-4, 1e7), (-2e-4, -3e5), (3e-4, 2e7), (0.0, 1e3)] {
            let q = block.flow(covered_m, drop_pa);
            let c = p.radial_clearance_m;
            let s2 = c * c + f64::min(covered_m, 0.0).powi(2);
            let mu = p.kinematic_viscosity_m2_per_s * p.density_kg_per_m3;
            let rl = 12.0 * mu * f64::max(covered_m, 0.0) / (p.port_width_m * c.powi(3));
            let re =
                2.0 * s2.sqrt() * (2.0 * drop_pa.abs() / p.density_kg_per_m3).sqrt() / p.kinematic_viscosity_m2_per_s;
            let cd = p.discharge_coefficient
                * (re / (re + p.transition_reynolds)).sqrt()
                * (1.0 + p.discharge_geometry_correction * c * c / s2);
            let rq = p.density_kg_per_m3 / (2.0 * cd * cd * p.port_width_m.powi(2) * s2);
            let balance = rl * q + rq * q * q.abs();
            assert!((balance - drop_pa).abs() < 1e-9 * drop_pa.abs(), "{covered_m} {drop_pa}: {balance}");
        }
    }

    #[test]
    fn the_flow_vanishes_with_its_drop_and_is_a_number_at_every_drop() {
        for transition_reynolds in [0.0, 260.0] {
            let block = Block::new(&Params { transition_reynolds, ..params() });
            for covered_m in [-1e-4, 0.0, 1e-4] {
                let flows: Vec<f64> = (0..=330).map(|tens| block.flow(covered_m, 10f64.powi(9 - tens))).collect();
                assert!(flows.windows(2).all(|two| two[1] <= two[0]), "{covered_m}: {flows:?}");
                assert_eq!(flows[330], 0.0);
            }
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn parity_the_four_passages_in_a_register_give_the_bits_of_plain_numbers() {
        use crate::numeric::lane::Register;
        use pulp::x86::V3;

        let Some(simd) = V3::try_new() else { return };
        let block = Block::new(&params());
        let mut places = [-1.2e-3, -7.3e-6, 0.0, 7.3e-6, 1e-5, 6e-4].iter().cycle();
        for (i, spool_m) in (0..600_u32).zip(&mut places) {
            let (p1, p2) = (2e3 + 7919.0 * f64::from(i * i % 2749), 2e3 + 104_729.0 * f64::from(i % 199));
            let plain = block.step(*spool_m, 20.6e6, p1, p2);
            assert_eq!(block.step_in::<Register<V3>>(simd, *spool_m, 20.6e6, p1, p2), plain, "{spool_m} {p1} {p2}");
        }
        let nothing = block.step_in::<Register<V3>>(simd, 1e-4, 0.6e6, 0.6e6, 0.6e6);
        assert_eq!(nothing, Flows::default(), "no drop, no flow");
    }

    #[test]
    fn a_centred_spool_between_equal_pressures_feeds_no_one() {
        let flows = Block::new(&params()).step(0.0, 20.6e6, 10.6e6, 10.6e6);
        assert_eq!(flows.supply_to_1, flows.supply_to_2);
        assert_eq!(flows.from_1_to_return, flows.from_2_to_return);
        assert!((flows.supply_to_1 - flows.from_1_to_return).abs() < 1e-12 * flows.supply_to_1);
    }

    #[test]
    fn validate_section_7_2_more_clearance_leaks_more() {
        let mut worn = params();
        worn.clearance_extra_m = 30e-6;
        let nominal = Block::new(&params()).step(0.0, 20.6e6, 10.6e6, 10.6e6).supply_to_1;
        assert!(Block::new(&worn).step(0.0, 20.6e6, 10.6e6, 10.6e6).supply_to_1 > 4.0 * nominal);
    }
}
