//! Local search from a good start.

pub mod multistart;
pub mod simplex;
