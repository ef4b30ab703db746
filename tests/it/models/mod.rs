//! The models against the thesis and against each other.

mod features;
mod friction;
mod invariants;
mod lanes;
mod order;
mod table_6_3;
