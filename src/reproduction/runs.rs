//! The model runs behind every table.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::ReproductionError;
use crate::models::drive::Drive;
use crate::models::fault::Faults;
use crate::models::simulate::{ModelKind, Simulation};
use crate::models::trace::{Channel, Trace};
use crate::numeric::watch::Watch;

/// The recipe of a run without noise.
#[must_use]
pub fn recipe(
    model: ModelKind,
    command: Drive,
    (kgm, fdj_n): (f64, f64),
    duration_s: f64,
    sample_rate_hz: f64,
) -> Simulation {
    let faults = Faults { kgm, fdj_n, ..Faults::default() };
    Simulation::new(model, command, faults, duration_s, sample_rate_hz)
}

/// The samples of a channel, SI.
pub fn values(trace: &Trace, channel: Channel) -> &[f64] {
    trace.channel(channel).expect("a simulated trace has every channel that the thesis plots")
}

/// Does the same to every case, on every core; the results are in the order of the cases, and so is the error that is told.
pub fn each<C: Sync, T: Send>(
    cases: &[C],
    watch: &dyn Watch,
    work: impl Fn(&C, &dyn Watch) -> Result<T, ReproductionError> + Sync,
) -> Result<Vec<T>, ReproductionError> {
    let done = AtomicUsize::new(0);
    let one = |case: &C| {
        let result = work(case, &Quiet(watch));
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        watch.progress(done as f64 / cases.len() as f64);
        result
    };
    cases.par_iter().map(one).collect::<Vec<_>>().into_iter().collect()
}

/// Passes on a wish to end, and keeps one case's progress to itself.
struct Quiet<'a>(&'a dyn Watch);

impl Watch for Quiet<'_> {
    fn progress(&self, _fraction: f64) {}

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::models::simulate::SimulationError;
    use crate::numeric::watch::Stretch;

    struct Kept(Mutex<Vec<f64>>);

    impl Watch for Kept {
        fn progress(&self, fraction: f64) {
            self.0.lock().unwrap().push(fraction);
        }

        fn cancelled(&self) -> bool {
            true
        }
    }

    #[test]
    fn results_are_in_the_order_of_the_cases_and_the_progress_reaches_its_end() {
        let kept = Kept(Mutex::default());
        let half = Stretch { watch: &kept, from: 0.5, to: 1.0 };
        let doubled = each(&[1, 2, 3, 4], &half, |case, quiet| {
            assert!(quiet.cancelled());
            quiet.progress(0.123);
            Ok(2 * case)
        });
        assert_eq!(doubled.unwrap(), [2, 4, 6, 8]);
        let mut progress = kept.0.into_inner().unwrap();
        progress.sort_by(f64::total_cmp);
        assert_eq!(progress, [0.625, 0.75, 0.875, 1.0]);
    }

    #[test]
    fn the_first_case_that_failed_is_told() {
        let kept = Kept(Mutex::default());
        let failed = each(&[1.0, 2.0, 3.0], &kept, |&time_s, _| {
            if time_s > 1.0 { Err(SimulationError::Diverged { time_s }.into()) } else { Ok(()) }
        });
        assert_eq!(failed, Err(SimulationError::Diverged { time_s: 2.0 }.into()));
    }
}
