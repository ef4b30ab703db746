//! The models against the thesis and against each other.

mod features;
mod lanes;
mod table_6_3;
