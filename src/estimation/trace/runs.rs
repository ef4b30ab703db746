//! Candidates through the monitoring model over a whole trace, many in lock-step.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::observed::{CHANNELS, Observations, TIME_STEP_S};
use crate::models::fault::Faults;
use crate::models::monitoring::large_step::LargeStep;
use crate::models::monitoring::wear::{self, Worn};
use crate::models::monitoring::{Candidate, Model, State};
use crate::models::parameters::ParameterSet;
use crate::numeric::lane::{Lane, LaneWork, Lanes, NUMBERS_MAX, in_registers};

/// What a run shows: for each channel of [`CHANNELS`], its value in each bin.
pub type Shown = [Vec<f64>; CHANNELS.len()];

/// What a run is compared with: for each channel, its value in each bin and the weight of a difference, squared; weight zero where it
/// tells nothing.
pub type Wanted = [Vec<(f64, f64)>; CHANNELS.len()];

/// One trace's inputs, ready to drive any number of candidates.
#[derive(Debug)]
pub struct Runs<'a> {
    observations: &'a Observations,
    model: LargeStep,
    wear: wear::Params,
    arch: Arch,
}

impl<'a> Runs<'a> {
    /// Prepares the runs.
    #[must_use]
    pub fn new(observations: &'a Observations, set: &ParameterSet) -> Self {
        let own = set.monitoring_model();
        let model = LargeStep::new(&Model::new(&set.shared(), own), TIME_STEP_S);
        Self { observations, model, wear: own.wear, arch: Arch::new() }
    }

    /// What each candidate shows.
    #[must_use]
    pub fn shown(&self, faults: &[Faults]) -> Vec<Shown> {
        self.arch
            .dispatch(Batch { runs: self, faults, work: Keeper { shown: vec![Shown::default(); faults.len()] } })
            .shown
    }

    /// The weighted sum of squared differences of each candidate; not finite where a run diverged.
    #[must_use]
    pub fn costs(&self, faults: &[Faults], wanted: &Wanted) -> Vec<f64> {
        self.arch.dispatch(Batch { runs: self, faults, work: Costs { wanted, costs: Vec::new() } }).costs
    }

    /// Runs as many candidates as a lane holds. What is recorded of a bin is what the reference model records at its middle: the
    /// current that the command of that moment makes, and the state that it meets.
    #[inline(always)]
    fn run<L: Lanes, K: Keep<L>>(&self, token: L::Token, faults: &[Faults], keep: &mut K) {
        let candidate = self.candidate::<L>(token, faults);
        let mut state = State::<L>::start(token, self.observations.start_m);
        let steps = self.observations.steps_per_bin;
        for (bin, inputs) in self.observations.inputs.chunks_exact(steps).enumerate() {
            let before = state;
            for (step, input) in inputs.iter().enumerate() {
                state = self.model.step_worn(&candidate, &state, input);
                if step == 0 {
                    let current_a = state.servovalve_current_a;
                    keep.keep(
                        bin,
                        [current_a, before.load_pressure_pa, before.jack_position_m, before.spool_position_m],
                    );
                }
            }
        }
    }

    #[inline(always)]
    fn candidate<L: Lanes>(&self, token: L::Token, faults: &[Faults]) -> Candidate<L, Worn<L>> {
        let kgm: Vec<f64> = faults.iter().map(|faults| faults.kgm).collect();
        let fdj_n: Vec<f64> = faults.iter().map(|faults| faults.fdj_n).collect();
        let worn = Worn::load(token, &self.wear, faults);
        self.model.model().worn_candidate(L::load(token, &kgm), L::load(token, &fdj_n), worn)
    }
}

/// What is done with what a bin shows.
trait Keep<L> {
    fn keep(&mut self, bin: usize, shown: [L; CHANNELS.len()]);
}

/// A batch's work: what is done with the runs of some of its candidates.
trait Work {
    fn on<L: Lanes>(&mut self, token: L::Token, runs: &Runs<'_>, faults: &[Faults], places: Range<usize>);
}

/// Keeps everything.
struct Keeper {
    shown: Vec<Shown>,
}

impl Work for Keeper {
    #[inline(always)]
    fn on<L: Lanes>(&mut self, token: L::Token, runs: &Runs<'_>, faults: &[Faults], places: Range<usize>) {
        runs.run::<L, _>(token, faults, &mut Kept { shown: &mut self.shown[places] });
    }
}

/// The part of what is kept that one lane makes.
struct Kept<'a> {
    shown: &'a mut [Shown],
}

impl<L: Lanes> Keep<L> for Kept<'_> {
    #[inline(always)]
    fn keep(&mut self, _: usize, shown: [L; CHANNELS.len()]) {
        let mut numbers = [0.0; NUMBERS_MAX];
        let count = self.shown.len();
        for (channel, values) in shown.into_iter().enumerate() {
            values.store(&mut numbers[..count]);
            for (run, number) in self.shown.iter_mut().zip(numbers) {
                run[channel].push(number);
            }
        }
    }
}

/// Finds the costs.
struct Costs<'a> {
    wanted: &'a Wanted,
    costs: Vec<f64>,
}

impl Work for Costs<'_> {
    #[inline(always)]
    fn on<L: Lanes>(&mut self, token: L::Token, runs: &Runs<'_>, faults: &[Faults], places: Range<usize>) {
        let mut sum = Sum { wanted: self.wanted, cost: L::splat(token, 0.0) };
        runs.run::<L, _>(token, faults, &mut sum);
        self.costs.resize(places.end, 0.0);
        sum.cost.store(&mut self.costs[places]);
    }
}

/// Sums up the cost.
struct Sum<'a, L> {
    wanted: &'a Wanted,
    cost: L,
}

impl<L: Lane> Keep<L> for Sum<'_, L> {
    #[inline(always)]
    fn keep(&mut self, bin: usize, shown: [L; CHANNELS.len()]) {
        for (values, wanted) in shown.into_iter().zip(self.wanted) {
            if let Some(&(value, weight)) = wanted.get(bin) {
                let off = values - values.same(value);
                self.cost = self.cost + off * off * weight;
            }
        }
    }
}

/// Candidates and a work on them, for whatever instruction set the machine has.
struct Batch<'a, W> {
    runs: &'a Runs<'a>,
    faults: &'a [Faults],
    work: W,
}

impl<W: Work> WithSimd for Batch<'_, W> {
    type Output = W;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> W {
        in_registers(simd, self.faults.len(), &mut self);
        self.work
    }
}

impl<W: Work> LaneWork for Batch<'_, W> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, token: L::Token, places: Range<usize>) {
        let faults = &self.faults[places.clone()];
        self.work.on::<L>(token, self.runs, faults, places);
    }
}
