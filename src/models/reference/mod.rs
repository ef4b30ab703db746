//! The reference (high-fidelity) model of the thesis's chapter 4: one scenario at a time, in plain numbers.
//!
//! Source: chapter 4, stepped semi-implicitly in the order of the block diagram (figure 4.1).
//! Signs: docs/conventions.md.
//! Range: time steps up to 2e-5 s; beyond, the stick-slip at high friction changes its mean.
//! Limits: one oil temperature in a run; rigid structure.

pub mod first_stage;
pub mod jack;
pub mod oil;
pub mod passages;
pub mod pipe;
pub mod second_stage;
mod stability;
pub mod torque_motor;

use serde::{Deserialize, Serialize};

use super::blocks::{self, Input, Shared, controller};
use super::checks::Checks;
use super::fault::Faults;
use crate::numeric::lane::{Four, Plain};

/// What the reference model has of its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Time step, s.
    #[doc(alias = "DT")]
    pub time_step_s: f64,
    /// What disturbs the current, and how it becomes a force.
    pub torque_motor: torque_motor::Params,
    /// The flapper.
    pub first_stage: first_stage::Params,
    /// The spool.
    pub second_stage: second_stage::Params,
    /// Passages, pipes, and the oil's properties where they are constant.
    pub fluid: passages::Params,
    /// The oil and its temperature.
    pub oil: oil::Params,
    /// How the jack sticks.
    pub friction: jack::Friction,
}

impl Params {
    pub(crate) fn check(
        &self,
        shared: &blocks::torque_motor::Params,
        jack: &blocks::jack::Params,
        checks: &mut Checks,
    ) {
        self.first_stage.check(checks);
        self.torque_motor.check(shared, &self.first_stage, checks);
        self.second_stage.check(checks);
        self.oil.check(checks);
        self.fluid.check(jack, &self.second_stage, checks);
        self.friction.check(checks);
        stability::check(self, shared, jack, checks);
    }
}

impl Params {
    /// The fluid with the oil's properties at its temperature.
    #[must_use]
    pub fn fluid_at_temperature(&self) -> passages::Params {
        let oil::Properties { density_kg_per_m3, kinematic_viscosity_m2_per_s } = self.oil.properties(self.fluid.oil());
        passages::Params { density_kg_per_m3, kinematic_viscosity_m2_per_s, ..self.fluid }
    }
}

/// A reference model with its faults built in, ready to run.
#[derive(Debug, Clone)]
pub struct Model {
    time_step_s: f64,
    controller: controller::Params,
    torque_motor: torque_motor::Block,
    first_stage: first_stage::Block,
    second_stage: second_stage::Block,
    passages: passages::Block,
    pipe: pipe::Block,
    jack: jack::Block,
    start_pressure_pa: f64,
}

/// Everything that survives a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Controller.
    pub controller: controller::State,
    /// Torque motor.
    pub torque_motor: torque_motor::State,
    /// Flapper.
    pub first_stage: first_stage::State,
    /// Spool.
    pub second_stage: second_stage::State,
    /// Pipe capacities.
    pub pipe: pipe::State,
    /// Jack.
    pub jack: jack::State,
    /// Flow into the jack as the spool felt it last, m³/s.
    pub jack_flow_m3_per_s: f64,
}

impl Model {
    /// The model with these faults.
    #[must_use]
    pub fn new(shared: &Shared, own: &Params, faults: &Faults) -> Self {
        let mut fluid = own.fluid_at_temperature();
        fluid.clearance_extra_m += faults.clearance_m;
        let mut torque_motor = own.torque_motor;
        torque_motor.hysteresis_a += faults.hysteresis_a;
        torque_motor.current_offset_a += faults.current_offset_a;
        let mut first_stage = own.first_stage;
        first_stage.feedback_backlash_m += faults.feedback_backlash_m;
        let mut jack = shared.jack;
        jack.backlash_m += faults.jack_backlash_m;
        let mut second_stage = own.second_stage;
        second_stage.filter_clogging = 1.0 - (1.0 - second_stage.filter_clogging) * (1.0 - faults.clogging);
        let supply_differential_pa = fluid.supply_pressure_pa - fluid.return_pressure_pa;
        Self {
            time_step_s: own.time_step_s,
            controller: shared.controller,
            torque_motor: torque_motor::Block::new(&shared.torque_motor, &torque_motor, faults.kgm),
            first_stage: first_stage::Block::new(&first_stage),
            second_stage: second_stage::Block::new(&second_stage, supply_differential_pa),
            passages: passages::Block::new(&fluid),
            pipe: pipe::Block::new(&fluid),
            jack: jack::Block::new(&jack, &own.friction, faults.fdj_n),
            start_pressure_pa: 0.5 * (fluid.supply_pressure_pa + fluid.return_pressure_pa),
        }
    }

    /// The time step, s.
    #[must_use]
    pub fn time_step_s(&self) -> f64 {
        self.time_step_s
    }

    /// Everything at rest at zero, both chambers halfway between supply and return.
    #[must_use]
    pub fn start(&self) -> State {
        self.start_at(0.0)
    }

    /// The same with the jack at a position, m.
    #[must_use]
    pub fn start_at(&self, jack_position_m: f64) -> State {
        State {
            controller: controller::State::default(),
            torque_motor: torque_motor::State::default(),
            first_stage: first_stage::State::default(),
            second_stage: second_stage::State::default(),
            pipe: pipe::State::at_rest(self.start_pressure_pa),
            jack: jack::State::at_rest(jack_position_m),
            jack_flow_m3_per_s: 0.0,
        }
    }

    /// One time step.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, s: &State, input: &Input) -> State {
        self.step_in::<Plain>((), s, input)
    }

    /// One time step, in signal order, with the four passages in a lane that the instruction set has.
    #[inline(always)]
    #[must_use]
    pub fn step_in<F: Four>(&self, token: F::Token, s: &State, input: &Input) -> State {
        let dt = self.time_step_s;
        let error_m = input.position_command_m - s.jack.measured_m;
        let current_max_a = self.torque_motor.current_max_a();
        let (controller, asked_a) = controller::step(&self.controller, &s.controller, error_m, current_max_a, dt);
        let (torque_motor, force_n) =
            self.torque_motor.step(&s.torque_motor, asked_a, input.interference_a, s.first_stage.position_m);
        let first_stage = self.first_stage.step(&s.first_stage, force_n, s.second_stage.position_m, dt);
        let second_stage = self.second_stage.step(
            &s.second_stage,
            first_stage.position_m,
            s.jack_flow_m3_per_s,
            input.supply_factor,
            dt,
        );
        let supply_pa = self.passages.supply_pa(input.supply_factor);
        let (port_1_pa, port_2_pa) = (s.pipe.port_1_pa, s.pipe.port_2_pa);
        let flows = self.passages.step_in::<F>(token, second_stage.position_m, supply_pa, port_1_pa, port_2_pa);
        let jack_flow = self.jack.flow_m3_per_s(&s.jack);
        let pipe = self.pipe.step(&s.pipe, &flows, jack_flow, dt);
        let jack = self.jack.step(&s.jack, pipe.load_pressure_pa(), input.external_load_n, dt);
        State { controller, torque_motor, first_stage, second_stage, pipe, jack, jack_flow_m3_per_s: jack_flow }
    }
}
