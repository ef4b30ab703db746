//! How far the monitoring model is from the reference model around a candidate, under the recorded command: a local bias surface,
//! linear in the faults, learnt from runs of both models at levels to either side of the candidate.

use rand::Rng;
use rayon::prelude::*;

use super::observed::{CHANNELS, Observations};
use super::runs::{Runs, Shown};
use crate::estimation::request::Fault;
use crate::models::drive::Drive;
use crate::models::fault::Faults;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, Quantity, Simulation, SimulationError, simulate};
use crate::models::trace::{Channel, Trace};
use crate::numeric::rng::Seed;
use crate::numeric::watch::Watch;

/// Blocks to either side over which the surface's own error is smoothed.
const SMOOTH_BLOCKS: usize = 2;
/// The same for what noise moves, of which a few runs are a small sample.
const NOISE_SMOOTH_BLOCKS: usize = 20;

/// Runs of the reference model with noise.
const DRAWS: u64 = 6;
/// The part of the current's scale from which noise counts.
const NOISE_MIN: f64 = 1e-3;

/// How far to either side of a candidate the levels lie.
#[must_use]
pub fn spacing(fault: Fault, value: f64) -> f64 {
    match fault {
        Fault::Kgm => 0.04,
        Fault::Fdj => 0.08 * value,
        Fault::Clearance => 4e-6,
        Fault::Clogging => 0.05,
        Fault::FeedbackBacklash => 1e-6,
        Fault::CurrentOffset => 1e-4,
    }
}

/// A local bias surface.
#[derive(Debug)]
pub struct Surface {
    /// The middle of the levels.
    centre: Faults,
    /// The faults that vary.
    faults: Vec<Fault>,
    /// The difference of the models at the centre.
    middle: Shown,
    /// Its slope by each fault.
    slopes: Vec<Shown>,
    /// How well the surface is known, bin by bin: one standard deviation.
    pub spread: Shown,
    /// The differences that this was taken from, each a sample of the surface's error.
    pub errors: Vec<Shown>,
}

impl Surface {
    /// Learns the surface around a candidate.
    ///
    /// # Errors
    /// The reference model diverged, or the watch asked for an end.
    pub fn learn(
        around: &Faults,
        faults: &[Fault],
        runs: &Runs<'_>,
        observations: &Observations,
        set: &ParameterSet,
        watch: &dyn Watch,
    ) -> Result<Self, SimulationError> {
        let mut centre = *around;
        let mut levels = Vec::new();
        let mut widths = Vec::new();
        for fault in faults {
            let (low, high) = fault.range();
            let width = spacing(*fault, fault.of(around));
            *fault.of_mut(&mut centre) = fault.of(around).clamp(low + width, high - width);
            widths.push(width);
        }
        for (fault, width) in faults.iter().zip(&widths) {
            for side in [-1.0, 1.0] {
                let mut level = centre;
                *fault.of_mut(&mut level) += side * width;
                levels.push(level);
            }
        }
        let reference: Vec<Trace> = levels
            .par_iter()
            .map(|level| simulate(&recipe(observations, *level), set, watch))
            .collect::<Result<_, _>>()?;
        let monitoring = runs.shown(&levels);
        let differences: Vec<Shown> =
            reference.iter().zip(&monitoring).map(|(r, m)| difference(r, m, observations)).collect();
        let mean = |shown: &[&Shown]| -> Shown {
            std::array::from_fn(|channel| {
                let bins = observations.blocks();
                let sum = |bin: usize| shown.iter().map(|one| one[channel][bin]).sum::<f64>();
                (0..bins).map(|bin| sum(bin) / shown.len() as f64).collect()
            })
        };
        let middle = mean(&differences.iter().collect::<Vec<_>>());
        let slopes = differences
            .chunks_exact(2)
            .zip(&widths)
            .map(|(pair, width)| {
                std::array::from_fn(|channel| {
                    pair[1][channel]
                        .iter()
                        .zip(&pair[0][channel])
                        .map(|(high, low)| (high - low) / (2.0 * width))
                        .collect()
                })
            })
            .collect();
        // Each pair's mean is the middle once more; what they differ by is bend and chance.
        let middles: Vec<Shown> = differences.chunks_exact(2).map(|pair| mean(&[&pair[0], &pair[1]])).collect();
        let scale = (middles.len() as f64 / (middles.len().max(2) - 1) as f64).sqrt();
        let errors: Vec<Shown> = middles
            .iter()
            .map(|one| {
                std::array::from_fn(|channel| {
                    one[channel].iter().zip(&middle[channel]).map(|(one, middle)| scale * (one - middle)).collect()
                })
            })
            .collect();
        let spread = std::array::from_fn(|channel| {
            let square = |bin: usize| errors.iter().map(|error| error[channel][bin].powi(2)).sum::<f64>();
            let squares = (0..observations.blocks()).map(|bin| square(bin) / errors.len() as f64);
            smooth_root(&squares.collect::<Vec<_>>(), SMOOTH_BLOCKS)
        });
        Ok(Self { centre, faults: faults.to_vec(), middle, slopes, spread, errors })
    }

