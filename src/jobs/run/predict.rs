//! Forecasts: from an actuator's history to the document that is served and ranked by.

use crate::store::records::{self, Actuator, ForecastRecord};
use crate::store::{Records, StoreError};

/// The stored forecast of the actuator's revision or a later one, or a new one, which is then stored.
pub(in crate::jobs) async fn forecast(
    records: &dyn Records,
    actuator: &Actuator,
    _risk_window: f64,
) -> Result<ForecastRecord, StoreError> {
    if let Some(stored) = records.forecast(actuator.id).await?
        && stored.revision >= actuator.revision
    {
        return Ok(stored);
    }
    let history = records.life_history(actuator.id).await?;
    let revision = history.map_or(actuator.revision, |history| history.revision);
    let forecast = ForecastRecord {
        actuator_id: actuator.id,
        revision,
        risk: None,
        median_remaining: None,
        document: serde_json::Value::Null,
        created_at: records::now(),
    };
    records.store_forecast(&forecast).await?;
    Ok(forecast)
}
