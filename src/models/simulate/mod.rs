//! A simulation: a model, a command and faults make a trace. Here is the one time loop.

mod inputs;
mod interference;
mod plant;
mod provenance;
mod recorder;

use serde::{Deserialize, Serialize};
use thiserror::Error;
use utoipa::ToSchema;

use super::drive::{Drive, POSITION_MAX_M};
use super::fault::{CLEARANCE_MAX_M, FDJ_MAX_N, FDJ_NOMINAL_N, Faults};
use super::monitoring::fluid::FluidModel;
use super::parameters::ParameterSet;
use super::signal::Signal;
use super::trace::{DURATION_MAX_S, SAMPLES_MIN, Trace};
use super::{monitoring, reference};
use crate::numeric::watch::Watch;
use inputs::Inputs;
use interference::Interference;
use plant::{MonitoringPlant, Plant, Work, on_reference};
pub use provenance::Provenance;
use recorder::Recorder;

/// The fastest sampling, Hz.
pub const SAMPLE_RATE_MAX_HZ: f64 = 1e5;
/// The most samples that a simulation may make: ten minutes at 1 kHz, both ends included.
pub const SIMULATED_SAMPLES_MAX: f64 = 600_001.0;
/// The most supply pressure over the parameter set's.
const SUPPLY_FACTOR_MAX: f64 = 2.0;
/// The most external load, N.
const LOAD_MAX_N: f64 = 1e6;
/// Steps between two looks at the watch.
const STEPS_PER_LOOK: u64 = 20_000;

/// Which model to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// The detailed model of the thesis's chapter 4.
    Reference,
    /// The fast model of the thesis's section 4.2 and chapter 5.
    Monitoring,
}

/// A quantity that acts from outside during a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// The same all along.
    Constant(f64),
    /// As it was recorded.
    Recorded(Signal),
}

impl Quantity {
    /// Its value at a time of the run, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Recorded(signal) => signal.at(time_s),
        }
    }

    /// The least and the greatest value.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        match self {
            Self::Constant(value) => (*value, *value),
            Self::Recorded(signal) => signal.range(),
        }
    }
}

/// The recipe of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// The model.
    pub model: ModelKind,
    /// The command.
    pub command: Drive,
    /// The monitoring model's fluid; the reference model has its own.
    pub fluid: Option<FluidModel>,
    /// The faults.
    pub faults: Faults,
    /// External load on the jack beside the parameter set's constant one, N, within ±1e6; none without it.
    pub external_load_n: Option<Quantity>,
    /// Absolute supply pressure, Pa, 0 to twice the parameter set's; the parameter set's without it.
    pub supply_pressure_pa: Option<Quantity>,
    /// Where the jack rests at the start, m.
    pub start_position_m: f64,
    /// Power of the white noise on the current, mA² s; 5e-6 in the thesis, 0 for none. Reference model only.
    pub noise_power_ma2_s: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Length, s, above 0, at most [`DURATION_MAX_S`].
    pub duration_s: f64,
    /// Samples per second, Hz, 1 to [`SAMPLE_RATE_MAX_HZ`].
    pub sample_rate_hz: f64,
}

/// Why a simulation could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// A value is out of its range.
    #[error("{name}: found {found}, expected {expected}")]
    OutOfRange {
        /// The field.
        name: &'static str,
        /// Its value.
        found: f64,
        /// Its range, with its unit.
        expected: &'static str,
    },
    /// The reference model was asked for a fluid of the monitoring model's.
    #[error(
        "fluid: found one for the reference model, expected none: only the monitoring model has fluids to choose from"
    )]
    Fluid,
    /// The supply pressure is beyond what the parameter set allows.
    #[error("supply_pressure_pa: found {found}, expected at most {max} Pa, twice the parameter set's")]
    Supply {
        /// The greatest supply pressure, Pa.
        found: f64,
        /// The most allowed, Pa.
        max: f64,
    },
    /// The state stopped being finite: the parameters and the time step do not go together.
    #[error("the model diverged at {time_s} s")]
    Diverged {
        /// When.
        time_s: f64,
    },
    /// The watcher asked for an end.
    #[error("cancelled")]
    Cancelled,
}

