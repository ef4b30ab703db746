//! The models against the thesis and against each other.

mod curves;
mod features;
mod fluids;
mod lanes;
mod table_6_3;
