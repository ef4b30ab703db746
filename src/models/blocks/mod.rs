//! Blocks that both models are built from.

pub mod controller;
pub mod end_stop;
pub mod friction;
pub mod jack;
pub mod torque_motor;

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
