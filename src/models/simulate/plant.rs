//! What the time loop needs of a model.

use crate::models::blocks::Input;
use crate::models::{monitoring, reference};

/// The time step of the monitoring model in a simulation, s: the reference model's.
const MONITORING_TIME_STEP_S: f64 = 1e-5;

/// What is recorded of one step, in the order of the recorder's columns; what a model does not have is zero and has no column.
pub(super) type Sample = [f64; 8];

/// A model that the time loop can run.
pub(super) trait Plant {
    type State;

    /// The columns after those that both models have.
    const COLUMNS: &'static [&'static str];

    fn time_step_s(&self) -> f64;
    fn start(&self) -> Self::State;
    fn step(&self, state: &Self::State, input: &Input) -> Self::State;
    fn sample(state: &Self::State) -> Sample;
}

impl Plant for reference::Model {
    type State = reference::State;

    const COLUMNS: &'static [&'static str] = &["flapper_position_m", "port_1_pressure_pa", "port_2_pressure_pa"];

    fn time_step_s(&self) -> f64 {
        self.time_step_s()
    }

    fn start(&self) -> Self::State {
        self.start()
    }

    fn step(&self, state: &Self::State, input: &Input) -> Self::State {
        self.step(state, input)
    }

    fn sample(s: &Self::State) -> Sample {
        [
            s.torque_motor.current_a,
            s.pipe.load_pressure_pa(),
            s.jack.measured_m,
            s.jack.velocity_m_per_s,
            s.second_stage.position_m,
            s.first_stage.position_m,
            s.pipe.port_1_pa,
            s.pipe.port_2_pa,
        ]
    }
}

/// The monitoring model with the faults of one run.
pub(super) struct MonitoringPlant {
    pub model: monitoring::Model,
    pub candidate: monitoring::Candidate<f64>,
}

impl Plant for MonitoringPlant {
    type State = monitoring::State<f64>;

    const COLUMNS: &'static [&'static str] = &["flapper_position_m"];

    fn time_step_s(&self) -> f64 {
        MONITORING_TIME_STEP_S
    }

    fn start(&self) -> Self::State {
        monitoring::State::start((), 0.0)
    }

    fn step(&self, state: &Self::State, input: &Input) -> Self::State {
        self.model.step(&self.candidate, state, input, MONITORING_TIME_STEP_S)
    }

    fn sample(s: &Self::State) -> Sample {
        [
            s.servovalve_current_a,
            s.load_pressure_pa,
            s.jack_position_m,
            s.jack_velocity_m_per_s,
            s.spool_position_m,
            s.flapper_position_m,
            0.0,
            0.0,
        ]
    }
}
