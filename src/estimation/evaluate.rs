//! Candidates through the monitoring model, many in lock-step.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::features::{Features, Measured};
use super::manoeuvre::{Window, resample};
use crate::models::monitoring::large_step::{LargeStep, TIME_STEP_MAX_S};
use crate::models::monitoring::{Model, State};
use crate::models::parameters::ParameterSet;
use crate::models::trace::{Channel, Trace};
use crate::numeric::lane::{Both, Lane, Lanes, Register};

/// The faults that a candidate proposes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proposal {
    /// Torque-motor demagnetisation, 0 to 1.
    pub kgm: f64,
    /// Dynamic jack friction, N.
    pub fdj_n: f64,
}

/// One trace's command, ready to drive any number of candidates.
#[derive(Debug)]
pub struct Evaluator {
    model: LargeStep,
    /// Where the jack is at the start, m.
    start_m: f64,
    command_m: Vec<f64>,
    current_steps: Range<usize>,
    pressure_steps: Range<usize>,
    arch: Arch,
}

impl Evaluator {
    /// Prepares the run that a trace asks for, up to the end of its last window; the rest adds nothing.
    #[must_use]
    pub fn new(trace: &Trace, measured: &Measured, set: &ParameterSet) -> Self {
        let start_s = trace.time_s()[0];
        let end_s = measured.current_window.to_s.max(measured.pressure_window.to_s);
        let index = |at_s: f64| ((at_s - start_s) / TIME_STEP_MAX_S).round() as usize;
        let steps = |w: &Window| index(w.from_s)..index(w.to_s) + 1;
        Self {
            model: LargeStep::new(&Model::new(&set.shared(), set.monitoring_model()), TIME_STEP_MAX_S),
            // Without a recorded position the jack is taken to rest where the command starts.
            start_m: trace.channel(Channel::JackPosition).unwrap_or(trace.position_command_m())[0],
            command_m: resample(trace.time_s(), trace.position_command_m(), TIME_STEP_MAX_S, end_s),
            current_steps: steps(&measured.current_window),
            pressure_steps: steps(&measured.pressure_window),
            arch: Arch::new(),
        }
    }

    /// The features of each proposal, in their order; not finite where a run diverged. A proposal's figures do not
    /// depend on its neighbours, nor on the instruction set.
    #[must_use]
    pub fn features(&self, proposals: &[Proposal]) -> Vec<Features> {
        self.arch.dispatch(Batch { evaluator: self, proposals })
    }

    /// Runs as many proposals as a lane holds.
    #[inline(always)]
    fn run<L: Lane>(&self, token: L::Token, kgm: L, fdj_n: L) -> [L; 4] {
        let candidate = self.model.model().candidate(kgm, fdj_n);
        let mut state = State::<L>::start(token, self.start_m);
        let [mut ramp_a, mut ramp_pa, mut step_a, mut step_pa] = [L::splat(token, 0.0); 4];
        for (step, &command_m) in self.command_m.iter().enumerate() {
            state = self.model.step(&candidate, &state, command_m);
            if self.current_steps.contains(&step) {
                ramp_a = ramp_a + state.servovalve_current_a;
                ramp_pa = ramp_pa + state.load_pressure_pa;
            }
            if self.pressure_steps.contains(&step) {
                step_a = step_a + state.servovalve_current_a;
                step_pa = step_pa + state.load_pressure_pa;
            }
        }
        let (ramp, step) = (self.current_steps.len() as f64, self.pressure_steps.len() as f64);
        [ramp_a / ramp, step_pa / step, ramp_pa / ramp, step_a / step]
    }
}

/// Proposals for whatever instruction set the machine has.
struct Batch<'a> {
    evaluator: &'a Evaluator,
    proposals: &'a [Proposal],
}

impl WithSimd for Batch<'_> {
    type Output = Vec<Features>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Features> {
        let mut features = Vec::with_capacity(self.proposals.len());
        let mut rest = self.proposals;
        while !rest.is_empty() {
            // Registers side by side hide latencies; more than the proposals fill would be wasted.
            let registers = rest.len().div_ceil(S::F64_LANES).min(REGISTERS_MAX);
            let (now, later) = rest.split_at(rest.len().min(registers * S::F64_LANES));
            match registers {
                1 => run_lanes::<Register<S>>(simd, self.evaluator, now, &mut features),
                2 => run_lanes::<Two<S>>(simd, self.evaluator, now, &mut features),
                3 => run_lanes::<Both<Register<S>, Two<S>>>(simd, self.evaluator, now, &mut features),
                4 => run_lanes::<Both<Two<S>, Two<S>>>(simd, self.evaluator, now, &mut features),
                _ => run_lanes::<Both<Register<S>, Both<Two<S>, Two<S>>>>(simd, self.evaluator, now, &mut features),
            }
            rest = later;
        }
        features
    }
}

/// The most registers side by side: 40 candidates in five registers of eight.
const REGISTERS_MAX: usize = 5;

/// Two registers side by side.
type Two<S> = Both<Register<S>, Register<S>>;

#[inline(always)]
fn run_lanes<L: Lanes>(token: L::Token, evaluator: &Evaluator, proposals: &[Proposal], features: &mut Vec<Features>) {
    let kgm: Vec<f64> = proposals.iter().map(|p| p.kgm).collect();
    let fdj_n: Vec<f64> = proposals.iter().map(|p| p.fdj_n).collect();
    let means = evaluator.run(token, L::load(token, &kgm), L::load(token, &fdj_n));
    let mut columns = [(); 4].map(|()| vec![0.0; proposals.len()]);
    for (column, mean) in columns.iter_mut().zip(means) {
        mean.store(column);
    }
    let [ramp_a, step_pa, ramp_pa, step_a] = columns;
    features.extend((0..proposals.len()).map(|i| Features {
        servovalve_current_a: ramp_a[i],
        load_pressure_pa: step_pa[i],
        ramp_pressure_pa: ramp_pa[i],
        step_current_a: step_a[i],
    }));
}
