//! What both models show of the diagnostic command at fault levels that are in none of the thesis's tables.
//!
//! Source: section 6.3: current over 1.8 to 1.9 s, load pressure over 5.09 to 5.11 s.
//! Signs: docs/conventions.md.
//! Range: actuators that follow 0.1 m/s and are near 0.1 m and still creeping 1.1 s after the step.
//! Limits: the reference model is sampled at 10 kHz for the means.

use std::ops::RangeInclusive;

use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use crate::models::blocks::Input;
use crate::models::drive::Drive;
use crate::models::fault::Faults;
use crate::models::monitoring::large_step::{LargeStep, TIME_STEP_MAX_S};
use crate::models::monitoring::{Model, State};
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, Simulation, SimulationError, simulate};
use crate::models::trace::{Channel, Trace};
use crate::numeric::statistics::{mean_between, window};
use crate::numeric::watch::Unwatched;

/// Demagnetisations of the levels.
const KGM: [f64; 4] = [0.05, 0.15, 0.25, 0.35];
/// Dynamic frictions of the levels, N.
const FDJ_N: [f64; 4] = [300.0, 500.0, 700.0, 900.0];
/// The fine step of the monitoring model, s: a simulation's.
pub const TIME_STEP_S: f64 = 1e-5;
/// The current's window, s.
const CURRENT_S: (f64, f64) = (1.8, 1.9);
/// The pressure's window, s.
const PRESSURE_S: (f64, f64) = (5.09, 5.11);
const SAMPLE_RATE_HZ: f64 = 1e4;
/// The noise that frees a spool, mA² s: 250 times less than the thesis's, so that the mean current is known to 2e-5 of itself.
const FREEING_MA2_S: f64 = 2e-8;
/// The ramp of the diagnostic command, m/s, and the part of it by which a jack may stray.
const RAMP_M_PER_S: (f64, f64) = (0.1, 0.05);
/// The step of the diagnostic command, m, and how far off a jack may be 1.1 s later.
const STEP_M: (f64, f64) = (0.1, 0.02);

/// A pair of faults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// Torque-motor demagnetisation.
    pub kgm: f64,
    /// Dynamic jack friction, N.
    pub fdj_n: f64,
}

/// What a run shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Features {
    /// Mean current of the ramp, A.
    pub servovalve_current_a: f64,
    /// Mean load pressure after the step, Pa.
    pub load_pressure_pa: f64,
    /// Mean spool position of the ramp, m.
    pub spool_position_m: f64,
    /// Mean load pressure of the ramp, Pa.
    pub ramp_pressure_pa: f64,
}

/// Why a run does not show the features.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Problem {
    /// The model diverged.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The jack does not follow the ramp.
    #[error(
        "the jack moves at {found_m_per_s:.3} m/s on the ramp, expected 0.095 to 0.105: the ramp cannot be followed"
    )]
    RampNotFollowed {
        /// Its mean velocity, m/s.
        found_m_per_s: f64,
    },
    /// The current is at its limit.
    #[error("the current of the ramp reaches its limit of {limit_a} A: the controller saturates")]
    CurrentSaturated {
        /// The limit, A.
        limit_a: f64,
    },
    /// The jack is far from where the step sends it.
    #[error("the jack is at {found_m:.3} m 1.1 s after the step, expected 0.08 to 0.12")]
    StepNotReached {
        /// Its mean position, m.
        found_m: f64,
    },
    /// The jack stands, and its pressure may be any that friction withstands.
    #[error(
        "the jack creeps at {found_m_per_s:e} m/s 1.1 s after the step, expected more than the dead band of \
         {dead_band_m_per_s:e} m/s: it rests, and its pressure does not show the friction"
    )]
    JackAtRest {
        /// Its mean velocity, m/s.
        found_m_per_s: f64,
        /// The monitoring model's dead band, below which a jack counts as stuck, m/s.
        dead_band_m_per_s: f64,
    },
}

