//! The pipe capacities: the compressed oil between valve and jack, with a memory of cavitation.
//!
//! Source: section 4.1.3, figure 4.14.
//! Signs: the jack's flow leaves capacity 1 and enters capacity 2.
//! Range: pressures at or above the vapour pressure; the auxiliary ones go below it while vapour is present.
//! Limits: both volumes constant and equal, one bulk modulus.

use super::passages::{Flows, Params};
use crate::numeric::lane::Lane;

/// The pressures, and the auxiliary ones that remember how much vapour has formed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Absolute pressure in chamber 1, Pa.
    #[doc(alias = "P1")]
    pub port_1_pa: f64,
    /// Absolute pressure in chamber 2, Pa.
    #[doc(alias = "P2")]
    pub port_2_pa: f64,
    /// Auxiliary pressure of chamber 1, Pa; negative while there is vapour.
    #[doc(alias = "P1T")]
    pub auxiliary_1_pa: f64,
    /// Auxiliary pressure of chamber 2, Pa; negative while there is vapour.
    #[doc(alias = "P2T")]
    pub auxiliary_2_pa: f64,
}

impl State {
    /// Both chambers at one pressure, Pa.
    #[must_use]
    pub fn at_rest(pressure_pa: f64) -> Self {
        Self {
            port_1_pa: pressure_pa,
            port_2_pa: pressure_pa,
            auxiliary_1_pa: pressure_pa,
            auxiliary_2_pa: pressure_pa,
        }
    }

    /// Load pressure P12, Pa.
    #[must_use]
    pub fn load_pressure_pa(&self) -> f64 {
        self.port_1_pa - self.port_2_pa
    }
}

/// The capacities with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    /// Bet/Vol, Pa/m³.
    stiffness_pa_per_m3: f64,
    leakage_m3_per_s_per_pa: f64,
    vapour_pa: f64,
}

impl Block {
    /// Prepares the block.
    #[must_use]
    pub fn new(p: &Params) -> Self {
        Self {
            stiffness_pa_per_m3: p.bulk_modulus_pa / p.chamber_volume_m3,
            leakage_m3_per_s_per_pa: p.leakage_m3_per_s_per_pa,
            vapour_pa: p.vapour_pressure_pa,
        }
    }

    /// One step under the valve's flows and the jack's.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, s: &State, flows: &Flows, jack_flow_m3_per_s: f64, time_step_s: f64) -> State {
        let absorbed = jack_flow_m3_per_s + self.leakage_m3_per_s_per_pa * s.load_pressure_pa();
        let pa_per_flow = self.stiffness_pa_per_m3 * time_step_s;
        let auxiliary_1_pa = s.auxiliary_1_pa + (flows.supply_to_1 - flows.from_1_to_return - absorbed) * pa_per_flow;
        let auxiliary_2_pa = s.auxiliary_2_pa + (absorbed - (flows.from_2_to_return - flows.supply_to_2)) * pa_per_flow;
        State {
            port_1_pa: Lane::max(auxiliary_1_pa, self.vapour_pa),
            port_2_pa: Lane::max(auxiliary_2_pa, self.vapour_pa),
            auxiliary_1_pa,
            auxiliary_2_pa,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    #[test]
    fn validate_section_4_1_3_vapour_must_vanish_before_the_pressure_rises_again() {
        let block = Block::new(&ParameterSet::reference().reference_model().fluid);
        let drain = Flows { from_1_to_return: 1e-4, ..Flows::default() };
        let fill = Flows { supply_to_1: 1e-4, ..Flows::default() };
        let mut s = State::at_rest(1e6);
        for _ in 0..300 {
            s = block.step(&s, &drain, 0.0, 1e-5);
        }
        assert_eq!(s.port_1_pa, 2000.0);
        let vapour_pa = 2000.0 - s.auxiliary_1_pa;
        let steps_to_vanish = (vapour_pa / (1e-4 * 8e12 * 1e-5)).floor() as usize;
        for _ in 0..steps_to_vanish {
            s = block.step(&s, &fill, 0.0, 1e-5);
            assert_eq!(s.port_1_pa, 2000.0, "the pressure stays at the vapour pressure while vapour remains");
        }
        s = block.step(&block.step(&s, &fill, 0.0, 1e-5), &fill, 0.0, 1e-5);
        assert!(s.port_1_pa > 2000.0);
    }
}
