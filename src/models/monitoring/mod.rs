//! The monitoring (low-fidelity) model of section 4.2 with one of chapter 5's fluids, cheap enough to sit in an optimiser:
//! one candidate as plain numbers, or many in lock-step.
//!
//! Source: section 4.2; the update order of the semi-implicit step reproduces the thesis's features.
//! Signs: docs/conventions.md.
//! Range: the semi-implicit step up to 2e-5 s for any fault; [`large_step`] up to 5e-4 s.
//! Limits: Karnopp friction, no hysteresis, no leakage but the jack's; the spool's speed does not vary with the supply.

pub mod bias;
pub mod first_stage;
pub mod fluid;
pub mod large_step;
pub mod wear;

use serde::{Deserialize, Serialize};

use super::blocks::friction::{Levels, karnopp};
use super::blocks::{Input, Shared, controller, end_stop, jack, torque_motor};
use super::checks::Checks;
use crate::numeric::lane::Lane;
pub use bias::Bias;
use fluid::FluidModel;
use wear::Wear;

/// What the monitoring model has of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// The flapper.
    pub first_stage: first_stage::Params,
    /// The spool.
    pub second_stage: SecondStage,
    /// The fluid.
    pub fluid: fluid::Params,
    /// The jack's friction.
    pub friction: Friction,
    /// How the sleeve's wear acts.
    pub wear: wear::Params,
    /// How far the reference model's features are from this model's.
    pub bias: Bias,
}

/// The spool: an integrator of the flapper's position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecondStage {
    /// Spool speed per flapper position, 1/s.
    pub spool_speed_gain_per_s: f64,
    /// End stop, m.
    #[doc(alias = "XSM")]
    pub spool_position_max_m: f64,
}

/// Karnopp's friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// The velocity below which the jack counts as stuck, m/s.
    pub velocity_dead_band_m_per_s: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        self.first_stage.check(checks);
        let gain = self.second_stage.spool_speed_gain_per_s;
        checks.within("monitoring.second_stage.spool_speed_gain_per_s", gain, 1.0, 1e6, "1/s");
        let stop_m = self.second_stage.spool_position_max_m;
        checks.within("monitoring.second_stage.spool_position_max_m", stop_m, 1e-6, 0.1, "m");
        self.fluid.check(checks);
        self.wear.check(checks);
        let band = self.friction.velocity_dead_band_m_per_s;
        checks.within("monitoring.friction.velocity_dead_band_m_per_s", band, 1e-9, 1e-2, "m/s");
        self.bias.check(checks);
    }
}

/// The faults of one candidate, or of several.
#[derive(Debug, Clone, Copy)]
pub struct Candidate<L, W = ()> {
    demagnetisation: L,
    friction: Levels<L>,
    wear: W,
}

/// Everything that survives a step.
#[derive(Debug, Clone, Copy)]
pub struct State<L> {
    /// Current in the torque motor, A.
    pub servovalve_current_a: L,
    /// Flapper position, m.
    pub flapper_position_m: L,
    /// Flapper velocity, m/s.
    pub flapper_velocity_m_per_s: L,
    /// Spool position, m.
    pub spool_position_m: L,
    /// Load pressure, Pa.
    pub load_pressure_pa: L,
    /// Jack position, m.
    pub jack_position_m: L,
    /// Jack velocity, m/s.
    pub jack_velocity_m_per_s: L,
}

impl<L: Lane> State<L> {
    /// Everything at rest at zero, but the jack, which rests at a position, m.
    #[inline(always)]
    pub fn start(token: L::Token, jack_position_m: f64) -> Self {
        let zero = L::splat(token, 0.0);
        Self {
            servovalve_current_a: zero,
            flapper_position_m: zero,
            flapper_velocity_m_per_s: zero,
            spool_position_m: zero,
            load_pressure_pa: zero,
            jack_position_m: L::splat(token, jack_position_m),
            jack_velocity_m_per_s: zero,
        }
    }
}

/// A monitoring model, ready to run any candidate.
#[derive(Debug, Clone)]
pub struct Model {
    controller: controller::Params,
    torque_motor: torque_motor::Params,
    first_stage: first_stage::Params,
    second_stage: SecondStage,
    fluid: fluid::Block,
    dead_band_m_per_s: f64,
    jack: jack::Params,
}

impl Model {
    /// The model with the developed fluid, ready for any candidate.
    #[must_use]
    pub fn new(shared: &Shared, own: &Params) -> Self {
        Self::with_fluid(shared, own, FluidModel::Developed)
    }