impl SimulationError {
    /// The field at fault, where it is one.
    #[must_use]
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::OutOfRange { name, .. } => Some(name),
            Self::Fluid => Some("fluid"),
            Self::Supply { .. } => Some("supply_pressure_pa"),
            Self::Diverged { .. } | Self::Cancelled => None,
        }
    }
}

impl Simulation {
    /// A run without noise, external load or another supply, its seed 1; the monitoring model with its developed fluid.
    #[must_use]
    pub fn new(model: ModelKind, command: Drive, faults: Faults, duration_s: f64, sample_rate_hz: f64) -> Self {
        Self {
            model,
            command,
            fluid: None,
            faults,
            external_load_n: None,
            supply_pressure_pa: None,
            start_position_m: 0.0,
            noise_power_ma2_s: 0.0,
            seed: 1,
            duration_s,
            sample_rate_hz,
        }
    }

    /// Every field that is out of its range; empty when the recipe can be run with this parameter set.
    #[must_use]
    pub fn check(&self, set: &ParameterSet) -> Vec<SimulationError> {
        let mut errors = Vec::new();
        let mut expect = |holds: bool, name, found, expected| {
            if !holds {
                errors.push(SimulationError::OutOfRange { name, found, expected });
            }
        };
        let Faults { kgm, fdj_n, clearance_m, clogging, .. } = self.faults;
        let Faults { feedback_backlash_m, jack_backlash_m, current_offset_a, hysteresis_a, .. } = self.faults;
        expect((0.0..=1.0).contains(&kgm), "faults.kgm", kgm, "0 to 1");
        expect((FDJ_NOMINAL_N..=FDJ_MAX_N).contains(&fdj_n), "faults.fdj_n", fdj_n, "200 to 2000 N");
        expect((0.0..=CLEARANCE_MAX_M).contains(&clearance_m), "faults.clearance_m", clearance_m, "0 to 1e-4 m");
        expect((0.0..=1.0).contains(&clogging), "faults.clogging", clogging, "0 to 1");
        let feedback = (0.0..=1e-4).contains(&feedback_backlash_m);
        expect(feedback, "faults.feedback_backlash_m", feedback_backlash_m, "0 to 1e-4 m");
        expect((0.0..=0.01).contains(&jack_backlash_m), "faults.jack_backlash_m", jack_backlash_m, "0 to 0.01 m");
        let offset = (-0.02..=0.02).contains(&current_offset_a);
        expect(offset, "faults.current_offset_a", current_offset_a, "-0.02 to 0.02 A");
        expect((0.0..=0.02).contains(&hysteresis_a), "faults.hysteresis_a", hysteresis_a, "0 to 0.02 A");
        let noise = self.noise_power_ma2_s;
        expect((0.0..=1.0).contains(&noise), "noise_power", noise, "0 to 1 mA2 s");
        let recorded = if let Drive::Recorded(signal) = &self.command { signal.range() } else { (0.0, 0.0) };
        for (name, (low, high), (min, max), expected) in [
            ("command", recorded, (-POSITION_MAX_M, POSITION_MAX_M), "-10 to 10 m"),
            (
                "start_position_m",
                (self.start_position_m, self.start_position_m),
                (-POSITION_MAX_M, POSITION_MAX_M),
                "-10 to 10 m",
            ),
            ("external_load_n", range(self.external_load_n.as_ref()), (-LOAD_MAX_N, LOAD_MAX_N), "-1e6 to 1e6 N"),
            ("supply_pressure_pa", range(self.supply_pressure_pa.as_ref()), (0.0, f64::MAX), "0 Pa or more"),
        ] {
            // The end that is further out is told.
            let found = if low.is_nan() || low < min { low } else { high };
            expect(min <= low && high <= max, name, found, expected);
        }
        if self.model == ModelKind::Monitoring {
            let expected = "0: the monitoring model does not have it";
            expect(clearance_m == 0.0, "faults.clearance_m", clearance_m, expected);
            expect(clogging == 0.0, "faults.clogging", clogging, expected);
            expect(feedback_backlash_m == 0.0, "faults.feedback_backlash_m", feedback_backlash_m, expected);
            expect(jack_backlash_m == 0.0, "faults.jack_backlash_m", jack_backlash_m, expected);
            expect(current_offset_a == 0.0, "faults.current_offset_a", current_offset_a, expected);
            expect(hysteresis_a == 0.0, "faults.hysteresis_a", hysteresis_a, expected);
            expect(noise == 0.0, "noise_power", noise, expected);
        }
        let (duration_s, rate_hz) = (self.duration_s, self.sample_rate_hz);
        let lasts = duration_s > 0.0 && duration_s <= DURATION_MAX_S;
        expect(lasts, "duration_s", duration_s, "above 0, at most 600 s");
        let samples = (1.0..=SAMPLE_RATE_MAX_HZ).contains(&rate_hz);
        expect(samples, "sample_rate_hz", rate_hz, "1 to 100000 Hz");
        if lasts && samples {
            let samples = (duration_s * rate_hz).floor() + 1.0;
            let fits = (SAMPLES_MIN as f64..=SIMULATED_SAMPLES_MAX).contains(&samples);
            expect(fits, "duration_s times sample_rate_hz", samples, "10 to 600001 samples");
        }
        if self.model == ModelKind::Reference && self.fluid.is_some() {
            errors.push(SimulationError::Fluid);
        }
        let max = SUPPLY_FACTOR_MAX * set.reference_model().fluid.supply_pressure_pa;
        let (_, found) = range(self.supply_pressure_pa.as_ref());
        if found > max {
            errors.push(SimulationError::Supply { found, max });
        }
        errors
    }
}

