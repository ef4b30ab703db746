//! From steps to a trace.

use std::collections::BTreeMap;

use super::Simulation;
use super::plant::Sample;
use crate::models::trace::{Channel, Trace};

/// Keeps the samples that are due.
pub(super) struct Recorder {
    rate_hz: f64,
    samples: usize,
    time_s: Vec<f64>,
    position_command_m: Vec<f64>,
    values: [Vec<f64>; 8],
}

impl Recorder {
    pub fn new(recipe: &Simulation) -> Self {
        // The tolerance keeps the last sample of a duration that is a whole number of samples.
        let samples = (recipe.duration_s * recipe.sample_rate_hz + 1e-9).floor() as usize + 1;
        let column = || Vec::with_capacity(samples);
        Self {
            rate_hz: recipe.sample_rate_hz,
            samples,
            time_s: column(),
            position_command_m: column(),
            values: std::array::from_fn(|_| column()),
        }
    }

    /// The step after which the next sample is due, or `None` when all are recorded.
    pub fn next_step(&self, steps_per_s: f64) -> Option<u64> {
        let k = self.time_s.len();
        (k < self.samples).then(|| (k as f64 / self.rate_hz * steps_per_s).round() as u64)
    }

    pub fn fraction(&self) -> f64 {
        self.time_s.len() as f64 / self.samples as f64
    }

    pub fn record(&mut self, position_command_m: f64, sample: &Sample) {
        self.time_s.push(self.time_s.len() as f64 / self.rate_hz);
        self.position_command_m.push(position_command_m);
        for (column, value) in self.values.iter_mut().zip(sample) {
            column.push(*value);
        }
    }

    pub fn finish(self, extra: &[&str]) -> Trace {
        let [current, pressure, position, velocity, spool, rest @ ..] = self.values;
        let channels = BTreeMap::from([
            (Channel::PositionCommand, self.position_command_m),
            (Channel::ServovalveCurrent, current),
            (Channel::LoadPressure, pressure),
            (Channel::JackPosition, position),
            (Channel::JackVelocity, velocity),
            (Channel::SpoolPosition, spool),
        ]);
        let extra = extra.iter().map(|name| (*name).to_owned()).zip(rest).collect();
        Trace::try_new(self.time_s, channels, extra).expect("the recorder makes even, finite, complete columns")
    }
}
