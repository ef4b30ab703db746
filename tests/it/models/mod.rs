//! The models against the thesis and against each other.

mod curves;
mod faults;
mod features;
mod fine;
mod fit;
mod fluids;
mod friction;
mod independent;
mod invariants;
mod lanes;
mod order;
mod switches;
mod table_6_3;

use proptest::test_runner::{Config, RngSeed};

/// Properties over this many cases, the same on every run.
fn cases(cases: u32) -> Config {
    Config { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..Config::default() }
}
