//! What a trace says, on an even grid of bins: the inputs that drive a model and the channels that it must reproduce.

use crate::models::blocks::Input;
use crate::models::parameters::ParameterSet;
use crate::models::signal::Signal;
use crate::models::trace::{Channel, Trace};

/// The channels that a model reproduces.
pub const CHANNELS: [Channel; 4] =
    [Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition, Channel::SpoolPosition];
/// The time step of the monitoring model, s.
pub const TIME_STEP_S: f64 = crate::models::monitoring::large_step::TIME_STEP_MAX_S;
/// A bin that begins this long after the command's last change and in which the jack no longer moves tells nothing.
const REST_M_PER_S: f64 = 1e-4;
/// The time over which the jack's motion is looked at, s.
const REST_WINDOW_S: f64 = 0.05;
/// The length of a block, s.
const FIT_BLOCK_S: f64 = 0.02;
/// How many times its noise a channel may leave beside.
const NOISE_MARGIN: f64 = 1.5;
/// The time over which differences are averaged before they are judged, s.
const BLOCK_S: f64 = 0.05;
/// How long the run starts before the command's first change, s.
const LEAD_S: f64 = 0.05;
/// A current this close to the motor's limit, as a part of it, is saturated.
const SATURATED: f64 = 0.995;
/// The median of |x| over the standard deviation, for normal x; and what a second difference adds up of three samples.
const MEDIAN_TO_STD: f64 = 0.6745;
const SECOND_DIFFERENCE: f64 = 2.449_489_742_783_178;

/// One channel of a trace.
#[derive(Debug, Clone)]
pub struct Observed {
    /// Which.
    pub channel: Channel,
    /// Its place in [`CHANNELS`].
    pub place: usize,
    /// Its mean in each bin.
    pub values: Vec<f64>,
    /// Whether a bin tells anything of this channel.
    pub informative: Vec<bool>,
    /// Standard deviation of its noise in a bin.
    pub noise: f64,
    /// Standard deviation of what noise in the current moves of it inside the loop, bin by bin.
    pub moved: Vec<f64>,
    /// What noise in the current moved of it in some runs, bin by bin.
    pub draws: Vec<Vec<f64>>,
    /// Standard deviation of its informative values: the measure of what a model must explain.
    pub scale: f64,
}

impl Observed {
    /// The mean square of a difference's means over blocks in which this channel is informative, but for the largest tenth: a jack
    /// that sticks a moment earlier or later leaves much in a few.
    #[must_use]
    pub fn block_mean_square(&self, difference: &[f64], bin_s: f64) -> f64 {
        let block = block(bin_s);
        let mut squares = Vec::new();
        for (difference, told) in difference.chunks(block).zip(self.informative.chunks(block)) {
            let told: Vec<f64> = difference.iter().zip(told).filter(|(_, told)| **told).map(|(d, _)| *d).collect();
            if 2 * told.len() > block {
                squares.push((told.iter().sum::<f64>() / told.len() as f64).powi(2));
            }
        }
        squares.sort_unstable_by(f64::total_cmp);
        squares.truncate((squares.len() * 9).div_ceil(10));
        squares.iter().sum::<f64>() / squares.len().max(1) as f64
    }

    /// The part of the scale that a difference's means over blocks leave beside a mean square that was expected of them.
    #[must_use]
    pub fn left(&self, difference: &[f64], expected_mean_square: f64, bin_s: f64) -> f64 {
        let expected = NOISE_MARGIN * NOISE_MARGIN * expected_mean_square;
        (self.block_mean_square(difference, bin_s) - expected).max(0.0).sqrt() / self.scale
    }

    /// The mean square that its white noise leaves in the means over blocks.
    #[must_use]
    pub fn noise_mean_square(&self, bin_s: f64) -> f64 {
        self.noise * self.noise / block(bin_s) as f64
    }
}

/// The bins of a block.
fn block(bin_s: f64) -> usize {
    (BLOCK_S / bin_s).ceil() as usize
}

