//! How the forecast of an actuator moved, step by step.

use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;

use crate::jobs::run::predict::Risk;
use crate::store::records::{Id, TrendFigures, TrendRecord};

/// What was forecast of an actuator from the traces of a life up to one.
#[derive(Debug, Serialize, ToSchema)]
pub struct TrendItem {
    /// The trace.
    trace_id: Id,
    /// When it was recorded.
    as_of: Timestamp,
    /// The usage from which remaining life counts.
    usage: f64,
    /// When the forecast was made.
    made_at: Timestamp,
    /// When the life began; null for the first, which began with the actuator.
    life_started_at: Option<Timestamp>,
    /// The usage at which it began; null for the first.
    life_start_usage: Option<f64>,
    /// The forecast of the life that ends with the first fault at its threshold.
    #[serde(flatten)]
    actuator: TrendPoint,
    /// The forecast of each fault by itself.
    faults: TrendFaultPoints,
    /// The elevon version that made the forecast.
    version: String,
}

/// The forecasts of the faults.
#[derive(Debug, Serialize, ToSchema)]
struct TrendFaultPoints {
    /// Torque-motor demagnetisation.
    kgm: TrendPoint,
    /// Dynamic jack friction.
    fdj_n: TrendPoint,
}

/// A forecast as the trend shows it; all of it is null where none could be made.
#[derive(Debug, Serialize, ToSchema)]
struct TrendPoint {
    /// The remaining life.
    forecast: Option<TrendForecast>,
    /// The usage at which life ends: that of the row and the remaining life together.
    end_of_life: Option<TrendQuantiles>,
    /// How probably it ends soon.
    risk: Option<Risk>,
}

/// A remaining life as the trend shows it.
#[derive(Debug, Serialize, ToSchema)]
struct TrendForecast {
    /// Quantiles of the remaining life, in usage; null beyond the horizon.
    quantiles: TrendQuantiles,
    /// Mean of the remaining life up to the horizon, in usage.
    mean: Option<f64>,
    /// Whether a threshold was passed already.
    reached: bool,
}

/// The quantiles that the trend keeps, in the actuator's usage unit; null beyond the horizon.
#[derive(Debug, Serialize, ToSchema)]
struct TrendQuantiles {
    /// Less than this with probability 0.05.
    #[serde(rename = "0.05")]
    q05: Option<f64>,
    /// The median.
    #[serde(rename = "0.5")]
    q50: Option<f64>,
    /// Less than this with probability 0.95.
    #[serde(rename = "0.95")]
    q95: Option<f64>,
}

impl TrendQuantiles {
    /// Those of a life, counted from some usage.
    fn from_usage(usage: f64, figures: &TrendFigures) -> Self {
        let [q05, q50, q95] = [figures.q05, figures.q50, figures.q95].map(|quantile| quantile.map(|q| usage + q));
        Self { q05, q50, q95 }
    }
}

impl TrendPoint {
    fn of(figures: Option<TrendFigures>, usage: f64, within: f64) -> Self {
        let forecast = |figures: &TrendFigures| TrendForecast {
            quantiles: TrendQuantiles::from_usage(0.0, figures),
            mean: figures.mean,
            reached: figures.reached,
        };
        Self {
            forecast: figures.as_ref().map(forecast),
            end_of_life: figures.as_ref().map(|figures| TrendQuantiles::from_usage(usage, figures)),
            risk: figures.and_then(|figures| figures.risk).map(|probability| Risk { within, probability }),
        }
    }
}

impl From<TrendRecord> for TrendItem {
    fn from(record: TrendRecord) -> Self {
        let point = |figures| TrendPoint::of(figures, record.usage, record.risk_window);
        Self {
            trace_id: record.trace_id,
            as_of: record.recorded_at,
            usage: record.usage,
            made_at: record.made_at,
            life_started_at: record.life_started_at,
            life_start_usage: record.life_start_usage,
            actuator: point(record.actuator),
            faults: TrendFaultPoints { kgm: point(record.faults.kgm), fdj_n: point(record.faults.fdj_n) },
            version: record.version,
        }
    }
}
