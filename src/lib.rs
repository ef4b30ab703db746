//! elevon: prognostic health monitoring of electro-hydraulic flight-control actuators.
//!
//! A trace goes in (command, servovalve current, load pressure), the faults that grow in the actuator and its
//! remaining useful life come out. The layers, from the inside out: [`numeric`] and [`units`]; [`models`] of the
//! actuator; [`optimiser`], [`estimation`] and [`characterisation`]; [`prognostics`]; [`reproduction`] of the thesis;
//! [`formats`]; [`store`], [`jobs`], [`webhooks`], [`http`] and the commands in [`cli`]. Dependencies point inward only
//! (`docs/architecture.md`).
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test that cannot go on should panic"))]

pub mod app;
pub mod characterisation;
pub mod cli;
pub mod config;
pub mod estimation;
pub mod formats;
pub mod http;
pub mod jobs;
pub mod models;
pub mod numeric;
pub mod optimiser;
pub mod prognostics;
pub mod reproduction;
pub mod store;
pub mod telemetry;
pub mod units;
pub mod webhooks;

/// The version that made a result; it travels with every result.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
