//! The actuator: a detailed reference model, a fast monitoring model, what drives them and what they record.

pub mod blocks;
pub mod checks;
pub mod drive;
pub mod fault;
pub mod monitoring;
pub mod parameters;
pub mod reference;
pub mod signal;
pub mod simulate;
pub mod trace;