    /// The surface's difference at a candidate, added to what the monitoring model shows.
    pub fn correct(&self, at: &Faults, shown: &mut Shown) {
        let off: Vec<f64> = self.faults.iter().map(|fault| fault.of(at) - fault.of(&self.centre)).collect();
        for (channel, values) in shown.iter_mut().enumerate() {
            for (bin, value) in values.iter_mut().enumerate() {
                *value += self.middle[channel][bin];
                for (slope, off) in self.slopes.iter().zip(&off) {
                    *value += slope[channel][bin] * off;
                }
            }
        }
    }
}

/// What noise in the current moves of the other channels inside the loop: what the reference model shows with the noise that the
/// current has, less what it shows without.
///
/// # Errors
/// The reference model diverged, or the watch asked for an end.
pub fn feel_noise(
    observations: &mut Observations,
    at: &Faults,
    set: &ParameterSet,
    seed: u64,
    watch: &dyn Watch,
) -> Result<(), SimulationError> {
    let current = observations.binned.iter().find(|channel| channel.channel == Channel::ServovalveCurrent);
    let Some(current) = current.filter(|current| current.noise > NOISE_MIN * current.scale) else { return Ok(()) };
    let own = set.reference_model();
    let held_s = own.torque_motor.interference_sample_time_s.max(own.time_step_s);
    let noise_power_ma2_s = ((1e3 * current.noise).powi(2) * held_s).min(1.0);
    let quiet = recipe(observations, *at);
    // Not the seed itself: a trace that was simulated with it has that very noise.
    let noisy = |draw| Simulation {
        noise_power_ma2_s,
        seed: Seed(seed).stream("noise inside the loop", draw).next_u64(),
        ..quiet.clone()
    };
    let recipes: Vec<Simulation> = std::iter::once(quiet.clone()).chain((0..DRAWS).map(noisy)).collect();
    let runs: Vec<Trace> = recipes.par_iter().map(|recipe| simulate(recipe, set, watch)).collect::<Result<_, _>>()?;
    for place in 0..observations.channels.len() {
        let which = observations.channels[place].channel;
        let values = |run: usize| runs[run].channel(which).expect("a simulated trace has every channel");
        let draws: Vec<Vec<f64>> = (1..runs.len())
            .map(|run| {
                let off: Vec<f64> = values(run).iter().zip(values(0)).map(|(noisy, quiet)| noisy - quiet).collect();
                observations.means(&off)
            })
            .collect();
        let blocks = observations.blocks();
        let channel = &mut observations.channels[place];
        // The current's own noise is known already.
        if channel.channel != Channel::ServovalveCurrent {
            let square = |block: usize| draws.iter().map(|draw| draw[block].powi(2)).sum::<f64>() / DRAWS as f64;
            channel.moved = smooth_root(&(0..blocks).map(square).collect::<Vec<_>>(), NOISE_SMOOTH_BLOCKS);
        }
        channel.draws = draws;
    }
    Ok(())
}

fn recipe(observations: &Observations, faults: Faults) -> Simulation {
    let duration_s = (observations.bins - 1) as f64 * observations.bin_s;
    let command = Drive::Recorded(observations.command.clone());
    Simulation {
        external_load_n: observations.load_n.clone().map(Quantity::Recorded),
        supply_pressure_pa: observations.supply_pa.clone().map(Quantity::Recorded),
        start_position_m: observations.start_m,
        ..Simulation::new(ModelKind::Reference, command, faults, duration_s, 1.0 / observations.bin_s)
    }
}

/// The means over blocks of the reference model less the monitoring model.
fn difference(reference: &Trace, monitoring: &Shown, observations: &Observations) -> Shown {
    std::array::from_fn(|place| {
        let values = reference.channel(CHANNELS[place]).expect("a simulated trace has every channel");
        let off: Vec<f64> = values.iter().zip(&monitoring[place]).map(|(r, m)| r - m).collect();
        observations.means(&off)
    })
}

/// The root of the means over neighbours.
fn smooth_root(squares: &[f64], reach: usize) -> Vec<f64> {
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(squares.iter().scan(0.0, |sum, square| {
            *sum += square;
            Some(*sum)
        }))
        .collect();
    (0..squares.len())
        .map(|bin| {
            let (low, high) = (bin.saturating_sub(reach), (bin + reach + 1).min(squares.len()));
            ((sums[high] - sums[low]).max(0.0) / (high - low) as f64).sqrt()
        })
        .collect()
}
