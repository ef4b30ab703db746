//! The integration tests: everything that needs two modules, in one binary.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

mod jobs;
mod models;
mod store_contract;
