//! Blocks that both models are built from.

pub mod controller;
pub mod end_stop;
pub mod friction;
pub mod jack;
pub mod torque_motor;