    /// The model with a fluid, ready for any candidate.
    #[must_use]
    pub fn with_fluid(shared: &Shared, own: &Params, fluid: FluidModel) -> Self {
        Self {
            controller: shared.controller,
            torque_motor: shared.torque_motor,
            first_stage: own.first_stage,
            second_stage: own.second_stage,
            fluid: fluid::Block::new(&own.fluid, fluid),
            dead_band_m_per_s: own.friction.velocity_dead_band_m_per_s,
            jack: shared.jack,
        }
    }

    /// A candidate, or several: demagnetisation KGM and dynamic jack friction FDJ, N.
    #[inline(always)]
    pub fn candidate<L: Lane>(&self, kgm: L, fdj_n: L) -> Candidate<L> {
        self.worn_candidate(kgm, fdj_n, ())
    }

    /// A candidate, or several, with other faults beside these two.
    #[inline(always)]
    pub fn worn_candidate<L: Lane, W: Wear<L>>(&self, kgm: L, fdj_n: L, wear: W) -> Candidate<L, W> {
        Candidate { demagnetisation: kgm, friction: self.jack.friction(fdj_n), wear }
    }

    /// One semi-implicit time step, in signal order.
    #[inline(always)]
    pub fn step<L: Lane, W: Wear<L>>(
        &self,
        c: &Candidate<L, W>,
        s: &State<L>,
        input: &Input,
        time_step_s: f64,
    ) -> State<L> {
        let (current_a, force_n) = self.drive_motor(c, s, input.position_command_m);
        let (flapper_m, flapper_m_per_s) = first_stage::step(&self.first_stage, s, force_n, time_step_s);
        let spool_m = s.spool_position_m + flapper_m * self.second_stage.spool_speed_gain_per_s * time_step_s;
        let spool_m = c.wear.slowed(s.spool_position_m, spool_m);
        let spool_m = spool_m.clip(spool_m.same(self.second_stage.spool_position_max_m));
        let flow = s.jack_velocity_m_per_s * self.jack.area_m2;
        let metered_m = c.wear.metered(spool_m);
        let load_pa = self.fluid.step(s, metered_m, flow, input.supply_factor, time_step_s);
        let (jack_m, jack_m_per_s) = self.move_jack(c, s, load_pa, input.external_load_n, time_step_s);
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

    /// The current in the torque motor, A, and its force on the flapper, N.
    #[inline(always)]
    fn drive_motor<L: Lane, W: Wear<L>>(&self, c: &Candidate<L, W>, s: &State<L>, position_command_m: f64) -> (L, L) {
        let asked_a = controller::proportional(&self.controller, position_command_m, s.jack_position_m);
        let current_a = torque_motor::current(&self.torque_motor, c.wear.offset(asked_a), 0.0);
        let force_n = torque_motor::force(&self.torque_motor, current_a, c.demagnetisation);
        match c.wear.slack(s.spool_position_m) {
            None => (current_a, force_n),
            // What the feedback spring does not feel of the spool is missing in its force.
            Some(slack_m) => (current_a, force_n + slack_m * self.first_stage.feedback_spring_stiffness_n_per_m),
        }
    }

    /// The jack's position and velocity after a step under Karnopp's friction.
    #[inline(always)]
    fn move_jack<L: Lane, W: Wear<L>>(
        &self,
        c: &Candidate<L, W>,
        s: &State<L>,
        load_pa: L,
        external_load_n: f64,
        time_step_s: f64,
    ) -> (L, L) {
        let velocity = s.jack_velocity_m_per_s;
        let active_n = self.jack.driving_force_n(load_pa, s.jack_position_m)
            - external_load_n
            - velocity * self.jack.damping_n_s_per_m;
        let friction_n = karnopp(&c.friction, velocity, active_n, self.dead_band_m_per_s);
        let moved = velocity + (active_n - friction_n) / self.jack.mass_kg * time_step_s;
        let moved = self.hold(c, velocity, active_n, moved);
        let position = s.jack_position_m + moved * time_step_s;
        end_stop::step(self.jack.position_max_m, position, moved)
    }

    /// Zero where the jack is stuck (inside the dead band, the active force within the static friction), elsewhere
    /// the velocity given.
    #[inline(always)]
    fn hold<L: Lane, W: Wear<L>>(&self, c: &Candidate<L, W>, velocity: L, active_n: L, moved: L) -> L {
        let free = c.friction.static_n.if_less(active_n.abs(), moved, moved.same(0.0));
        velocity.same(self.dead_band_m_per_s).if_less(velocity.abs(), moved, free)
    }
}