/// A level at which a run does not show the features.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("the diagnostic run with KGM {} and FDJ {} N: {problem}", level.kgm, level.fdj_n)]
pub struct LevelError {
    /// The level.
    pub level: Level,
    /// Why.
    pub problem: Problem,
}

/// The levels, KGM after KGM.
#[must_use]
pub fn levels() -> Vec<Level> {
    KGM.iter().flat_map(|&kgm| FDJ_N.map(|fdj_n| Level { kgm, fdj_n })).collect()
}

/// The reference model's features at each level, telling after each that it is done.
///
/// # Errors
/// Every level at which they do not exist.
pub fn reference(
    set: &ParameterSet,
    levels: &[Level],
    done: impl Fn() + Sync,
) -> Result<Vec<Features>, Vec<LevelError>> {
    let runs = reference_each(set, levels, done);
    let errors: Vec<LevelError> = runs.iter().filter_map(|run| run.as_ref().err().cloned()).collect();
    if errors.is_empty() { Ok(runs.into_iter().filter_map(Result::ok).collect()) } else { Err(errors) }
}

/// The reference model's features at each level, or why they do not exist there, telling after each that it is done.
#[must_use]
pub fn reference_each(
    set: &ParameterSet,
    levels: &[Level],
    done: impl Fn() + Sync,
) -> Vec<Result<Features, LevelError>> {
    let run = |&level: &Level| {
        let features = reference_run(set, level).map_err(|problem| LevelError { level, problem });
        done();
        features
    };
    levels.par_iter().map(run).collect()
}

/// The steady current of the ramp at each level, A, with the spool freed from its own static friction by a little noise; `None` where
/// a run diverged, or where the controller is not proportional. It is what the controller asks for, which that noise moves least.
#[must_use]
pub fn freed_current_a(set: &ParameterSet, levels: &[Level], done: impl Fn() + Sync) -> Vec<Option<f64>> {
    let controller = set.shared().controller;
    let proportional = controller.integral_gain_a_per_m_s == 0.0 && controller.derivative_gain_a_s_per_m == 0.0;
    let run = |&Level { kgm, fdj_n }: &Level| {
        let faults = Faults { kgm, fdj_n, ..Faults::default() };
        let quiet = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, CURRENT_S.1, SAMPLE_RATE_HZ);
        // A seed of each level's own, whatever its neighbours.
        let seed = (kgm * 1e4).round() as u64 * 1_000_000 + (fdj_n * 100.0).round() as u64;
        let trace = simulate(&Simulation { noise_power_ma2_s: FREEING_MA2_S, seed, ..quiet }, set, &Unwatched);
        done();
        let trace = trace.ok().filter(|_| proportional)?;
        let mean = |channel| mean_of(&trace, channel, CURRENT_S.0, CURRENT_S.1);
        let error_m = mean(Channel::PositionCommand) - mean(Channel::JackPosition);
        Some(controller.proportional_gain_a_per_m * error_m)
    };
    levels.par_iter().map(run).collect()
}

