//! What acts on a model during a run, step by step.

use super::{Quantity, Simulation, SimulationError};
use crate::models::blocks::Input;
use crate::models::parameters::ParameterSet;

/// The most supply pressure over the parameter set's: what the parameters' own checks of the time step allow for.
const SUPPLY_FACTOR_MAX: f64 = 2.0;

/// The inputs of a run.
pub(super) struct Inputs<'a> {
    recipe: &'a Simulation,
    return_pressure_pa: f64,
    supply_differential_pa: f64,
}

impl<'a> Inputs<'a> {
    /// The inputs that a recipe asks for.
    ///
    /// # Errors
    /// A supply pressure that the parameter set does not allow.
    pub fn new(recipe: &'a Simulation, set: &ParameterSet) -> Result<Self, SimulationError> {
        let fluid = &set.reference_model().fluid;
        let supply_max_pa = SUPPLY_FACTOR_MAX * fluid.supply_pressure_pa;
        if let Some((_, found)) = recipe.supply_pressure_pa.as_ref().map(Quantity::range)
            && found > supply_max_pa
        {
            return Err(SimulationError::Supply { found, max: supply_max_pa });
        }
        Ok(Self {
            recipe,
            return_pressure_pa: fluid.return_pressure_pa,
            supply_differential_pa: fluid.supply_pressure_pa - fluid.return_pressure_pa,
        })
    }

    /// What acts at a time, s, with this interference, A.
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
