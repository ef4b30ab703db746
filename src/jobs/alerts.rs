//! When an alert is raised and when it is cleared: a pure decision on a forecast and on what is open already
//! (docs/alerts.md).

use jiff::Timestamp;

use super::run::predict::{FaultForecast, RemainingLife};
use crate::models::fault::FDJ_NOMINAL_N;
use crate::store::LifeHistory;
use crate::store::alerts::{Alert, AlertChange, AlertFault, AlertKind, Cause, ClearedBecause, NewAlert};
use crate::store::records::{Actuator, HealthRecord, Id, UsageUnit};

/// The fewest traces of a life on which a risk is raised: after one, the rate of growth is the prior's alone.
const RISK_TRACES_MIN: usize = 2;

/// When alerts are raised and cleared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlertSettings {
    /// The probability of a failure within the risk window from which an alert is raised, above 0, at most 1.
    pub risk_raise: f64,
    /// The probability below which it is cleared, 0 to `risk_raise`.
    pub risk_clear: f64,
    /// The part of the way from healthy to the threshold below which a level clears its alert, 0 to 1.
    pub threshold_clear: f64,
}

impl Default for AlertSettings {
    fn default() -> Self {
        Self { risk_raise: 0.10, risk_clear: 0.05, threshold_clear: 0.9 }
    }
}

/// The newest level that a trace determined of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newest {
    /// The level, in the fault's unit.
    pub value: f64,
    /// Its standard deviation.
    pub std: Option<f64>,
    /// The trace.
    pub trace_id: Id,
}

/// The newest levels of a life, which its forecast rests on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evidence {
    /// The newest level of torque-motor demagnetisation.
    pub kgm: Option<Newest>,
    /// The newest level of dynamic jack friction.
    pub fdj_n: Option<Newest>,
    /// The newest trace that determined one of them.
    pub trace_id: Option<Id>,
    /// How many traces determined one of them.
    pub traces: usize,
}

impl Evidence {
    /// What a history, ascending by time of recording, tells.
    #[must_use]
    pub fn of(history: &LifeHistory) -> Self {
        let newest = |figure: fn(&HealthRecord) -> (Option<f64>, Option<f64>)| {
            history.records.iter().rev().find_map(|record| {
                let (value, std) = figure(record);
                Some(Newest { value: value?, std, trace_id: record.trace_id })
            })
        };
        let determined = |record: &&HealthRecord| record.kgm.is_some() || record.fdj_n.is_some();
        Self {
            kgm: newest(|record| (record.kgm, record.kgm_std)),
            fdj_n: newest(|record| (record.fdj_n, record.fdj_n_std)),
            trace_id: history.records.iter().rev().find(determined).map(|record| record.trace_id),
            traces: history.records.iter().filter(determined).count(),
        }
    }
}

/// What a forecast says of one fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The fault.
    pub fault: AlertFault,
    /// The level of a healthy actuator.
    pub healthy: f64,
    /// The level at which an actuator counts as failed.
    pub threshold: f64,
    /// Whether the forecast holds the threshold for reached.
    pub reached: bool,
    /// The newest level that a trace determined.
    pub newest: Newest,
}

/// The probability of a failure within a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoonRisk {
    /// The probability, 0 to 1.
    pub risk: f64,
    /// The window, in the actuator's usage unit.
    pub within: f64,
    /// The newest trace that it rests on.
    pub trace_id: Option<Id>,
    /// How many traces it rests on.
    pub traces: usize,
}

/// What a forecast says that alerts are decided on. What it does not say changes nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Summary {
    /// The faults that have a forecast.
    pub levels: Vec<Level>,
    /// The risk of the actuator, if it has a forecast.
    pub risk: Option<SoonRisk>,
}

impl Summary {
    /// What a forecast and the levels beneath it say.
    #[must_use]
    pub fn of(life: &RemainingLife, evidence: &Evidence) -> Self {
        let level = |fault, healthy, told: &FaultForecast, newest: Option<Newest>| {
            let reached = told.forecast.as_ref()?.forecast.reached;
            Some(Level { fault, healthy, threshold: told.threshold, reached, newest: newest? })
        };
        let kgm = level(AlertFault::Kgm, 0.0, &life.faults.kgm, evidence.kgm);
        let fdj_n = level(AlertFault::FdjN, FDJ_NOMINAL_N, &life.faults.fdj_n, evidence.fdj_n);
        let told = life.risk.filter(|risk| risk.probability.is_finite());
        let risk = told.map(|risk| SoonRisk {
            risk: risk.probability,
            within: risk.within,
            trace_id: evidence.trace_id,
            traces: evidence.traces,
        });
        Self { levels: kgm.into_iter().chain(fdj_n).collect(), risk }
    }
}

