//! Forecasts for a person.

use std::path::Path;

use super::Answers;
use super::answer::{Answer, Risk};
use super::ask::Case;
use crate::formats::history::UsageUnit;
use crate::prognostics::Direction;

/// The answers: one at length, or a row for each.
pub(super) fn told(file: &Path, cases: &[Case<'_>], answers: &[Answers<'_>]) -> String {
    match (cases, answers) {
        ([case], [Answers { forecasts, .. }]) if forecasts.len() == 1 => at_length(file, case, &forecasts[0]),
        _ => rows(file, answers),
    }
}

fn at_length(file: &Path, case: &Case<'_>, answer: &Answer) -> String {
    let unit = words(answer.unit);
    let direction = match case.direction {
        Direction::Rising => "rising",
        Direction::Falling => "falling",
    };
    let mut lines = vec![
        file.display().to_string(),
        format!("  at {} {unit}, {direction} to the threshold {}", number(answer.at), case.threshold),
    ];
    if answer.reached {
        lines.push("  the threshold has been reached".into());
    }
    if let Some(horizon) = answer.horizon.filter(|_| answer.probability_beyond_horizon.is_some()) {
        let pairs = answer.quantiles.pairs();
        let probabilities = cells(pairs.map(|pair| format!("{:.0} %", pair.0 * 100.0)));
        let remaining = cells(pairs.map(|pair| pair.1.map_or_else(|| "beyond".into(), number)));
        lines.push(format!("  {:24}{probabilities}", "probability of failure"));
        lines.push(format!("  {:24}{remaining}", format!("within {unit}")));
        let beyond = answer.probability_beyond_horizon.unwrap_or_default();
        lines.push(format!("  beyond the horizon of {} {unit}: {}", number(horizon), share(beyond)));
        if let Some(mean) = answer.mean {
            lines.push(format!("  mean {} {unit}, of what lies within the horizon", number(mean)));
        }
    }
    if let Some(Risk { within, probability }) = answer.risk {
        lines.push(format!("  failure within {} {unit}: {}", number(within), share(probability)));
    }
    if answer.probability_beyond_horizon.is_some() {
        let usage = answer.act_by.usage.map_or_else(|| "later than the horizon".into(), number);
        lines.push(format!("  act by usage {usage}, for a risk of {}", share(answer.act_by.risk)));
        lines.push(format!("  laws: {}", laws(answer)));
    }
    lines.extend(answer.reasons.iter().map(|reason| format!("  {reason}")));
    lines.join("\n") + "\n"
}

fn cells(texts: [String; 7]) -> String {
    texts.iter().map(|text| format!(" {text:>10}")).collect()
}

fn rows(file: &Path, answers: &[Answers<'_>]) -> String {
    let mut lines = vec![
        file.display().to_string(),
        format!("{:>16} {:>10} {:>10} {:>10} {:>10} {:>10}  reasons", "history", "at", "5 %", "50 %", "95 %", "act by"),
    ];
    for Answers { id, forecasts } in answers {
        let id = id.map_or_else(String::new, |id| id.as_str().map_or_else(|| id.to_string(), str::to_owned));
        for answer in forecasts {
            let quantiles = answer.quantiles;
            let known = answer.probability_beyond_horizon.is_some();
            let cell = |value: Option<f64>| value.map_or_else(|| if known { "beyond" } else { "-" }.into(), number);
            let [low, median, high] = [quantiles.q05, quantiles.q50, quantiles.q95].map(cell);
            let (at, act_by) = (number(answer.at), cell(answer.act_by.usage));
            let reasons = answer.reasons.join("; ");
            lines.push(format!("{id:>16} {at:>10} {low:>10} {median:>10} {high:>10} {act_by:>10}  {reasons}"));
        }
    }
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

fn words(unit: UsageUnit) -> &'static str {
    match unit {
        UsageUnit::FlightHours => "flight hours",
        UsageUnit::FlightCycles => "flight cycles",
    }
}

/// A number with four digits, or all those before the point.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor() as i32;
    match magnitude {
        -4..9 => format!("{value:.*}", usize::try_from(3 - magnitude).unwrap_or(0)),
        _ => format!("{value:.3e}"),
    }
}

/// A probability in percent, never as none or all.
fn share(probability: f64) -> String {
    match probability {
        p if p > 0.0 && p < 0.001 => "less than 0.1 %".into(),
        p if p > 0.999 && p < 1.0 => "more than 99.9 %".into(),
        p => format!("{:.1} %", p * 100.0),
    }
}

/// The laws, the most probable first.
fn laws(answer: &Answer) -> String {
    let mut laws: Vec<_> = answer.laws.iter().collect();
    laws.sort_by(|a, b| b.1.total_cmp(a.1));
    laws.iter().map(|(law, probability)| format!("{law} {:.0} %", 100.0 * **probability)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_shares_never_nothing() {
        let numbers = [0.0, 12_345.6, 1234.5, 12.3456, 0.012_345, -5.0, 1e-7, 3e12].map(number);
        assert_eq!(numbers, ["0", "12346", "1234", "12.35", "0.01235", "-5.000", "1.000e-7", "3.000e12"]);
        assert_eq!(
            [0.0, 1e-9, 0.05, 0.9999, 1.0].map(share),
            ["0.0 %", "less than 0.1 %", "5.0 %", "more than 99.9 %", "100.0 %"]
        );
    }
}
