//! Candidates through the monitoring model, many in lock-step.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::features::{Features, Measured};
use crate::models::monitoring::large_step::{LargeStep, TIME_STEP_MAX_S};
use crate::models::monitoring::{Model, State};
use crate::models::parameters::ParameterSet;
use crate::models::signal::Signal;
use crate::models::trace::{Channel, Trace};
use crate::numeric::lane::{Lane, LaneWork, Lanes, in_registers};

/// The faults that a candidate proposes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proposal {
    /// Torque-motor demagnetisation, 0 to 1.
    pub kgm: f64,
    /// Dynamic jack friction, N.
    pub fdj_n: f64,
}

/// One trace's command, ready to drive any number of candidates.
///
/// The time step is the longest that the model takes, but half of that for 0.05 s after the step from which the
/// pressure is taken: there a jack with little friction and a weak motor is carried off by how late and how abruptly a
/// long step begins to move, and creeps from elsewhere for the next second.
#[derive(Debug)]
pub struct Evaluator {
    whole: LargeStep,
    half: LargeStep,
    /// Where the jack is at the start, m.
    start_m: f64,
    stretches: Vec<Stretch>,
    arch: Arch,
}

/// A stretch of the run in which every step is alike.
#[derive(Debug)]
struct Stretch {
    /// The command at the end of each step, m.
    command_m: Vec<f64>,
    /// Whether the time step is half of the longest.
    half: bool,
    /// How much a step counts in the means of the ramp's window and of the step's.
    weight: [f64; 2],
}

/// How long after the step the time step is halved, s: twice what was seen to matter.
const HALF_STEPS_S: f64 = 0.05;
/// How much earlier than a step's end a jump's time may be taken, s: times that were printed and read back are that uncertain.
const TIME_TOLERANCE_S: f64 = 1e-9;
/// More proposals than this are shared out to threads, in parts that fill the registers.
const PROPOSALS_ON_A_THREAD: usize = 80;
/// The most proposals of a part.
const PART_MAX: usize = 40;
/// Parts hold a multiple of this, the most numbers in a register of any instruction set.
const PART_MULTIPLE: usize = 8;

impl Evaluator {
    /// Prepares the run that a trace asks for, up to the end of its last window; the rest adds nothing.
    #[must_use]
    pub fn new(trace: &Trace, measured: &Measured, set: &ParameterSet) -> Self {
        let model = Model::new(&set.shared(), set.monitoring_model());
        Self {
            whole: LargeStep::new(&model, TIME_STEP_MAX_S),
            half: LargeStep::new(&model, 0.5 * TIME_STEP_MAX_S),
            // Without a recorded position the jack is taken to rest where the command starts.
            start_m: trace.channel(Channel::JackPosition).unwrap_or(trace.position_command_m())[0],
            stretches: stretches(trace, measured),
            arch: Arch::new(),
        }
    }

    /// The features of each proposal, in their order; not finite where a run diverged. A proposal's figures do not
    /// depend on its neighbours, nor on the instruction set, nor on the number of threads.
    #[must_use]
    pub fn features(&self, proposals: &[Proposal]) -> Vec<Features> {
        let run = |proposals| self.arch.dispatch(Batch { evaluator: self, proposals });
        if proposals.len() <= PROPOSALS_ON_A_THREAD {
            return run(proposals);
        }
        let part = proposals.len().div_ceil(proposals.len().div_ceil(PART_MAX)).next_multiple_of(PART_MULTIPLE);
        proposals.par_chunks(part).map(run).collect::<Vec<_>>().concat()
    }

    /// Runs as many proposals as a lane holds. The means: current and pressure of the ramp, then of the step.
    #[inline(always)]
    fn run<L: Lane>(&self, token: L::Token, kgm: L, fdj_n: L) -> [L; 4] {
        let candidate = self.whole.model().candidate(kgm, fdj_n);
        let mut state = State::<L>::start(token, self.start_m);
        let [mut ramp_a, mut ramp_pa, mut step_a, mut step_pa] = [L::splat(token, 0.0); 4];
        for stretch in &self.stretches {
            let model = if stretch.half { &self.half } else { &self.whole };
            let [ramp, step] = stretch.weight;
            let counts = ramp + step > 0.0;
            let [mut sum_a, mut sum_pa] = [L::splat(token, 0.0); 2];
            for &command_m in &stretch.command_m {
                state = model.step(&candidate, &state, command_m);
                if counts {
                    sum_a = sum_a + state.servovalve_current_a;
                    sum_pa = sum_pa + state.load_pressure_pa;
                }
            }
            ramp_a = ramp_a + sum_a * ramp;
            ramp_pa = ramp_pa + sum_pa * ramp;
            step_a = step_a + sum_a * step;
            step_pa = step_pa + sum_pa * step;
        }
        [ramp_a, ramp_pa, step_a, step_pa]
    }
}

