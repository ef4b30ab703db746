//! The fleet's list: one row for each actuator, riskiest first.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::list::{List, PageQuery};
use crate::estimation::Verdict;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::query::{Fields, FromQuery};
use crate::jobs::run::predict::ActBy;
use crate::store::records::{HealthRecord, Id, Thresholds, UsageUnit};
use crate::store::{FleetRow, Page, Paged};

/// Which part of the fleet.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct FleetQuery {
    /// The order: `risk`, the probability of passing a threshold within the service's risk window, falling, in whole
    /// percents; then the median remaining life, rising.
    #[param(default = "risk", pattern = "^risk$")]
    pub sort: Option<String>,
    /// Only the actuators of this aircraft.
    pub tail_number: Option<String>,
}

impl FromQuery for (FleetQuery, PageQuery) {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let sort = fields.parse_with("sort", "risk", |text| (text == "risk").then(|| text.to_owned()));
        let tail_number = fields.text("tail_number");
        Some((FleetQuery { sort, tail_number }, PageQuery::from_query(fields)?))
    }
}

/// An actuator with its newest health and its forecast.
#[derive(Debug, Serialize, ToSchema)]
pub struct FleetItem {
    /// Its place in this list, from 1.
    risk_rank: u64,
    /// The actuator.
    actuator_id: Id,
    /// The part's serial number.
    serial_number: String,
    /// The aircraft.
    tail_number: String,
    /// Where on the aircraft.
    location: String,
    /// What its usage counts.
    usage_unit: UsageUnit,
    /// Its failure thresholds.
    thresholds: Thresholds,
    /// Its newest estimate in this life; null before the first.
    newest: Option<Newest>,
    /// Null without a forecast.
    risk: Option<FleetRisk>,
    /// When to act at the service's risk (`prognostics.act_at_risk` of its settings); null without a forecast.
    act_by: Option<ActBy>,
    /// Null without a forecast.
    remaining_life: Option<FleetLife>,
    /// Its alerts that are not cleared.
    alerts_open: u64,
    /// Why something is missing, or what to know of it.
    reasons: Vec<String>,
}

/// The newest estimate of an actuator.
#[derive(Debug, Serialize, ToSchema)]
struct Newest {
    /// The trace that was estimated.
    trace_id: Id,
    /// When it was recorded.
    recorded_at: Timestamp,
    /// The actuator's usage then.
    usage: f64,
    /// Torque-motor demagnetisation, 0 to 1.
    kgm: Option<f64>,
    /// Its standard deviation.
    kgm_std: Option<f64>,
    /// Dynamic jack friction, N.
    fdj_n: Option<f64>,
    /// Its standard deviation, N.
    fdj_n_std: Option<f64>,
    /// Whether the trace determined at least one fault.
    verdict: Verdict,
}

/// How likely a failure is soon.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
struct FleetRisk {
    /// The further usage that is looked at, in the actuator's usage unit.
    within: f64,
    /// The probability that a threshold is passed within it, 0 to 1.
    probability: f64,
}

/// How much usage is left before a threshold is passed.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
struct FleetLife {
    /// Remaining life by level (0.05 to 0.95), in the actuator's usage unit; null beyond the horizon.
    #[schema(example = json!({"0.05": 80.1, "0.5": 120.4, "0.95": null}))]
    quantiles: BTreeMap<String, Option<f64>>,
    /// The dates of the quantiles at the recent rate of use; null where the quantile is, without a rate, and beyond the year
    /// 9999.
    #[serde(default)]
    #[schema(example = json!({"0.05": "2027-03-01T06:00:00Z", "0.5": "2028-11-12T18:30:00Z", "0.95": null}))]
    dates: BTreeMap<String, Option<Timestamp>>,
    /// Whether a threshold is passed already.
    reached: bool,
    /// The probability that no threshold is passed within the horizon.
    probability_beyond_horizon: f64,
    /// How far the forecast looks, in the actuator's usage unit.
    horizon: f64,
}

/// What the fleet's list shows of a forecast.
#[derive(Debug, Default, Deserialize)]
struct Summary {
    forecast: Option<FleetLife>,
    risk: Option<FleetRisk>,
    act_by: Option<ActBy>,
    reasons: Vec<String>,
}

/// The page of the fleet's list that a query asks for. Its cursor carries the rank of the page's first row.
pub struct FleetPage {
    first_rank: u64,
    /// The page as the store knows it.
    pub page: Page,
}

impl FleetPage {
    /// The page that a query asks for.
    ///
    /// # Errors
    /// A cursor that this list did not make.
    pub fn of(query: PageQuery) -> ApiResult<Self> {
        let mut page = Page::from(query);
        let Some(cursor) = page.after.take() else { return Ok(Self { first_rank: 1, page }) };
        let parts =
            cursor.split_once('_').and_then(|(rank, after)| Some((rank.parse::<u64>().ok()?, after.to_owned())));
        let (first_rank, after) =
            parts.filter(|(rank, _)| *rank > 1 && *rank < u64::from(u32::MAX)).ok_or_else(|| {
                let detail = format!("found {cursor:?}, expected the next_cursor of a page of this list");
                ApiError::malformed("?cursor", detail)
            })?;
        page.after = Some(after);
        Ok(Self { first_rank, page })
    }

    /// The rows as they are served.
    ///
    /// # Errors
    /// A stored forecast that cannot be read.
    pub fn list(&self, rows: Paged<FleetRow>) -> ApiResult<List<FleetItem>> {
        let next_rank = self.first_rank + rows.items.len() as u64;
        let items = rows.items.into_iter().zip(self.first_rank..).map(|(row, rank)| FleetItem::of(row, rank));
        let next_cursor = rows.next_cursor.map(|after| format!("{next_rank}_{after}"));
        Ok(List { items: items.collect::<ApiResult<_>>()?, next_cursor })
    }
}

impl FleetItem {
    fn of(row: FleetRow, risk_rank: u64) -> ApiResult<Self> {
        let document = row.forecast.map(|forecast| forecast.document);
        let summary: Option<Summary> = document.map(serde_json::from_value).transpose().map_err(ApiError::internal)?;
        let Summary { forecast, risk, act_by, reasons } = summary.unwrap_or_default();
        let actuator = row.actuator;
        Ok(Self {
            risk_rank,
            actuator_id: actuator.id,
            serial_number: actuator.serial_number,
            tail_number: actuator.tail_number,
            location: actuator.location,
            usage_unit: actuator.usage_unit,
            thresholds: actuator.thresholds,
            newest: row.newest.map(Newest::from),
            risk,
            act_by,
            remaining_life: forecast,
            alerts_open: row.alerts_open,
            reasons,
        })
    }
}

impl From<HealthRecord> for Newest {
    fn from(record: HealthRecord) -> Self {
        let HealthRecord { trace_id, recorded_at, usage, kgm, kgm_std, fdj_n, fdj_n_std, verdict, .. } = record;
        Self { trace_id, recorded_at, usage, kgm, kgm_std, fdj_n, fdj_n_std, verdict }
    }
}