/// The range of a quantity; zero where there is none.
fn range(quantity: Option<&Quantity>) -> (f64, f64) {
    quantity.map_or((0.0, 0.0), Quantity::range)
}

/// Runs a model. Row k of the trace is the state after the step at k / rate (the nearest step where the rate does not
/// divide the steps evenly).
///
/// # Errors
/// The first field out of its range, a model that diverged, or cancellation by `watch`.
pub fn simulate(recipe: &Simulation, set: &ParameterSet, watch: &dyn Watch) -> Result<Trace, SimulationError> {
    if let Some(error) = recipe.check(set).into_iter().next() {
        return Err(error);
    }
    let inputs = Inputs::new(recipe, set);
    match recipe.model {
        ModelKind::Reference => {
            let own = set.reference_model();
            let model = reference::Model::new(&set.shared(), own, &recipe.faults);
            let sample_time_s = own.torque_motor.interference_sample_time_s;
            let interference = Interference::new(recipe.noise_power_ma2_s, sample_time_s, own.time_step_s, recipe.seed);
            on_reference(model, TimeLoop { recipe, inputs, interference, watch })
        }
        ModelKind::Monitoring => {
            let fluid = recipe.fluid.unwrap_or_default();
            let model = monitoring::Model::with_fluid(&set.shared(), set.monitoring_model(), fluid);
            let candidate = model.candidate(recipe.faults.kgm, recipe.faults.fdj_n);
            let interference = Interference::none();
            TimeLoop { recipe, inputs, interference, watch }.on(&MonitoringPlant { model, candidate })
        }
    }
}

/// The time loop with what it needs beside a plant.
struct TimeLoop<'a> {
    recipe: &'a Simulation,
    inputs: Inputs<'a>,
    interference: Interference,
    watch: &'a dyn Watch,
}

impl Work for TimeLoop<'_> {
    type Output = Result<Trace, SimulationError>;

    #[inline(always)]
    fn on<P: Plant>(self, plant: &P) -> Self::Output {
        run(plant, self.recipe, &self.inputs, self.interference, self.watch)
    }
}

