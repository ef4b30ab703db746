//! Blocks that both models are built from.

pub mod backlash;
pub mod controller;
pub mod dead_zone;
pub mod end_stop;
pub mod friction;
pub mod hysteresis;
pub mod jack;
pub mod quantizer;
pub mod torque_motor;

/// What acts on a model during one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Position command, m.
    #[doc(alias = "Com")]
    pub position_command_m: f64,
    /// Interference added to the torque motor's current, A. Reference model only.
    pub interference_a: f64,
    /// External load beside the parameter set's constant one, N.
    pub external_load_n: f64,
    /// Supply minus return pressure over the parameter set's, dimensionless: 1 unless the supply varies.
    #[doc(alias = "PSR")]
    pub supply_factor: f64,
}

impl Input {
    /// A command, with the load and the supply that the parameter set says and no interference.
    #[must_use]
    pub const fn command(position_command_m: f64) -> Self {
        Self { position_command_m, interference_a: 0.0, external_load_n: 0.0, supply_factor: 1.0 }
    }
}

/// The parameters that both models have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shared {
    /// The position controller.
    pub controller: controller::Params,
    /// The torque motor.
    pub torque_motor: torque_motor::Params,
    /// The jack.
    pub jack: jack::Params,
}
