//! The jack of the reference model: a mass under dry friction between end stops, and its measured position.
//!
//! Source: section 4.1.4, figure 4.18.
//! Signs: as in `blocks::jack`.
//! Range: end stops at ±XJM, where the velocity becomes zero.
//! Limits: as in `blocks::jack`; the load acts on the jack, the sensor sits beyond the backlash.

use serde::{Deserialize, Serialize};

use crate::models::blocks::friction::{Body, FrictionModel, Levels, slide};
use crate::models::blocks::{backlash, end_stop, jack, quantizer};
use crate::models::checks::Checks;

/// How the jack sticks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Coulomb's, Karnopp's or Borello's model; Borello's in the thesis.
    pub model: FrictionModel,
    /// Karnopp's dead band, m/s.
    pub velocity_dead_band_m_per_s: f64,
}

impl Friction {
    pub(crate) fn check(&self, checks: &mut Checks) {
        let band = self.velocity_dead_band_m_per_s;
        checks.within("reference.friction.velocity_dead_band_m_per_s", band, 0.0, 1.0, "m/s");
    }
}

/// Where the jack is and how fast it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position, m.
    #[doc(alias = "XJ")]
    pub position_m: f64,
    /// Velocity, m/s; exactly zero at rest.
    #[doc(alias = "DXJ")]
    pub velocity_m_per_s: f64,
    /// Position of the surface behind the backlash, m.
    pub surface_m: f64,
    /// That position as it is measured, m: what the controller and the recorder see.
    pub measured_m: f64,
}

impl State {
    /// At rest at a position, m, where it is measured too.
    #[must_use]
    pub fn at_rest(position_m: f64) -> Self {
        Self { position_m, velocity_m_per_s: 0.0, surface_m: position_m, measured_m: position_m }
    }
}

/// The jack with its friction.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    params: jack::Params,
    friction: Friction,
    levels: Levels<f64>,
}

impl Block {
    /// Prepares the block for a dynamic friction FDJ, N.
    #[must_use]
    pub fn new(params: &jack::Params, friction: &Friction, friction_dynamic_n: f64) -> Self {
        Self { params: *params, friction: *friction, levels: params.friction(friction_dynamic_n) }
    }

    /// The flow that the jack's motion takes, m³/s.
    #[inline(always)]
    #[must_use]
    pub fn flow_m3_per_s(&self, s: &State) -> f64 {
        self.params.area_m2 * s.velocity_m_per_s
    }

    /// One step under the load pressure.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, s: &State, load_pressure_pa: f64, external_load_n: f64, time_step_s: f64) -> State {
        let p = &self.params;
        let active_n = p.driving_force_n(load_pressure_pa, s.position_m)
            - external_load_n
            - p.damping_n_s_per_m * s.velocity_m_per_s;
        let body = Body { mass_kg: p.mass_kg, velocity_m_per_s: s.velocity_m_per_s, active_n, time_step_s };
        let velocity = slide(self.friction.model, &self.levels, self.friction.velocity_dead_band_m_per_s, &body);
        let (position_m, velocity_m_per_s) =
            end_stop::hold(p.position_max_m, s.position_m + velocity * time_step_s, velocity);
        let surface_m = backlash::step(p.backlash_m, s.surface_m, position_m);
        let measured_m = quantizer::quantize(p.position_quantum_m, surface_m);
        State { position_m, velocity_m_per_s, surface_m, measured_m }
    }
}
