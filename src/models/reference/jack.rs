//! The jack of the reference model: a mass under Borello's friction between end stops.
//!
//! Source: section 4.1.4, figure 4.18.
//! Signs: as in `blocks::jack`.
//! Range: end stops at ±XJM, where the velocity becomes zero.
//! Limits: as in `blocks::jack`.

use crate::models::blocks::friction::{Levels, arrest, borello};
use crate::models::blocks::{end_stop, jack};

/// Where the jack is and how fast it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position, m.
    #[doc(alias = "XJ")]
    pub position_m: f64,
    /// Velocity, m/s; exactly zero at rest.
    #[doc(alias = "DXJ")]
    pub velocity_m_per_s: f64,
}

/// The jack with its friction.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    params: jack::Params,
    friction: Levels<f64>,
}

impl Block {
    /// Prepares the block for a dynamic friction FDJ, N.
    #[must_use]
    pub fn new(params: &jack::Params, friction_dynamic_n: f64) -> Self {
        Self { params: *params, friction: params.friction(friction_dynamic_n) }
    }

    /// The flow that the jack's motion takes, m³/s.
    #[inline]
    #[must_use]
    pub fn flow_m3_per_s(&self, s: &State) -> f64 {
        self.params.area_m2 * s.velocity_m_per_s
    }

    /// One step under the load pressure.
    #[inline]
    #[must_use]
    pub fn step(&self, s: &State, load_pressure_pa: f64, external_load_n: f64, time_step_s: f64) -> State {
        let p = &self.params;
        let active_n = p.driving_force_n(load_pressure_pa, s.position_m)
            - external_load_n
            - p.damping_n_s_per_m * s.velocity_m_per_s;
        let friction_n = borello(&self.friction, s.velocity_m_per_s, active_n);
        let moved = s.velocity_m_per_s + (active_n - friction_n) / p.mass_kg * time_step_s;
        let velocity = arrest(s.velocity_m_per_s, moved);
        let (position_m, velocity_m_per_s) =
            end_stop::step(p.position_max_m, s.position_m + velocity * time_step_s, velocity);
        State { position_m, velocity_m_per_s }
    }
}
