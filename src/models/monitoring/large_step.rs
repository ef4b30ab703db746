//! The monitoring model at time steps fifty times as long: what an optimiser runs.
//!
//! Source: the equations of the semi-implicit step; flapper and spool by the exact matrix exponential of their linear
//! motion, pressure and jack velocity together, linearly implicit in the flow.
//! Signs: as in the semi-implicit step.
//! Range: time steps up to 5e-4 s; the features stay within 1e-4 of those at 1e-5 s when the step is halved right after a jump of the
//! command, as `estimation::evaluate` does (tests/it/models/lanes.rs).
//! Limits: the developed fluid; first order in time; a body that changes its direction rests for one step.

use nalgebra::Matrix4;

use super::fluid::{Block, developed};
use super::wear::Wear;
use super::{Candidate, Model, State};
use crate::models::blocks::{Input, end_stop};
use crate::numeric::lane::Lane;

/// The longest time step, s.
pub const TIME_STEP_MAX_S: f64 = 5e-4;

/// A model with a fixed time step and what that makes of its linear part.
#[derive(Debug, Clone)]
pub struct LargeStep {
    model: Model,
    /// The model's fluid, known to be the developed one.
    fluid: developed::Block,
    time_step_s: f64,
    /// Flapper position, flapper velocity and spool position after a step, by each of them before it and by the force.
    transition: [[f64; 4]; 3],
}

impl LargeStep {
    /// Prepares a model for a time step, s, of at most [`TIME_STEP_MAX_S`].
    ///
    /// # Panics
    /// When the model's fluid is not the developed one: only its lag lets pressure and flow be solved together.
    #[must_use]
    pub fn new(model: &Model, time_step_s: f64) -> Self {
        let Block::Developed(fluid) = model.fluid else {
            panic!("the large step is for the developed fluid, found {:?}", model.fluid);
        };
        let p = &model.first_stage;
        let (frequency, stiffness) = (p.natural_frequency_rad_per_s, p.stiffness_n_per_m());
        let squared = frequency * frequency;
        let spring = p.feedback_spring_stiffness_n_per_m;
        #[rustfmt::skip]
        let rates = Matrix4::new(
            0.0, 1.0, 0.0, 0.0,
            -squared, -2.0 * p.damping_ratio * frequency, -squared * spring / stiffness, squared / stiffness,
            model.second_stage.spool_speed_gain_per_s, 0.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 0.0,
        );
        let exact = (rates * time_step_s).exp();
        let transition = [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| exact[(row, column)]));
        Self { model: model.clone(), fluid, time_step_s, transition }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Flapper position, flapper velocity and spool position after a step, by each of them before it and by the force.
    #[must_use]
    pub fn transition(&self) -> &[[f64; 4]; 3] {
        &self.transition
    }

    /// One time step, in signal order.
    #[inline(always)]
    pub fn step<L: Lane>(&self, c: &Candidate<L>, s: &State<L>, position_command_m: f64) -> State<L> {
        self.step_worn(c, s, &Input::command(position_command_m))
    }

    /// One time step of a candidate with wear, under any input.
    #[inline(always)]
    pub fn step_worn<L: Lane, W: Wear<L>>(&self, c: &Candidate<L, W>, s: &State<L>, input: &Input) -> State<L> {
        let (current_a, force_n) = self.model.drive_motor(c, s, input.position_command_m);
        let (flapper_m, flapper_m_per_s, spool_m) = self.move_valve(c, s, force_n);
        let (load_pa, jack_m_per_s) = self.press_and_move(c, s, spool_m, input);
        let jack_m = s.jack_position_m + jack_m_per_s * self.time_step_s;
        let (jack_m, jack_m_per_s) = end_stop::step(self.model.jack.position_max_m, jack_m, jack_m_per_s);
        State {
            servovalve_current_a: current_a,
            flapper_position_m: flapper_m,
            flapper_velocity_m_per_s: flapper_m_per_s,
            spool_position_m: spool_m,
            load_pressure_pa: load_pa,
            jack_position_m: jack_m,
            jack_velocity_m_per_s: jack_m_per_s,
        }
    }

