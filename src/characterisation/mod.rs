//! What characterises a valve and its simplified models: characteristic curves, gains, settling times, and the fit of the
//! monitoring model to the reference model.
//!
//! Source: sections 3.2, 4.1.3 and chapter 5 of the thesis.
//! Everything here is pure computation on a parameter set.

pub mod bias;
pub mod curves;
pub mod derived;
pub mod diagnostic;
pub mod fit;
pub mod report;
pub mod settling;
pub mod valve;
