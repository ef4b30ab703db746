//! The second stage: a spool without mass, moved by the flapper's pressure against damping and dry friction.
//!
//! Source: section 4.1.2, figure 4.9, with Borello's friction and the filter's coefficient Kintas on both gains.
//! Signs: a flow into the jack pulls the spool back (flow force).
//! Range: end stops at ±XSM; Kintas from 0 (clean) to 1 (closed), where a spool without damping stands.
//! Limits: first order: the spool's inertia is neglected, as in the thesis.

use serde::{Deserialize, Serialize};

use crate::models::blocks::end_stop;
use crate::models::blocks::friction::{Levels, arrest};
use crate::models::checks::Checks;
use crate::numeric::lane::Lane;

/// The spool's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// End area, m².
    #[doc(alias = "ASV")]
    pub end_area_m2: f64,
    /// Pressure gain of the nozzles at the nominal supply, Pa/m.
    #[doc(alias = "GPF")]
    pub pressure_gain_pa_per_m: f64,
    /// Flow gain of the nozzles at the nominal supply, m²/s.
    #[doc(alias = "GQF")]
    pub flow_gain_m2_per_s: f64,
    /// Viscous damping, N s/m.
    #[doc(alias = "CS")]
    pub damping_n_s_per_m: f64,
    /// Flow force per flow, N s/m³.
    #[doc(alias = "Kflow")]
    pub flow_force_n_s_per_m3: f64,
    /// Displacement of the flapper at which the nozzles balance, with the opposite sign, m.
    pub hydraulic_offset_m: f64,
    /// Static friction, N.
    pub friction_static_n: f64,
    /// Dynamic friction, N.
    pub friction_dynamic_n: f64,
    /// End stop, m.
    #[doc(alias = "XSM")]
    pub spool_position_max_m: f64,
    /// Filter clogging, 0 (clean) to 1 (closed).
    #[doc(alias = "Kintas")]
    pub filter_clogging: f64,
    /// Supply minus return at which the gains hold, Pa.
    #[doc(alias = "PSR0")]
    pub nominal_pressure_differential_pa: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("reference.second_stage.end_area_m2", self.end_area_m2, 1e-8, 1e-2, "m2");
        checks.within("reference.second_stage.pressure_gain_pa_per_m", self.pressure_gain_pa_per_m, 1e6, 1e15, "Pa/m");
        checks.within("reference.second_stage.flow_gain_m2_per_s", self.flow_gain_m2_per_s, 1e-6, 1e3, "m2/s");
        checks.within("reference.second_stage.damping_n_s_per_m", self.damping_n_s_per_m, 0.0, 1e5, "N s/m");
        let flow_force = self.flow_force_n_s_per_m3;
        checks.within("reference.second_stage.flow_force_n_s_per_m3", flow_force, 0.0, 1e9, "N s/m3");
        checks.within("reference.second_stage.hydraulic_offset_m", self.hydraulic_offset_m, -1e-3, 1e-3, "m");
        checks.within("reference.second_stage.friction_static_n", self.friction_static_n, 0.0, 1e3, "N");
        let dynamic_max_n = self.friction_static_n;
        checks.within("reference.second_stage.friction_dynamic_n", self.friction_dynamic_n, 0.0, dynamic_max_n, "N");
        checks.within("reference.second_stage.spool_position_max_m", self.spool_position_max_m, 1e-6, 0.1, "m");
        checks.within("reference.second_stage.filter_clogging", self.filter_clogging, 0.0, 1.0, "");
        let nominal_pa = self.nominal_pressure_differential_pa;
        checks.within("reference.second_stage.nominal_pressure_differential_pa", nominal_pa, 1e5, 1e9, "Pa");
    }
}

/// Where the spool is and how fast it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position, m.
    #[doc(alias = "XS")]
    pub position_m: f64,
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
}

/// What the nozzles and the supply make of the spool.
#[derive(Debug, Clone, Copy)]
struct Gains {
    /// Active force per metre of flapper, N/m: ASV GPF.
    force_n_per_m: f64,
    /// CS + ASV² GPF/GQF, N s/m.
    resistance_n_s_per_m: f64,
}

impl Gains {
    /// The gains at a supply differential over the nominal one, PSR/PSR0.
    fn at(p: &Params, supply_ratio: f64) -> Self {
        let open = (1.0 - p.filter_clogging) * supply_ratio;
        // GPF/GQF in this form stays finite when the filter is closed.
        let ratio_pa_s_per_m3 = p.pressure_gain_pa_per_m / p.flow_gain_m2_per_s * open.sqrt();
        Self {
            force_n_per_m: p.end_area_m2 * (p.pressure_gain_pa_per_m * open),
            resistance_n_s_per_m: p.damping_n_s_per_m + p.end_area_m2 * p.end_area_m2 * ratio_pa_s_per_m3,
        }
    }
}

