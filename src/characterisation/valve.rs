//! The reference model's valve alone: passages and pipe capacities with the spool and the jack's flow imposed.
//!
//! Source: section 4.1.3, which obtains the characteristic curves from this part of the model.
//! Signs: docs/conventions.md.
//! Range: any spool position and flow; pressures from the vapour pressure to [`PRESSURE_MAX_PA`].
//! Limits: the steady state where a chamber cavitates is the pressure's: the vapour goes on growing.

use rayon::prelude::*;

use crate::models::parameters::ParameterSet;
use crate::models::reference::passages::{self, Flows};
use crate::models::reference::pipe;

/// The pressure beyond which no steady state is sought, Pa: a chamber without any way out has none.
pub const PRESSURE_MAX_PA: f64 = 1e10;
/// Halvings of a bracket: from 1e10 Pa to below a thousandth of a pascal.
const HALVINGS: usize = 60;
/// The part of the way left to the steady state that one step of the capacities' routine may take.
const WAY_PER_STEP: f64 = 2e-3;
/// How close a chamber counts as there, Pa.
const THERE_PA: f64 = 1.0;
/// The shortest and the longest step of the routine, s.
const STEP_RANGE_S: (f64, f64) = (1e-9, 0.1);
/// The step by which the routine's rates are measured, s; its change is in proportion to it.
const PROBE_S: f64 = 1e-6;
/// The most steps of the routine.
const STEPS_MAX: usize = 1_000_000;

/// Passages and pipe capacities at the set's supply.
#[derive(Debug, Clone)]
pub struct Valve {
    passages: passages::Block,
    pipe: pipe::Block,
    supply_pa: f64,
    return_pa: f64,
    vapour_pa: f64,
    leakage_m3_per_s_per_pa: f64,
}

/// The pressures of the two chambers, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressures {
    /// Chamber 1.
    pub port_1_pa: f64,
    /// Chamber 2.
    pub port_2_pa: f64,
}

impl Pressures {
    /// P12, Pa.
    #[must_use]
    pub fn load_pressure_pa(&self) -> f64 {
        self.port_1_pa - self.port_2_pa
    }
}

impl Valve {
    /// The valve of a set's reference model.
    #[must_use]
    pub fn new(set: &ParameterSet) -> Self {
        let fluid = set.reference_model().fluid_at_temperature();
        Self {
            passages: passages::Block::new(&fluid),
            pipe: pipe::Block::new(&fluid),
            supply_pa: fluid.supply_pressure_pa,
            return_pa: fluid.return_pressure_pa,
            vapour_pa: fluid.vapour_pressure_pa,
            leakage_m3_per_s_per_pa: fluid.leakage_m3_per_s_per_pa,
        }
    }

    /// PS + PR, Pa: what the chambers' pressures add up to while the valve is symmetrical.
    #[must_use]
    pub fn pressure_sum_pa(&self) -> f64 {
        self.supply_pa + self.return_pa
    }

    fn flows(&self, spool_position_m: f64, at: &Pressures) -> Flows {
        self.passages.step(spool_position_m, self.supply_pa, at.port_1_pa, at.port_2_pa)
    }

    /// The net flow into chamber 1 (Q1L), m³/s, through the passages alone, with P1 imposed and P2 = PS + PR - P1.
    #[must_use]
    pub fn flow_m3_per_s(&self, spool_position_m: f64, port_1_pa: f64) -> f64 {
        let at = Pressures { port_1_pa, port_2_pa: self.pressure_sum_pa() - port_1_pa };
        let flows = self.flows(spool_position_m, &at);
        flows.supply_to_1 - flows.from_1_to_return
    }

