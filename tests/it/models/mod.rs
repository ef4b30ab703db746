//! The models against the thesis and against each other.

mod curves;
mod faults;
mod features;
mod fit;
mod fluids;
mod friction;
mod independent;
mod invariants;
mod lanes;
mod order;
mod switches;
mod table_6_3;
