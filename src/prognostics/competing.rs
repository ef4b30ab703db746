//! Competing risks: an actuator's life ends when the first of its faults reaches its threshold.

use super::forecast::{self, Prognosis};
use super::history::{Check, PrognosisError};

/// The prognosis of an actuator from those of its faults, by name, taken as independent: survival multiplies.
///
/// Faults without a forecast are left out, with a reason. The horizon is the longest of the parts'. The band is empty.
///
/// # Errors
/// The parts whose `at` or risk window differs from the first one's.
pub fn competing(parts: &[(&str, &Prognosis)]) -> Result<Prognosis, PrognosisError> {
    let known: Vec<_> = parts.iter().filter_map(|(name, part)| Some((*name, *part, part.forecast.as_ref()?))).collect();
    let mut reasons = Vec::new();
    for (name, part) in parts {
        reasons.extend(part.reasons.iter().map(|reason| format!("{name}: {reason}")));
        if part.forecast.is_none() {
            reasons.push(format!("{name} has no forecast and is left out"));
        }
    }
    let risk_window = parts.first().map_or(0.0, |(_, part)| part.risk_window);
    let mut together = Prognosis { reasons, risk_window, ..Prognosis::default() };
    let Some((_, _, first)) = known.first() else {
        if parts.is_empty() {
            together.reasons.push("no fault to forecast".to_owned());
        }
        return Ok(together);
    };
    let mut check = Check::default();
    for (name, part, forecast) in &known {
        check.that(
            forecast.at == first.at,
            || format!("{name}.at"),
            forecast.at,
            &format!("{}, as the first", first.at),
        );
        let window = part.risk_window;
        check.that(
            window == risk_window,
            || format!("{name}.risk_window"),
            window,
            &format!("{risk_window}, as the first"),
        );
    }
    check.finish()?;
    let horizon = known.iter().map(|k| k.2.horizon).fold(0.0, f64::max);
    let reached = known.iter().any(|k| k.2.reached);
    let mut models: Vec<String> = known.iter().flat_map(|k| k.2.models.iter().cloned()).collect();
    models.sort();
    models.dedup();
    together.lives = known.iter().flat_map(|k| k.1.lives.iter().cloned()).collect();
    together.forecast = Some(forecast::forecast(&together.lives, first.at, horizon, reached, models));
    together.risk = Some(1.0 - forecast::survival(&together.lives, risk_window));
    Ok(together)
}
