//! What the time loop needs of a model.

use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;

use crate::models::blocks::Input;
use crate::models::{monitoring, reference};
#[cfg(target_arch = "x86_64")]
use crate::numeric::lane::Register;
use crate::numeric::lane::{Four, Plain};

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
    fn start(&self, jack_position_m: f64) -> Self::State;
    fn step(&self, state: &Self::State, input: &Input) -> Self::State;
    fn sample(state: &Self::State) -> Sample;
}

/// Something that can be done with any plant.
pub(super) trait Work {
    type Output;

    fn on<P: Plant>(self, plant: &P) -> Self::Output;
}

/// The reference model, its four passages in lanes of this kind.
pub(super) struct ReferencePlant<F: Four> {
    model: reference::Model,
    token: F::Token,
}

/// Does the work on the reference model, the whole of it compiled for four-wide instructions where this processor has
/// them. The bits are the same with and without.
pub(super) fn on_reference<W: Work>(model: reference::Model, work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = V3::try_new() {
        let plant = ReferencePlant::<Register<V3>> { model, token: simd };
        return simd.vectorize(Compiled { plant, work });
    }
    work.on(&ReferencePlant::<Plain> { model, token: () })
}

/// The work on a plant, as one function that is compiled for an instruction set.
struct Compiled<P, W> {
    plant: P,
    work: W,
}

impl<P: Plant, W: Work> NullaryFnOnce for Compiled<P, W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.work.on(&self.plant)
    }
}

impl<F: Four> Plant for ReferencePlant<F> {
    type State = reference::State;

    const COLUMNS: &'static [&'static str] = &["flapper_position_m", "port_1_pressure_pa", "port_2_pressure_pa"];

    #[inline(always)]
    fn time_step_s(&self) -> f64 {
        self.model.time_step_s()
    }

    #[inline(always)]
    fn start(&self, jack_position_m: f64) -> Self::State {
        self.model.start_at(jack_position_m)
    }

    #[inline(always)]
    fn step(&self, state: &Self::State, input: &Input) -> Self::State {
        self.model.step_in::<F>(self.token, state, input)
    }

    #[inline(always)]
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

    fn start(&self, jack_position_m: f64) -> Self::State {
        monitoring::State::start((), jack_position_m)
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
