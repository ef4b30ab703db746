//! From steps to a trace.

use std::collections::BTreeMap;

use super::Simulation;
use super::plant::Sample;
use crate::models::trace::{Channel, Trace};

/// Keeps the samples that are due.
pub(super) struct Recorder<'a> {
    recipe: &'a Simulation,
    rate_hz: f64,
    samples: usize,
    time_s: Vec<f64>,
    /// The command and, where they were given, the load and the supply, as they acted.
    inputs: [Vec<f64>; 3],
    values: [Vec<f64>; 8],
}

impl<'a> Recorder<'a> {
    pub fn new(recipe: &'a Simulation) -> Self {
        // The tolerance keeps the last sample of a duration that is a whole number of samples.
        let samples = (recipe.duration_s * recipe.sample_rate_hz + 1e-9).floor() as usize + 1;
        let column = || Vec::with_capacity(samples);
        Self {
            recipe,
            rate_hz: recipe.sample_rate_hz,
            samples,
            time_s: column(),
            inputs: std::array::from_fn(|_| column()),
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

    /// Records the state after the step at a time, s.
    pub fn record(&mut self, time_s: f64, sample: &Sample) {
        let Simulation { command, duration_s, external_load_n, supply_pressure_pa, .. } = self.recipe;
        let [command_m, load_n, supply_pa] = &mut self.inputs;
        command_m.push(command.position_m(time_s, *duration_s));
        load_n.extend(external_load_n.as_ref().map(|load| load.at(time_s)));
        supply_pa.extend(supply_pressure_pa.as_ref().map(|supply| supply.at(time_s)));
        self.time_s.push(self.time_s.len() as f64 / self.rate_hz);
        for (column, value) in self.values.iter_mut().zip(sample) {
            column.push(*value);
        }
    }

    pub fn finish(self, extra: &[&str]) -> Trace {
        let [command_m, load_n, supply_pa] = self.inputs;
        let [current, pressure, position, velocity, spool, rest @ ..] = self.values;
        let mut channels = BTreeMap::from([
            (Channel::PositionCommand, command_m),
            (Channel::ServovalveCurrent, current),
            (Channel::LoadPressure, pressure),
            (Channel::JackPosition, position),
            (Channel::JackVelocity, velocity),
            (Channel::SpoolPosition, spool),
            (Channel::ExternalLoad, load_n),
            (Channel::SupplyPressure, supply_pa),
        ]);
        channels.retain(|_, values| !values.is_empty());
        let extra = extra.iter().map(|name| (*name).to_owned()).zip(rest).collect();
        Trace::try_new(self.time_s, channels, extra).expect("the recorder makes even, finite, complete columns")
    }
}
