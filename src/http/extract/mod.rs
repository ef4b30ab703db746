//! From a request to checked values. What cannot be read is 400, what is out of its range 422; every fault names its
//! place, and all faults of a query are told at once.

pub mod accept;
pub mod body;
pub mod id;
pub mod json;
pub mod query;
pub mod time;