/// The time loop.
#[inline(always)]
fn run<P: Plant>(
    plant: &P,
    recipe: &Simulation,
    inputs: &Inputs<'_>,
    mut interference: Interference,
    watch: &dyn Watch,
) -> Result<Trace, SimulationError> {
    // 1/dt is the whole number of steps in a second; k dt and k / that number are not the same double.
    let steps_per_s = (1.0 / plant.time_step_s()).round();
    let mut recorder = Recorder::new(recipe);
    let mut state = plant.start(recipe.start_position_m);
    let mut step: u64 = 0;
    while let Some(due) = recorder.next_step(steps_per_s) {
        loop {
            let input = inputs.at(step as f64 / steps_per_s, interference.next());
            state = plant.step(&state, &input);
            step += 1;
            if step.is_multiple_of(STEPS_PER_LOOK) {
                watch.progress(recorder.fraction());
                if watch.cancelled() {
                    return Err(SimulationError::Cancelled);
                }
            }
            if step > due {
                break;
            }
        }
        let time_s = (step - 1) as f64 / steps_per_s;
        let sample = P::sample(&state);
        if sample.iter().any(|value| !value.is_finite()) {
            return Err(SimulationError::Diverged { time_s });
        }
        recorder.record(time_s, &sample);
    }
    Ok(recorder.finish(P::COLUMNS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::trace::Channel;
    use crate::numeric::watch::Unwatched;

    fn recipe(model: ModelKind) -> Simulation {
        Simulation::new(model, Drive::Diagnostic, Faults::default(), 0.1, 1000.0)
    }

    #[test]
    fn both_models_record_every_due_sample_from_time_zero() {
        for model in [ModelKind::Reference, ModelKind::Monitoring] {
            let trace = simulate(&recipe(model), &ParameterSet::reference(), &Unwatched).unwrap();
            assert_eq!(trace.samples(), 101);
            assert_eq!(trace.time_s()[100], 0.1);
            assert_eq!(trace.position_command_m()[100], 0.1 * 0.1);
            assert!(trace.channel(Channel::JackPosition).unwrap()[100] > 0.0);
        }
    }

    #[test]
    fn determinism_the_same_seed_gives_the_same_bits_and_another_does_not() {
        let with_seed = |seed: u64| {
            let noisy = Simulation { seed, noise_power_ma2_s: 5e-6, ..recipe(ModelKind::Reference) };
            simulate(&noisy, &ParameterSet::reference(), &Unwatched).unwrap()
        };
        assert_eq!(with_seed(3), with_seed(3));
        assert_ne!(with_seed(3), with_seed(4));
    }

    #[test]
    fn a_rate_that_does_not_divide_the_steps_records_the_nearest_ones() {
        let odd = Simulation { sample_rate_hz: 300.0, ..recipe(ModelKind::Reference) };
        let trace = simulate(&odd, &ParameterSet::reference(), &Unwatched).unwrap();
        assert_eq!(trace.samples(), 31);
        assert!((trace.position_command_m()[1] - 0.1 / 300.0).abs() < 0.1 * 0.5e-5);
    }

    #[test]
    fn every_field_out_of_its_range_is_named() {
        let mut bad = recipe(ModelKind::Monitoring);
        bad.faults = Faults { kgm: 1.5, fdj_n: 100.0, clearance_m: 1e-5, clogging: f64::NAN, ..Faults::default() };
        bad.noise_power_ma2_s = 5e-6;
        bad.duration_s = -1.0;
        bad.sample_rate_hz = 0.0;
        let errors = bad.check(&ParameterSet::reference());
        assert_eq!(errors.len(), 8, "{errors:?}");
    }

    #[test]
    fn the_watch_can_end_a_run() {
        struct Impatient;
        impl Watch for Impatient {
            fn progress(&self, _fraction: f64) {}

            fn cancelled(&self) -> bool {
                true
            }
        }
        let long = Simulation { duration_s: 100.0, ..recipe(ModelKind::Reference) };
        assert_eq!(simulate(&long, &ParameterSet::reference(), &Impatient), Err(SimulationError::Cancelled));
    }
}
