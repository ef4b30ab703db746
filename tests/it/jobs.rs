//! Jobs from their upload to what they leave in the store. The tests are the workers: each drives single steps.

mod alerts;
mod bench;
mod dispatch;
mod fleets;
mod forecasts;
mod interrupted;
mod outcomes;
mod sets;
mod traces;
