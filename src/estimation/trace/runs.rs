//! Candidates through the monitoring model over a whole trace, many in lock-step.

use pulp::{Arch, Simd, WithSimd};

use super::observed::{CHANNELS, Observations, TIME_STEP_S};
use crate::models::fault::Faults;
use crate::models::monitoring::large_step::LargeStep;
use crate::models::monitoring::wear::Worn;
use crate::models::monitoring::{Candidate, Model, State};
use crate::models::parameters::ParameterSet;
use crate::numeric::lane::{Both, Lane, Lanes, Register};

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
    wear: crate::models::monitoring::wear::Params,
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
        let mut shown = Vec::new();
        for part in faults.chunks(LANES_KEPT) {
            let mut keeper = Keeper { shown: vec![Shown::default(); part.len()] };
            self.arch.dispatch(Batch { runs: self, faults: part, keeper: &mut keeper });
            shown.extend(keeper.shown);
        }
        shown
    }

    /// The weighted sum of squared differences of each candidate; not finite where a run diverged.
    #[must_use]
    pub fn costs(&self, faults: &[Faults], wanted: &Wanted) -> Vec<f64> {
        self.arch.dispatch(Costs { runs: self, faults, wanted })
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

/// The most candidates that are kept at once.
const LANES_KEPT: usize = 16;

/// Keeps everything.
struct Keeper {
    shown: Vec<Shown>,
}

impl<L: Lanes> Keep<L> for &mut Keeper {
    #[inline(always)]
    fn keep(&mut self, _: usize, shown: [L; CHANNELS.len()]) {
        let mut numbers = [0.0; LANES_KEPT];
        let count = self.shown.len();
        for (channel, values) in shown.into_iter().enumerate() {
            values.store(&mut numbers[..count]);
            for (run, number) in self.shown.iter_mut().zip(numbers) {
                run[channel].push(number);
            }
        }
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

/// Candidates whose runs are kept, for whatever instruction set the machine has.
struct Batch<'a, 'b> {
    runs: &'a Runs<'a>,
    faults: &'a [Faults],
    keeper: &'b mut Keeper,
}

impl WithSimd for Batch<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        // At least LANES_KEPT numbers for any instruction set.
        match LANES_KEPT.div_ceil(S::F64_LANES) {
            1 | 2 => self.runs.run::<Two<S>, _>(simd, self.faults, &mut self.keeper),
            3 | 4 => self.runs.run::<Both<Two<S>, Two<S>>, _>(simd, self.faults, &mut self.keeper),
            5..=8 => self.runs.run::<Both<Both<Two<S>, Two<S>>, Both<Two<S>, Two<S>>>, _>(
                simd,
                self.faults,
                &mut self.keeper,
            ),
            _ => {
                let mut all = Vec::new();
                for one in self.faults {
                    let mut keeper = Keeper { shown: vec![Shown::default()] };
                    self.runs.run::<Register<S>, _>(simd, std::slice::from_ref(one), &mut &mut keeper);
                    all.append(&mut keeper.shown);
                }
                self.keeper.shown = all;
            }
        }
    }
}

/// Candidates whose costs are wanted.
struct Costs<'a> {
    runs: &'a Runs<'a>,
    faults: &'a [Faults],
    wanted: &'a Wanted,
}

impl WithSimd for Costs<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let mut costs = vec![0.0; self.faults.len()];
        let mut rest = self.faults;
        let mut done = 0;
        while !rest.is_empty() {
            let registers = rest.len().div_ceil(S::F64_LANES);
            let width = if registers == 1 {
                S::F64_LANES
            } else if registers == 2 {
                2 * S::F64_LANES
            } else {
                4 * S::F64_LANES
            };
            let (now, later) = rest.split_at(rest.len().min(width));
            let out = &mut costs[done..done + now.len()];
            match registers {
                1 => sum::<Register<S>>(simd, self.runs, now, self.wanted, out),
                2 => sum::<Two<S>>(simd, self.runs, now, self.wanted, out),
                _ => sum::<Both<Two<S>, Two<S>>>(simd, self.runs, now, self.wanted, out),
            }
            done += now.len();
            rest = later;
        }
        costs
    }
}

/// Two registers side by side.
type Two<S> = Both<Register<S>, Register<S>>;

#[inline(always)]
fn sum<L: Lanes>(token: L::Token, runs: &Runs<'_>, faults: &[Faults], wanted: &Wanted, costs: &mut [f64]) {
    let mut sum = Sum { wanted, cost: L::splat(token, 0.0) };
    runs.run::<L, _>(token, faults, &mut sum);
    sum.cost.store(costs);
}