    /// Flapper position and velocity and spool position: exact while the flapper is free; against its end stop it
    /// stands, and the spool moves at a constant speed.
    #[inline(always)]
    fn move_valve<L: Lane, W: Wear<L>>(&self, c: &Candidate<L, W>, s: &State<L>, force_n: L) -> (L, L, L) {
        let free_m = self.linear(0, s, force_n);
        let stop_m = self.model.first_stage.flapper_position_max_m;
        let (flapper_m, flapper_m_per_s) = end_stop::step(stop_m, free_m, self.linear(1, s, force_n));
        let gain_per_step = self.model.second_stage.spool_speed_gain_per_s * self.time_step_s;
        let against_stop_m = s.spool_position_m + flapper_m * gain_per_step;
        let spool_m = free_m.same(stop_m).if_less(free_m.abs(), against_stop_m, self.linear(2, s, force_n));
        let spool_m = c.wear.slowed(s.spool_position_m, spool_m);
        let spool_max_m = spool_m.same(self.model.second_stage.spool_position_max_m);
        (flapper_m, flapper_m_per_s, spool_m.clip(spool_max_m))
    }

    /// One row of the linear motion. (A function and not a closure: a closure in lane code is compiled without the
    /// vector instructions and may stay a call.)
    #[inline(always)]
    fn linear<L: Lane>(&self, row: usize, s: &State<L>, force_n: L) -> L {
        let [flapper, velocity, spool, force] = self.transition[row];
        s.flapper_position_m * flapper
            + s.flapper_velocity_m_per_s * velocity
            + s.spool_position_m * spool
            + force_n * force
    }

    /// Load pressure and jack velocity, solved together: the pressure falls with the flow while the flow grows with
    /// the pressure, and at this step neither may lag behind the other.
    #[inline(always)]
    fn press_and_move<L: Lane, W: Wear<L>>(
        &self,
        c: &Candidate<L, W>,
        s: &State<L>,
        spool_m: L,
        input: &Input,
    ) -> (L, L) {
        let (jack, h) = (&self.model.jack, self.time_step_s);
        let at = self.fluid.at_spool(c.wear.metered(spool_m), input.supply_factor);
        let flow = s.jack_velocity_m_per_s * jack.area_m2;
        let magnitude = flow.abs();
        let weight = at.lag_s.same(h) / (at.lag_s * self.fluid.lag_factor(magnitude) + h);
        let kept_pa = s.load_pressure_pa + (at.commanded_pa - s.load_pressure_pa) * weight;
        // q|q| about the flow q0 of before: q0|q0| + 2|q0|(q - q0) = 2|q0| q - q0|q0|.
        let slope = weight * at.loss * magnitude;
        let free_pa = kept_pa + slope * flow;
        let per_velocity_pa = slope * (2.0 * jack.area_m2);
        // Force at rest, force in motion, and the resistance that grows with the new velocity.
        let resting_n = jack.driving_force_n(kept_pa, s.jack_position_m) - input.external_load_n;
        let driving_n = jack.driving_force_n(free_pa, s.jack_position_m) - input.external_load_n;
        let inertia = (per_velocity_pa * jack.area_m2 + jack.damping_n_s_per_m) * h + jack.mass_kg;
        let velocity = s.jack_velocity_m_per_s;
        let band = velocity.same(self.model.dead_band_m_per_s);
        let friction_n = band.if_less(
            velocity.abs(),
            velocity.sign_times(c.friction.dynamic_n),
            resting_n.clip(c.friction.static_n),
        );
        let moved = (velocity * jack.mass_kg + (driving_n - friction_n) * h) / inertia;
        let moved = self.model.hold(c, velocity, resting_n, moved);
        // A moving jack that would turn back rests first, as in Borello's model.
        let turned = (moved * velocity).if_less(moved.same(0.0), moved.same(0.0), moved);
        let moved = band.if_less(velocity.abs(), turned, moved);
        let pressure_pa =
            moved.abs().if_less(moved.same(f64::MIN_POSITIVE), kept_pa, free_pa - per_velocity_pa * moved);
        (pressure_pa, moved)
    }
}
