//! The actuator: a detailed reference model, a fast monitoring model, what drives them and what they record.

pub mod drive;
pub mod fault;
pub mod parameters;
pub mod simulate;
pub mod trace;
