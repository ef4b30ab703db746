//! What a fit gives: the set with its new values, where each of them comes from, and what the models still differ by.

use serde::Serialize;

use super::diagnostic::{Features, Level};
use crate::models::monitoring::fluid::FluidModel;
use crate::models::parameters::{Parameter, ParameterSet, Value};

/// A fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The set with the fitted monitoring model.
    pub set: ParameterSet,
    /// What is left of the zero-flow pressure curve.
    pub zero_flow: ZeroFlow,
    /// What is left of the features with each fluid: developed, evolved, linear.
    pub fluids: Vec<FluidResiduals>,
}

/// The difference of PSR tanh(XS/XSS) from the reference valve's zero-flow pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ZeroFlow {
    /// Root of the mean square, Pa.
    pub rms_pa: f64,
    /// That over PSR.
    pub rms_of_supply: f64,
    /// The largest, Pa.
    pub worst_pa: f64,
    /// Where that is, m.
    pub worst_at_m: f64,
    /// The curve's reach on both sides of null, m.
    pub reach_m: f64,
}

/// The difference of the features with one fluid from the reference model's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FluidResiduals {
    /// The fluid.
    pub fluid: FluidModel,
    /// Whether its flow gain is the least that the time step can follow, and not the one that fits best.
    pub limited_by_time_step: bool,
    /// Level after level.
    pub levels: Vec<Residual>,
}

/// The difference at one level, monitoring minus reference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Residual {
    /// The faults.
    #[serde(flatten)]
    pub level: Level,
    /// The current feature's, %.
    pub current_percent: f64,
    /// The pressure feature's, %.
    pub pressure_percent: f64,
    /// The pressure feature's, kPa.
    pub pressure_kpa: f64,
}

impl FluidResiduals {
    /// The differences between what the models show.
    #[must_use]
    pub fn new(fluid: FluidModel, limited: bool, levels: &[Level], reference: &[Features], own: &[Features]) -> Self {
        let residual = |((level, reference), own): ((&Level, &Features), &Features)| Residual {
            level: *level,
            current_percent: 100.0 * (own.servovalve_current_a / reference.servovalve_current_a - 1.0),
            pressure_percent: 100.0 * (own.load_pressure_pa / reference.load_pressure_pa - 1.0),
            pressure_kpa: 1e-3 * (own.load_pressure_pa - reference.load_pressure_pa),
        };
        Self {
            fluid,
            limited_by_time_step: limited,
            levels: levels.iter().zip(reference).zip(own).map(residual).collect(),
        }
    }

    /// The largest magnitude of a difference over the levels; NaN where a run diverged.
    #[must_use]
    pub fn worst(&self, of: impl Fn(&Residual) -> f64) -> f64 {
        self.levels.iter().map(|level| of(level).abs()).fold(0.0, |worst, at| if at <= worst { worst } else { at })
    }
}

/// Where a value of the monitoring model comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// By a formula from the reference model's.
    Derived,
    /// Fitted to what the reference model does.
    Fitted,
    /// Measured between the fitted model and the reference model.
    Measured,
    /// What it was.
    Kept,
    /// The built-in set's, where the set had none.
    BuiltIn,
    /// The built-in set's at the same velocity of the jack, where the set had none: in or against proportion to its area.
    BuiltInScaled,
}

/// A parameter of the monitoring model before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// Its name, with its section.
    pub name: String,
    /// Its unit; empty when it has none.
    pub unit: &'static str,
    /// Its value before; `None` where the set had none.
    pub old: Option<f64>,
    /// Its value now.
    pub new: f64,
    /// Where that comes from.
    pub origin: Origin,
}

impl Fitted {
    /// The monitoring model's parameters beside what they were in `before`, where those in `missing` were not.
    #[must_use]
    pub fn changes(&self, before: &ParameterSet, missing: &[String]) -> Vec<Change> {
        changes(before, &self.set, missing)
    }
}

/// The monitoring model's parameters in a set beside what they were in `before`, where those in `missing` were not.
#[must_use]
pub fn changes(before: &ParameterSet, after: &ParameterSet, missing: &[String]) -> Vec<Change> {
    let number = |value: &Value| match value {
        Value::Number(number) => Some(*number),
        Value::Text(_) => None,
    };
    let change = |(old, new): (Parameter, Parameter)| {
        let was = number(&old.value).filter(|_| !missing.contains(&new.name));
        let origin = match origin(&new.name) {
            Origin::Kept if was.is_none() && flow_power(&new.name) != 0 => Origin::BuiltInScaled,
            Origin::Kept if was.is_none() => Origin::BuiltIn,
            origin => origin,
        };
        let unit = new.limits.map_or("", |limits| limits.unit);
        Some(Change { old: was, new: number(&new.value)?, origin, unit, name: new.name })
    };
    let own = |name: &str| name.starts_with("monitoring.");
    before
        .parameters()
        .into_iter()
        .zip(after.parameters())
        .filter(|(_, new)| own(&new.name))
        .filter_map(change)
        .collect()
}

/// The power of the jack's flow, and so of its area at the same velocity, that a parameter of the monitoring model has and that
/// no fit finds.
#[must_use]
pub fn flow_power(name: &str) -> i32 {
    match name {
        "monitoring.fluid.flow_reference_m3_per_s" => 1,
        "monitoring.fluid.lag_flow_slope_s_per_m3" => -1,
        _ => 0,
    }
}

fn origin(name: &str) -> Origin {
    match name.trim_start_matches("monitoring.").split_once('.').unwrap_or_default() {
        ("first_stage" | "second_stage", _) | ("fluid", "supply_pressure_differential_pa") => Origin::Derived,
        ("bias", _) => Origin::Measured,
        ("fluid", key) if key.starts_with("lag_bell") || key == "lag_flow_slope_s_per_m3" => Origin::Kept,
        ("fluid", "flow_reference_m3_per_s") => Origin::Kept,
        ("fluid", _) => Origin::Fitted,
        _ => Origin::Kept,
    }
}