fn reference_run(set: &ParameterSet, Level { kgm, fdj_n }: Level) -> Result<Features, Problem> {
    let faults = Faults { kgm, fdj_n, ..Faults::default() };
    let recipe = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, PRESSURE_S.1, SAMPLE_RATE_HZ);
    let trace = simulate(&recipe, set, &Unwatched)?;
    let mean = |channel, (from_s, to_s)| mean_of(&trace, channel, from_s, to_s);
    let found_m_per_s = mean(Channel::JackVelocity, CURRENT_S);
    let limit_a = set.shared().torque_motor.current_max_a;
    if peak_of(&trace, Channel::ServovalveCurrent, CURRENT_S) >= limit_a {
        return Err(Problem::CurrentSaturated { limit_a });
    }
    if (found_m_per_s / RAMP_M_PER_S.0 - 1.0).abs() > RAMP_M_PER_S.1 {
        return Err(Problem::RampNotFollowed { found_m_per_s });
    }
    let found_m = mean(Channel::JackPosition, PRESSURE_S);
    if (found_m - STEP_M.0).abs() > STEP_M.1 {
        return Err(Problem::StepNotReached { found_m });
    }
    let found_m_per_s = mean(Channel::JackVelocity, PRESSURE_S);
    let dead_band_m_per_s = set.monitoring_model().friction.velocity_dead_band_m_per_s;
    if found_m_per_s <= dead_band_m_per_s {
        return Err(Problem::JackAtRest { found_m_per_s, dead_band_m_per_s });
    }
    Ok(Features {
        servovalve_current_a: mean(Channel::ServovalveCurrent, CURRENT_S),
        load_pressure_pa: mean(Channel::LoadPressure, PRESSURE_S),
        spool_position_m: mean(Channel::SpoolPosition, CURRENT_S),
        ramp_pressure_pa: mean(Channel::LoadPressure, CURRENT_S),
    })
}

fn mean_of(trace: &Trace, channel: Channel, from_s: f64, to_s: f64) -> f64 {
    let values = trace.channel(channel).expect("a simulation records every channel");
    mean_between(trace.time_s(), values, from_s, to_s).expect("the run reaches beyond its windows")
}

fn peak_of(trace: &Trace, channel: Channel, (from_s, to_s): (f64, f64)) -> f64 {
    let values = trace.channel(channel).expect("a simulation records every channel");
    values[window(trace.time_s(), from_s, to_s)].iter().map(|value| value.abs()).fold(0.0, f64::max)
}

/// The monitoring model's features at each level by the fine step; not finite where a run diverged.
#[must_use]
pub fn monitoring(model: &Model, levels: &[Level]) -> Vec<Features> {
    let run = |level: &Level| {
        let candidate = model.candidate(level.kgm, level.fdj_n);
        run(TIME_STEP_S, |s, command_m| model.step(&candidate, s, &Input::command(command_m), TIME_STEP_S))
    };
    levels.par_iter().map(run).collect()
}

/// The monitoring model's features at each level by the large step, fifty times as fast.
///
/// # Panics
/// When the model's fluid is not the developed one.
#[must_use]
pub fn monitoring_fast(model: &Model, levels: &[Level]) -> Vec<Features> {
    let model = LargeStep::new(model, TIME_STEP_MAX_S);
    let run = |level: &Level| {
        let candidate = model.model().candidate(level.kgm, level.fdj_n);
        run(TIME_STEP_MAX_S, |s, command_m| model.step(&candidate, s, command_m))
    };
    levels.par_iter().map(run).collect()
}

fn run(time_step_s: f64, step: impl Fn(&State<f64>, f64) -> State<f64>) -> Features {
    let per_s = (1.0 / time_step_s).round();
    let steps = |(from_s, to_s): (f64, f64)| -> RangeInclusive<usize> {
        (from_s * per_s).round() as usize..=(to_s * per_s).round() as usize
    };
    let (current, pressure) = (steps(CURRENT_S), steps(PRESSURE_S));
    let mut s = State::start((), 0.0);
    let mut sums = [0.0; 4];
    for k in 0..=*pressure.end() {
        s = step(&s, Drive::Diagnostic.position_m(k as f64 / per_s, PRESSURE_S.1));
        if current.contains(&k) {
            sums[0] += s.servovalve_current_a;
            sums[1] += s.spool_position_m;
            sums[2] += s.load_pressure_pa;
        }
        if pressure.contains(&k) {
            sums[3] += s.load_pressure_pa;
        }
    }
    let (current, pressure) = (current.count() as f64, pressure.count() as f64);
    Features {
        servovalve_current_a: sums[0] / current,
        load_pressure_pa: sums[3] / pressure,
        spool_position_m: sums[1] / current,
        ramp_pressure_pa: sums[2] / current,
    }
}