/// Cuts the run where the time step changes and where a window begins or ends.
fn stretches(trace: &Trace, measured: &Measured) -> Vec<Stretch> {
    let command = Signal::command(trace.time_s(), trace.position_command_m());
    let start_s = trace.time_s()[0];
    let index = |at_s: f64| ((at_s - start_s) / TIME_STEP_MAX_S).round() as usize;
    let windows = [measured.current_window, measured.pressure_window].map(|w| index(w.from_s)..index(w.to_s) + 1);
    let end = windows[0].end.max(windows[1].end);
    // The first step that feels the command's jump begins before it.
    let halved = measured.jump.map_or(0..0, |jump| {
        let first = ((jump.at_s - start_s - TIME_TOLERANCE_S) / TIME_STEP_MAX_S).ceil() as usize;
        first..first + (HALF_STEPS_S / TIME_STEP_MAX_S).round() as usize
    });
    let mut cuts = vec![0, end];
    cuts.extend([&halved, &windows[0], &windows[1]].into_iter().flat_map(|range| [range.start, range.end]));
    cuts.retain(|&cut| cut <= end);
    cuts.sort_unstable();
    cuts.dedup();
    let stretch = |pair: &[usize]| {
        let (from, to, half) = (pair[0], pair[1], halved.contains(&pair[0]));
        let steps = if half { 2 } else { 1 };
        let time_step_s = TIME_STEP_MAX_S / steps as f64;
        // Step k ends at the time k; the halves of it at k - 1/2 and k.
        let ends = from * steps + 1 - steps..to * steps + 1 - steps;
        let weight = |window: &Range<usize>| {
            if window.contains(&from) { 1.0 / (window.len() * steps) as f64 } else { 0.0 }
        };
        Stretch {
            command_m: ends.map(|step| command.at(step as f64 * time_step_s)).collect(),
            half,
            weight: [weight(&windows[0]), weight(&windows[1])],
        }
    };
    cuts.windows(2).map(stretch).collect()
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
        let Batch { evaluator, proposals } = self;
        let mut runs = Runs { evaluator, proposals, features: Vec::with_capacity(proposals.len()) };
        in_registers(simd, proposals.len(), &mut runs);
        runs.features
    }
}

/// The runs of a batch.
struct Runs<'a> {
    evaluator: &'a Evaluator,
    proposals: &'a [Proposal],
    features: Vec<Features>,
}

impl LaneWork for Runs<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, token: L::Token, places: Range<usize>) {
        let proposals = &self.proposals[places];
        let kgm: Vec<f64> = proposals.iter().map(|p| p.kgm).collect();
        let fdj_n: Vec<f64> = proposals.iter().map(|p| p.fdj_n).collect();
        let means = self.evaluator.run(token, L::load(token, &kgm), L::load(token, &fdj_n));
        let mut columns = [(); 4].map(|()| vec![0.0; proposals.len()]);
        for (column, mean) in columns.iter_mut().zip(means) {
            mean.store(column);
        }
        let [ramp_a, ramp_pa, step_a, step_pa] = columns;
        self.features.extend((0..proposals.len()).map(|i| Features {
            servovalve_current_a: ramp_a[i],
            load_pressure_pa: step_pa[i],
            ramp_pressure_pa: ramp_pa[i],
            step_current_a: step_a[i],
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::{features, manoeuvre};
    use crate::models::drive::Drive;
    use crate::models::fault::Faults;
    use crate::models::simulate::{ModelKind, Simulation, simulate};
    use crate::numeric::watch::Unwatched;

    /// A trace of the monitoring model at 1 kHz that begins at another time than zero.
    fn evaluator(start_s: f64) -> Evaluator {
        let set = ParameterSet::reference();
        let recipe = Simulation::new(ModelKind::Monitoring, Drive::Diagnostic, Faults::default(), 5.2, 1000.0);
        let trace = simulate(&recipe, &set, &Unwatched).unwrap();
        let time_s = trace.time_s().iter().map(|t| t + start_s).collect();
        let channels =
            [Channel::PositionCommand, Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition];
        let channels = channels.into_iter().map(|c| (c, trace.channel(c).unwrap().to_vec())).collect();
        let trace = Trace::try_new(time_s, channels, Vec::new()).unwrap();
        let found = manoeuvre::find(trace.time_s(), trace.position_command_m());
        Evaluator::new(&trace, &features::measure(&trace, &found, &set.shared()).unwrap(), &set)
    }

    #[test]
    fn parity_every_instruction_set_gives_the_bits_of_plain_numbers() {
        let evaluator = evaluator(0.0);
        let proposals: Vec<Proposal> =
            (0..9).map(|i| Proposal { kgm: 0.11 * f64::from(i), fdj_n: 2000.0 - 200.0 * f64::from(i) }).collect();
        let plain: Vec<Features> = proposals
            .iter()
            .map(|at| {
                let [ramp_a, ramp_pa, step_a, step_pa] = evaluator.run((), at.kgm, at.fdj_n);
                Features {
                    servovalve_current_a: ramp_a,
                    load_pressure_pa: step_pa,
                    ramp_pressure_pa: ramp_pa,
                    step_current_a: step_a,
                }
            })
            .collect();
        let batch = || Batch { evaluator: &evaluator, proposals: &proposals };
        assert_eq!(Arch::new().dispatch(batch()), plain);
        assert_eq!(Arch::Scalar.dispatch(batch()), plain);
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            assert_eq!(Simd::vectorize(simd, batch()), plain);
        }
    }

    #[test]
    fn the_run_ends_with_the_last_window_and_is_halved_after_the_step_alone() {
        for start_s in [0.0, 100.0] {
            let evaluator = evaluator(start_s);
            let steps: Vec<(usize, bool)> = evaluator.stretches.iter().map(|s| (s.command_m.len(), s.half)).collect();
            // To 1.8 s; to 1.9 s; to the step at 4 s; 0.05 s in halves; to 5.09 s; to 5.11 s.
            let expected = [(3600, false), (201, false), (4199, false), (200, true), (2080, false), (41, false)];
            assert_eq!(steps, expected);
            let halves = &evaluator.stretches[3].command_m;
            assert!(halves[0].abs() < 1e-9 && halves[1..].iter().all(|c| (c - 0.1).abs() < 1e-9), "{halves:?}");
            let weights = evaluator.stretches.iter().map(|s| s.weight.map(|w| w * s.command_m.len() as f64));
            let total = weights.fold([0.0; 2], |sum, w| [sum[0] + w[0], sum[1] + w[1]]);
            assert!(total.iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{total:?}");
        }
    }
}