/// One thing to do about an actuator's alerts.
#[derive(Debug, Clone, PartialEq)]
pub enum Decision {
    /// Raise one.
    Raise(Cause),
    /// Clear this one.
    Clear(Id, ClearedBecause),
}

/// What is to be done, given the alerts that are not cleared: raise what has come and is not open, clear what is open and has
/// gone by a margin, leave the rest.
#[must_use]
pub fn decide(open: &[Alert], summary: &Summary, settings: &AlertSettings) -> Vec<Decision> {
    let find = |kind, fault| open.iter().find(|alert| alert.kind == kind && alert.fault == fault);
    let levels = summary.levels.iter().filter_map(|level| {
        decide_level(find(AlertKind::Threshold, Some(level.fault)), level, settings.threshold_clear)
    });
    let risk = summary.risk.and_then(|risk| decide_risk(find(AlertKind::Risk, None), risk, settings));
    levels.chain(risk).collect()
}

fn decide_level(open: Option<&Alert>, level: &Level, threshold_clear: f64) -> Option<Decision> {
    let Level { fault, healthy, threshold, reached, newest } = *level;
    match open {
        None if reached => {
            let Newest { value, std, trace_id } = newest;
            Some(Decision::Raise(Cause::Threshold { fault, value, value_std: std, threshold, trace_id }))
        }
        Some(alert) if !reached => {
            let distance = (newest.value + newest.std.unwrap_or(0.0) - healthy) / (threshold - healthy);
            (distance < threshold_clear).then_some(Decision::Clear(alert.id, ClearedBecause::LevelFell))
        }
        _ => None,
    }
}

fn decide_risk(open: Option<&Alert>, told: SoonRisk, settings: &AlertSettings) -> Option<Decision> {
    let SoonRisk { risk, within, trace_id, traces } = told;
    match open {
        None if risk >= settings.risk_raise && traces >= RISK_TRACES_MIN => {
            Some(Decision::Raise(Cause::Risk { risk, limit: settings.risk_raise, within, trace_id }))
        }
        Some(alert) if risk < settings.risk_clear => Some(Decision::Clear(alert.id, ClearedBecause::RiskFell)),
        _ => None,
    }
}

/// The decisions of a forecast as the store takes them.
#[must_use]
pub fn changes(
    actuator: &Actuator,
    life: &RemainingLife,
    evidence: &Evidence,
    open: &[Alert],
    settings: &AlertSettings,
    now: Timestamp,
) -> Vec<AlertChange> {
    let usage = life.usage.unwrap_or_default();
    let change = |decision| match decision {
        Decision::Raise(cause) => {
            let message = message(actuator, &cause, usage);
            AlertChange::Raise(Box::new(NewAlert { id: Id::now(), cause, usage, message, raised_at: now }))
        }
        Decision::Clear(id, because) => AlertChange::Clear { id, because, at: now },
    };
    decide(open, &Summary::of(life, evidence), settings).into_iter().map(change).collect()
}

/// An alert as a sentence for a mechanic.
fn message(actuator: &Actuator, cause: &Cause, usage: f64) -> String {
    let Actuator { serial_number, tail_number, location, .. } = actuator;
    let unit = unit(actuator.usage_unit);
    let who = format!("Actuator {serial_number} ({location}) of {tail_number}");
    let usage = rounded(usage, 1);
    match *cause {
        Cause::Threshold { fault, value, value_std, threshold, .. } => {
            let figure = |value| match fault {
                AlertFault::Kgm => rounded(value, 3),
                AlertFault::FdjN => format!("{} N", rounded(value, 0)),
            };
            let name = match fault {
                AlertFault::Kgm => "torque-motor demagnetisation (KGM)",
                AlertFault::FdjN => "jack friction (FDJ)",
            };
            let spread = value_std.map(|std| format!(" ± {}", figure(std))).unwrap_or_default();
            format!(
                "{who}: {name} has reached its limit of {}; the newest estimate is {}{spread}, at {usage} {unit}.",
                figure(threshold),
                figure(value)
            )
        }
        Cause::Risk { risk, limit, within, .. } => format!(
            "{who}: a failure within the next {} {unit} has a probability of {} %, and {} % is the limit, at {usage} {unit}.",
            rounded(within, 1),
            // What is not certain is not called so.
            if risk > 0.999 { "more than 99.9".to_owned() } else { rounded(100.0 * risk, 1) },
            rounded(100.0 * limit, 1)
        ),
    }
}

