//! Numbers that know nothing of valves: lanes, digests, seeded random streams, statistics, and the watch over long work.

pub mod digest;
pub mod lane;
pub mod rng;
pub mod statistics;
pub mod tanh;
pub mod watch;
