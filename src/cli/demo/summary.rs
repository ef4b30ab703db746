//! The fleet's ranking and what is worth a look, printed.

use serde_json::Value;

use super::client::{Client, text};
use crate::models::fault::FDJ_NOMINAL_N;

/// A fault that has gone less than this part of the way to its threshold has not grown to speak of.
const SLIGHT: f64 = 0.1;

/// Prints the fleet, riskiest first, and the actuators whose pages are worth a look.
pub fn print(client: &Client) -> anyhow::Result<()> {
    let rows = client.list("/v1/fleet/health?sort=risk")?;
    println!(
        "{:>4}  {:<10} {:<7} {:<16} {:>6} {:>7}  {:>26}  {:>8}",
        "rank", "actuator", "tail", "location", "KGM", "FDJ N", "remaining life h (90 %)", "risk"
    );
    for row in &rows {
        let text = |field: &str| row[field].as_str().unwrap_or("-").to_owned();
        println!(
            "{:>4}  {:<10} {:<7} {:<16} {:>6} {:>7}  {:>26}  {:>8}",
            row["risk_rank"].to_string(),
            text("serial_number"),
            text("tail_number"),
            text("location"),
            number(&row["newest"]["kgm"], 3),
            number(&row["newest"]["fdj_n"], 0),
            remaining(&row["remaining_life"]),
            row["risk"]["probability"].as_f64().map_or("-".into(), |p| format!("{:.1} %", 100.0 * p)),
        );
    }
    print_worth_a_look(client, &rows)
}

/// Prints which actuators have open alerts, which began a new life, and which are healthy.
fn print_worth_a_look(client: &Client, rows: &[Value]) -> anyhow::Result<()> {
    let (mut open, mut renewed, mut healthy) = (Vec::new(), Vec::new(), Vec::new());
    for alert in client.list("/v1/alerts?state=open")? {
        open.push(format!("{} ({})", text(&alert, "serial_number")?, text(&alert, "kind")?));
    }
    open.sort();
    for row in rows {
        let (serial_number, id) = (text(row, "serial_number")?, text(row, "actuator_id")?);
        let events = client.list(&format!("/v1/actuators/{id}/maintenance"))?;
        if let Some(event) = events.iter().rfind(|event| event["kind"] == "replaced") {
            let cleared = client.list(&format!("/v1/actuators/{id}/alerts?state=cleared"))?;
            let by_it = cleared.iter().filter(|alert| alert["cleared_because"] == "maintenance").count();
            let usage = number(&event["usage"], 0);
            renewed.push(format!("{serial_number} (replaced at {usage} h; alerts cleared by that: {by_it})"));
        }
        if is_healthy(row) {
            healthy.push(serial_number.to_owned());
        }
    }
    println!();
    for (what, which) in [("Open alerts", open), ("New life", renewed), ("Healthy", healthy)] {
        println!("{what:<11}  {}", if which.is_empty() { "none".to_owned() } else { which.join(", ") });
    }
    Ok(())
}

/// Whether neither fault has grown to speak of.
fn is_healthy(row: &Value) -> bool {
    [("kgm", 0.0), ("fdj_n", FDJ_NOMINAL_N)].iter().all(|&(fault, new)| {
        let grown = |of: &str| row[of][fault].as_f64().map(|level| level - new);
        grown("newest").zip(grown("thresholds")).is_some_and(|(level, threshold)| level < SLIGHT * threshold)
    })
}

fn number(value: &Value, decimals: usize) -> String {
    value.as_f64().map_or("-".into(), |value| format!("{value:.decimals$}"))
}

/// Median and 90 % interval; a quantile beyond the horizon is shown as such.
fn remaining(life: &Value) -> String {
    if life.is_null() {
        return "-".into();
    }
    let quantiles = &life["quantiles"];
    let horizon = number(&life["horizon"], 0);
    let quantile = |name: &str| match &quantiles[name] {
        Value::Null => format!(">{horizon}"),
        value => number(value, 0),
    };
    format!("{} ({} to {})", quantile("0.5"), quantile("0.05"), quantile("0.95"))
}