const fn unit(unit: UsageUnit) -> &'static str {
    match unit {
        UsageUnit::FlightHours => "flight hours",
        UsageUnit::FlightCycles => "flight cycles",
    }
}

/// A number with at most so many decimals.
fn rounded(value: f64, decimals: u8) -> String {
    let text = format!("{value:.*}", usize::from(decimals));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::alerts::AlertState;
    use crate::store::records::{Thresholds, now};

    const SETTINGS: AlertSettings = AlertSettings { risk_raise: 0.10, risk_clear: 0.05, threshold_clear: 0.9 };

    fn kgm(value: f64, std: Option<f64>, reached: bool) -> Summary {
        let newest = Newest { value, std, trace_id: Id::now() };
        let level = Level { fault: AlertFault::Kgm, healthy: 0.0, threshold: 0.4, reached, newest };
        Summary { levels: vec![level], risk: None }
    }

    fn risk(risk: f64) -> Summary {
        Summary { levels: Vec::new(), risk: Some(SoonRisk { risk, within: 100.0, trace_id: None, traces: 2 }) }
    }

    fn raised(cause: Cause) -> Alert {
        Alert {
            id: Id::now(),
            actuator_id: Id::now(),
            serial_number: "A".into(),
            tail_number: "B".into(),
            kind: cause.kind(),
            fault: cause.fault(),
            state: AlertState::Open,
            raised_at: now(),
            acknowledged_at: None,
            cleared_at: None,
            cleared_because: None,
            usage: 1.0,
            usage_unit: UsageUnit::FlightHours,
            value: None,
            value_std: None,
            threshold: None,
            risk: None,
            limit: None,
            within: None,
            trace_id: None,
            note: String::new(),
            message: String::new(),
        }
    }

    /// What happens as one forecast follows another: `+` raised, `-` cleared, `.` nothing.
    fn course(summaries: impl IntoIterator<Item = Summary>) -> String {
        let mut open: Vec<Alert> = Vec::new();
        let step = |summary: Summary| match &decide(&open, &summary, &SETTINGS)[..] {
            [] => '.',
            [Decision::Raise(cause)] => {
                open.push(raised(*cause));
                '+'
            }
            [Decision::Clear(id, _)] => {
                open.retain(|alert| alert.id != *id);
                '-'
            }
            several => panic!("{several:?}"),
        };
        summaries.into_iter().map(step).collect()
    }

    #[test]
    fn a_risk_is_raised_at_its_upper_bound_and_cleared_below_its_lower_one() {
        assert_eq!(course([0.0, 0.0999, 0.10, 0.3, 0.05, 0.0499, 0.0].map(risk)), "..+..-.");
    }

    #[test]
    fn a_risk_that_swings_between_the_bounds_changes_nothing_whether_an_alert_is_open_or_not() {
        let swings = || (0..50).map(|i| risk(if i % 2 == 0 { 0.051 } else { 0.099 }));
        assert_eq!(course(swings()), ".".repeat(50));
        assert_eq!(course([risk(0.2)].into_iter().chain(swings())), format!("+{}", ".".repeat(50)));
    }

    #[test]
    fn a_risk_that_swings_around_one_bound_makes_one_change_only() {
        let around = |bound: f64| (0..50).map(move |i| risk(if i % 2 == 0 { bound - 1e-3 } else { bound + 1e-3 }));
        assert_eq!(course(around(0.10)), format!(".+{}", ".".repeat(48)));
        let course = course([risk(0.2)].into_iter().chain(around(0.05)));
        assert_eq!(course, format!("+-{}", ".".repeat(49)));
    }

    #[test]
    fn one_trace_alone_raises_no_risk() {
        let mut summary = risk(0.5);
        summary.risk.as_mut().unwrap().traces = 1;
        assert_eq!(decide(&[], &summary, &SETTINGS), []);
        assert_eq!(decide(&[], &risk(0.5), &SETTINGS).len(), 1);
    }

    #[test]
    fn a_threshold_alert_is_raised_when_reached_and_cleared_only_well_below() {
        let steps =
            [(0.38, false), (0.41, true), (0.39, false), (0.358, false), (0.41, true), (0.30, false), (0.3, false)];
        let summaries = steps.map(|(value, reached)| kgm(value, Some(0.01), reached));
        // 0.358 + 0.01 is above 0.9 of 0.4, 0.30 + 0.01 is not.
        assert_eq!(course(summaries), ".+...-.");
    }

    #[test]
    fn a_low_value_does_not_clear_what_the_forecast_still_holds_for_reached() {
        assert_eq!(course([kgm(0.41, None, true), kgm(0.1, None, true), kgm(0.1, None, false)]), "+.-");
    }

    #[test]
    fn an_uncertain_level_clears_nothing() {
        assert_eq!(
            course([kgm(0.41, Some(0.01), true), kgm(0.2, Some(0.2), false), kgm(0.2, Some(0.1), false)]),
            "+.-"
        );
    }

    #[test]
    fn the_margin_is_measured_from_the_healthy_level() {
        let friction = |value: f64, reached| {
            let newest = Newest { value, std: None, trace_id: Id::now() };
            let level = Level { fault: AlertFault::FdjN, healthy: 200.0, threshold: 1000.0, reached, newest };
            Summary { levels: vec![level], risk: None }
        };
        // 0.9 of the way from 200 N to 1000 N is 920 N.
        assert_eq!(course([friction(1010.0, true), friction(921.0, false), friction(919.0, false)]), "+.-");
    }

    #[test]
    fn what_a_forecast_does_not_say_changes_nothing() {
        let open = [raised(Cause::Risk { risk: 0.2, limit: 0.1, within: 1.0, trace_id: None })];
        assert_eq!(decide(&open, &Summary::default(), &SETTINGS), []);
        assert_eq!(decide(&open, &risk(f64::NAN), &SETTINGS), []);
        assert_eq!(decide(&[], &risk(f64::NAN), &SETTINGS), []);
    }

    #[test]
    fn faults_and_the_risk_have_alerts_of_their_own() {
        let mut summary = kgm(0.5, None, true);
        summary.levels.push(Level { fault: AlertFault::FdjN, healthy: 200.0, threshold: 1000.0, ..summary.levels[0] });
        summary.risk = risk(1.0).risk;
        let first = decide(&[], &summary, &SETTINGS);
        assert_eq!(first.len(), 3, "{first:?}");
        let open: Vec<_> = first
            .iter()
            .map(|decision| match decision {
                Decision::Raise(cause) => raised(*cause),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(decide(&open, &summary, &SETTINGS), []);
        assert_eq!(decide(&open[1..], &summary, &SETTINGS).len(), 1);
    }

    #[test]
    fn a_message_says_which_part_is_where_and_how_bad_it_is() {
        let actuator = Actuator {
            id: Id::now(),
            serial_number: "EHA-7".into(),
            tail_number: "I-ELVN".into(),
            location: "left aileron".into(),
            parameter_set: "reference".into(),
            parameter_set_hash: "00".into(),
            thresholds: Thresholds::default(),
            usage_unit: UsageUnit::FlightHours,
            created_at: now(),
            revision: 0,
        };
        let cause = |fault, value, std, threshold| Cause::Threshold {
            fault,
            value,
            value_std: Some(std),
            threshold,
            trace_id: Id::now(),
        };
        assert_eq!(
            message(&actuator, &cause(AlertFault::FdjN, 1012.4, 12.0, 1000.0), 812.0),
            "Actuator EHA-7 (left aileron) of I-ELVN: jack friction (FDJ) has reached its limit of 1000 N; the newest \
             estimate is 1012 N ± 12 N, at 812 flight hours."
        );
        assert_eq!(
            message(&actuator, &cause(AlertFault::Kgm, 0.4123, 0.01, 0.4), 812.25),
            "Actuator EHA-7 (left aileron) of I-ELVN: torque-motor demagnetisation (KGM) has reached its limit of 0.4; the \
             newest estimate is 0.412 ± 0.01, at 812.2 flight hours."
        );
        assert_eq!(
            message(&actuator, &Cause::Risk { risk: 0.1234, limit: 0.1, within: 100.0, trace_id: None }, 10.0),
            "Actuator EHA-7 (left aileron) of I-ELVN: a failure within the next 100 flight hours has a probability of \
             12.3 %, and 10 % is the limit, at 10 flight hours."
        );
        let all_but_certain = Cause::Risk { risk: 0.99997, limit: 0.1, within: 100.0, trace_id: None };
        assert!(message(&actuator, &all_but_certain, 10.0).contains("has a probability of more than 99.9 %, and"));
    }
}
