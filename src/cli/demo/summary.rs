//! The fleet's ranking, printed.

use serde_json::Value;

use super::client::Client;

/// Prints the fleet, riskiest first.
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
    Ok(())
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
