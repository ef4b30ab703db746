//! What acts on a model during a run, step by step.

use super::{Quantity, Simulation};
use crate::models::blocks::Input;
use crate::models::parameters::ParameterSet;

/// The inputs of a run.
pub(super) struct Inputs<'a> {
    recipe: &'a Simulation,
    return_pressure_pa: f64,
    supply_differential_pa: f64,
}

impl<'a> Inputs<'a> {
    /// The inputs that a recipe asks for.
    pub fn new(recipe: &'a Simulation, set: &ParameterSet) -> Self {
        let fluid = &set.reference_model().fluid;
        Self {
            recipe,
            return_pressure_pa: fluid.return_pressure_pa,
            supply_differential_pa: fluid.supply_pressure_pa - fluid.return_pressure_pa,
        }
    }

    /// What acts at a time, s, with this interference, A.
    #[inline(always)]
    pub fn at(&self, time_s: f64, interference_a: f64) -> Input {
        let Simulation { command, duration_s, external_load_n, supply_pressure_pa, .. } = self.recipe;
        let supply_factor = |pa: &Quantity| (pa.at(time_s) - self.return_pressure_pa) / self.supply_differential_pa;
        Input {
            position_command_m: command.position_m(time_s, *duration_s),
            interference_a,
            external_load_n: external_load_n.as_ref().map_or(0.0, |load| load.at(time_s)),
            supply_factor: supply_pressure_pa.as_ref().map_or(1.0, supply_factor),
        }
    }
}