/// The spool with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    params: Params,
    supply_ratio: f64,
    nominal: Gains,
    friction: Levels<f64>,
}

impl Block {
    /// Prepares the block for a supply differential.
    #[must_use]
    pub fn new(p: &Params, supply_differential_pa: f64) -> Self {
        let supply_ratio = supply_differential_pa / p.nominal_pressure_differential_pa;
        Self {
            params: *p,
            supply_ratio,
            nominal: Gains::at(p, supply_ratio),
            friction: Levels { static_n: p.friction_static_n, dynamic_n: p.friction_dynamic_n },
        }
    }

    /// One step with the flapper where it is, the jack's flow of the step before, and the supply differential as a part
    /// of the one that the block was prepared for.
    #[inline(always)]
    #[must_use]
    pub fn step(
        &self,
        s: &State,
        flapper_position_m: f64,
        jack_flow_m3_per_s: f64,
        supply_factor: f64,
        time_step_s: f64,
    ) -> State {
        let p = &self.params;
        let gains =
            if supply_factor == 1.0 { self.nominal } else { Gains::at(p, self.supply_ratio * supply_factor.max(0.0)) };
        let flapper_m = flapper_position_m + p.hydraulic_offset_m;
        let active_n = gains.force_n_per_m * flapper_m - p.flow_force_n_s_per_m3 * jack_flow_m3_per_s;
        let velocity = self.velocity(s.velocity_m_per_s, active_n, gains.resistance_n_s_per_m);
        let (position_m, velocity_m_per_s) =
            end_stop::hold(p.spool_position_max_m, s.position_m + velocity * time_step_s, velocity);
        State { position_m, velocity_m_per_s }
    }

    /// Borello's friction on a body without mass: the velocity follows the force at once.
    fn velocity(&self, previous: f64, active_n: f64, resistance_n_s_per_m: f64) -> f64 {
        if resistance_n_s_per_m == 0.0 {
            // No damping and a closed filter: 0/0. The oil that is shut in holds the spool.
            0.0
        } else if previous != 0.0 {
            let net_n = active_n - previous.sign_times(self.friction.dynamic_n);
            arrest(previous, net_n / resistance_n_s_per_m)
        } else if active_n.abs() <= self.friction.static_n {
            0.0
        } else {
            (active_n - active_n.sign_times(self.friction.dynamic_n)) / resistance_n_s_per_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    fn block(clogging: f64) -> Block {
        let mut params = ParameterSet::reference().reference_model().second_stage;
        params.filter_clogging = clogging;
        Block::new(&params, params.nominal_pressure_differential_pa)
    }

    fn settled_velocity(block: &Block, flapper_position_m: f64) -> f64 {
        let mut s = State::default();
        for _ in 0..10 {
            s = block.step(&s, flapper_position_m, 0.0, 1.0, 1e-6);
        }
        s.velocity_m_per_s
    }

    #[test]
    fn the_spool_sticks_below_its_static_friction_and_slides_beyond_it() {
        let block = block(0.0);
        assert_eq!(settled_velocity(&block, 0.2e-7 / 0.8), 0.0);
        let sliding = settled_velocity(&block, 10e-6);
        assert!((sliding - (8e6 * 10e-6 - 0.1) / 8001.0).abs() < 1e-12, "{sliding}");
    }

    #[test]
    fn validate_section_4_1_2_a_clogged_filter_slows_the_spool() {
        let speeds: Vec<f64> = [0.0, 0.3, 0.6].map(|c| settled_velocity(&block(c), 10e-6)).into();
        assert!(speeds[0] > speeds[1] && speeds[1] > speeds[2] && speeds[2] > 0.0, "{speeds:?}");
        assert_eq!(settled_velocity(&block(1.0), 30e-6), 0.0, "a closed filter moves nothing");
        let mut params = ParameterSet::reference().reference_model().second_stage;
        (params.filter_clogging, params.damping_n_s_per_m) = (1.0, 0.0);
        let undamped = Block::new(&params, params.nominal_pressure_differential_pa);
        assert_eq!(undamped.step(&State::default(), 30e-6, 1e-4, 1.0, 1e-5), State::default());
    }
}
