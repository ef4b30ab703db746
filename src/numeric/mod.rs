//! Numbers that know nothing of valves: lanes, seeded random streams, statistics, and the watch over long work.

pub mod watch;
