//! What comes in and goes out beside the records themselves: request bodies, queries, and answers made of several
//! records.

pub mod accepted;
pub mod actuator;
pub mod alert;
pub mod baseline;
pub mod check;
pub mod estimation;
pub mod fleet;
pub mod list;
pub mod maintenance;
pub mod parameter_set;
pub mod simulation;
pub mod trace;
pub mod trend;
pub mod upload;
pub mod webhook;
