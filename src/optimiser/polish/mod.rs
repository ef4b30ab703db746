//! Local search from a good start.

pub mod simplex;