/// A trace on its grid.
#[derive(Debug, Clone)]
pub struct Observations {
    /// Time step of a bin, s.
    pub bin_s: f64,
    /// Time steps of the monitoring model in a bin.
    pub steps_per_bin: usize,
    /// Bins.
    pub bins: usize,
    /// Bins in a block: what is fitted in the end is the mean over a block, in which the stick and slip of a jack averages out.
    pub bins_per_block: usize,
    /// What acts at every time step of the monitoring model.
    pub inputs: Vec<Input>,
    /// The command, for the reference model.
    pub command: Signal,
    /// The recorded external load, N.
    pub load_n: Option<Signal>,
    /// The recorded supply pressure, Pa.
    pub supply_pa: Option<Signal>,
    /// Where the jack is at the start, m.
    pub start_m: f64,
    /// The recorded channels, bin by bin.
    pub binned: Vec<Observed>,
    /// The recorded channels, block by block.
    pub channels: Vec<Observed>,
}

impl Observations {
    /// A trace from just before its first motion to its last bin that tells anything.
    ///
    /// # Errors
    /// Why nothing can be told from it.
    pub fn new(trace: &Trace, set: &ParameterSet) -> Result<Self, String> {
        let all_s = trace.time_s();
        let moving = motion(trace)?;
        let from = all_s.partition_point(|t| *t < all_s[moving.start] - LEAD_S);
        let time_s = &all_s[from..moving.end];
        let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
        let steps_per_bin = (step_s / TIME_STEP_S).round().max(1.0) as usize;
        let bin_s = steps_per_bin as f64 * TIME_STEP_S;
        let bins = ((time_s[time_s.len() - 1] - time_s[0]) / bin_s + 1e-6).floor() as usize + 1;
        let part = |values: &[f64]| values[from..moving.end].to_vec();
        let command = Signal::command(time_s, &part(trace.position_command_m()));
        let signal = |channel| Some(Signal::new(time_s, &part(trace.channel(channel)?), f64::INFINITY));
        let (load_n, supply_pa) = (signal(Channel::ExternalLoad), signal(Channel::SupplyPressure));
        let fluid = &set.reference_model().fluid;
        let differential_pa = fluid.supply_pressure_pa - fluid.return_pressure_pa;
        let inputs = (0..bins * steps_per_bin)
            .map(|step| {
                let at_s = step as f64 * TIME_STEP_S;
                Input {
                    external_load_n: load_n.as_ref().map_or(0.0, |load| load.at(at_s)),
                    supply_factor: supply_pa
                        .as_ref()
                        .map_or(1.0, |supply| (supply.at(at_s) - fluid.return_pressure_pa) / differential_pa),
                    ..Input::command(command.at(at_s))
                }
            })
            .collect();
        let binned = |channel: Channel| trace.channel(channel).map(|values| bin(time_s, &part(values), bin_s, bins));
        let position = binned(Channel::JackPosition);
        let start_m = position.as_ref().map_or(command.at(0.0), |values| values[0]);
        let mut observations = Self {
            bin_s,
            steps_per_bin,
            bins,
            bins_per_block: (FIT_BLOCK_S / bin_s).round().max(1.0) as usize,
            inputs,
            command,
            load_n,
            supply_pa,
            start_m,
            binned: Vec::new(),
            channels: Vec::new(),
        };
        let told = observations.told(position.as_deref());
        let current_max_a = set.shared().torque_motor.current_max_a;
        for (place, channel) in CHANNELS.into_iter().enumerate() {
            let Some(values) = binned(channel) else { continue };
            let limit = if channel == Channel::ServovalveCurrent { SATURATED * current_max_a } else { f64::INFINITY };
            let informative: Vec<bool> = values.iter().zip(&told).map(|(v, told)| *told && v.abs() < limit).collect();
            let noise = noise(&part(trace.channel(channel).expect("it was binned"))) / (bin_s / step_s).max(1.0).sqrt();
            let scale = deviation(&values, &informative);
            observations.binned.push(Observed {
                channel,
                place,
                values,
                informative,
                noise,
                moved: vec![0.0; bins],
                draws: Vec::new(),
                scale,
            });
        }
        observations.channels = observations.binned.iter().map(|channel| observations.in_blocks(channel)).collect();
        Ok(observations)
    }