    /// The pressures in the long run with the spool and the jack's flow imposed.
    #[must_use]
    pub fn steady(&self, spool_position_m: f64, jack_flow_m3_per_s: f64) -> Pressures {
        // What the chambers absorb grows with the load pressure, which falls with what they absorb: one root.
        let at_absorbed = |absorbed: f64| Pressures {
            port_1_pa: self.chamber_pa(|pa| {
                let flows = self.flows(spool_position_m, &Pressures { port_1_pa: pa, port_2_pa: pa });
                flows.supply_to_1 - flows.from_1_to_return - absorbed
            }),
            port_2_pa: self.chamber_pa(|pa| {
                let flows = self.flows(spool_position_m, &Pressures { port_1_pa: pa, port_2_pa: pa });
                flows.supply_to_2 - flows.from_2_to_return + absorbed
            }),
        };
        let leak = |pressures: &Pressures| self.leakage_m3_per_s_per_pa * pressures.load_pressure_pa();
        let tight = at_absorbed(jack_flow_m3_per_s);
        let (mut low, mut high) = (jack_flow_m3_per_s, jack_flow_m3_per_s + leak(&tight));
        if high < low {
            (low, high) = (high, low);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let above = middle > jack_flow_m3_per_s + leak(&at_absorbed(middle));
            if above { high = middle } else { low = middle }
        }
        at_absorbed(0.5 * (low + high))
    }

    /// The load pressures in the long run without any flow to the jack, Pa.
    #[must_use]
    pub fn zero_flow_pa(&self, spool_positions_m: &[f64]) -> Vec<f64> {
        spool_positions_m.par_iter().map(|&x| self.steady(x, 0.0).load_pressure_pa()).collect()
    }

    /// The pressure at which a chamber's net inflow, which falls with it, is zero; the vapour pressure where the inflow
    /// is negative even there.
    fn chamber_pa(&self, inflow_m3_per_s: impl Fn(f64) -> f64) -> f64 {
        let (mut low, mut high) = (self.vapour_pa, PRESSURE_MAX_PA);
        if inflow_m3_per_s(low) <= 0.0 {
            return low;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if inflow_m3_per_s(middle) > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// The time after which the load pressure stays within a tolerance of its final value, s: the capacities' routine
    /// from both chambers halfway between supply and return. Each step takes a small part of the way that is left, so that
    /// slow and fast openings are followed alike. `None` where it never comes there.
    #[must_use]
    pub fn settling_s(&self, spool_position_m: f64, jack_flow_m3_per_s: f64, tolerance_pa: f64) -> Option<f64> {
        let end = self.steady(spool_position_m, jack_flow_m3_per_s);
        let mut s = pipe::State::at_rest(0.5 * self.pressure_sum_pa());
        let (mut time_s, mut settled_s) = (0.0, 0.0);
        for _ in 0..STEPS_MAX {
            let left_pa = [end.port_1_pa - s.port_1_pa, end.port_2_pa - s.port_2_pa].map(f64::abs);
            if (s.load_pressure_pa() - end.load_pressure_pa()).abs() > tolerance_pa {
                settled_s = time_s;
            }
            if left_pa[0].max(left_pa[1]) < THERE_PA {
                return Some(settled_s);
            }
            let at = Pressures { port_1_pa: s.port_1_pa, port_2_pa: s.port_2_pa };
            let flows = self.flows(spool_position_m, &at);
            let probe = self.pipe.step(&s, &flows, jack_flow_m3_per_s, PROBE_S);
            let rates = [probe.auxiliary_1_pa - s.auxiliary_1_pa, probe.auxiliary_2_pa - s.auxiliary_2_pa]
                .map(|change_pa| change_pa.abs() / PROBE_S);
            let step_s = left_pa
                .iter()
                .zip(rates)
                .filter(|(left_pa, _)| **left_pa >= THERE_PA)
                .map(|(left_pa, rate)| WAY_PER_STEP * left_pa / rate)
                .fold(STEP_RANGE_S.1, f64::min)
                .max(STEP_RANGE_S.0);
            s = self.pipe.step(&s, &flows, jack_flow_m3_per_s, step_s);
            time_s += step_s;
        }
        None
    }
}