    /// Time step of a block, s.
    #[must_use]
    pub fn block_s(&self) -> f64 {
        self.bins_per_block as f64 * self.bin_s
    }

    /// Blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.bins.div_ceil(self.bins_per_block)
    }

    /// The means over blocks.
    #[must_use]
    pub fn means(&self, values: &[f64]) -> Vec<f64> {
        values.chunks(self.bins_per_block).map(|block| block.iter().sum::<f64>() / block.len() as f64).collect()
    }

    fn in_blocks(&self, channel: &Observed) -> Observed {
        Observed {
            channel: channel.channel,
            place: channel.place,
            values: self.means(&channel.values),
            informative: channel
                .informative
                .chunks(self.bins_per_block)
                .map(|block| block.iter().all(|told| *told))
                .collect(),
            noise: channel.noise / (self.bins_per_block as f64).sqrt(),
            moved: vec![0.0; self.blocks()],
            draws: Vec::new(),
            scale: channel.scale,
        }
    }

    /// The bins in which the command moves or the jack does.
    fn told(&self, position_m: Option<&[f64]>) -> Vec<bool> {
        let reach = (REST_WINDOW_S / self.bin_s).ceil() as usize;
        let command_m: Vec<f64> =
            (0..self.bins).map(|bin| self.inputs[bin * self.steps_per_bin].position_command_m).collect();
        let moves = |values: &[f64], bin: usize| {
            let (low, high) = (bin.saturating_sub(reach), (bin + reach).min(self.bins - 1));
            (values[high] - values[low]).abs() > REST_M_PER_S * (high - low) as f64 * self.bin_s
        };
        (0..self.bins)
            .map(|bin| moves(&command_m, bin) || position_m.is_none_or(|position| moves(position, bin)))
            .collect()
    }
}

/// The samples from the first change of the command to the last sample.
fn motion(trace: &Trace) -> Result<std::ops::Range<usize>, String> {
    let command_m = trace.position_command_m();
    let first = command_m.iter().position(|m| (m - command_m[0]).abs() > 1e-9);
    let first = first.ok_or("the command does not move: it has no manoeuvre that would show a fault")?;
    Ok(first.saturating_sub(1)..command_m.len())
}

/// The mean of the samples in each bin around its middle; where a bin holds none or one, the straight line between samples.
fn bin(time_s: &[f64], values: &[f64], bin_s: f64, bins: usize) -> Vec<f64> {
    let signal = Signal::new(time_s, values, f64::INFINITY);
    let start_s = time_s[0];
    let (mut low, mut high) = (0, 0);
    (0..bins)
        .map(|bin| {
            let middle_s = bin as f64 * bin_s;
            // The bins rise with the times: each begins its search where the one before ended.
            let after =
                |from: usize, at_s: f64| from + time_s[from..].iter().take_while(|t| *t - start_s < at_s).count();
            low = after(low, middle_s - 0.5 * bin_s);
            high = after(high.max(low), middle_s + 0.5 * bin_s);
            if high >= low + 2 {
                values[low..high].iter().sum::<f64>() / (high - low) as f64
            } else {
                signal.at(middle_s)
            }
        })
        .collect()
}

/// The standard deviation of white noise, from second differences, in which a smooth signal leaves little.
fn noise(values: &[f64]) -> f64 {
    let mut differences: Vec<f64> = values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).collect();
    let middle = differences.len() / 2;
    let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
    median / (MEDIAN_TO_STD * SECOND_DIFFERENCE)
}

/// The standard deviation of the values that are informative.
fn deviation(values: &[f64], informative: &[bool]) -> f64 {
    let told: Vec<f64> = values.iter().zip(informative).filter(|(_, told)| **told).map(|(v, _)| *v).collect();
    let mean = told.iter().sum::<f64>() / told.len().max(1) as f64;
    (told.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / told.len().max(1) as f64).sqrt()
}
