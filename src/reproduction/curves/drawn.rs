//! The figures.

use super::{SETTLING, Valve, name};
use crate::characterisation::curves::{CurveModel, Series};
use crate::characterisation::settling::Times;
use crate::reproduction::figure::{Axis, Figure, Line, Look};

const SPOOL: Axis = Axis { label: "spool position XS", unit: "mm", factor: 1e3, column: "spool_position_m" };
const PRESSURE: Axis = Axis { label: "load pressure P12", unit: "MPa", factor: 1e-6, column: "load_pressure_pa" };
const FLOW: Axis = Axis { label: "flow QJ", unit: "cm³/s", factor: 1e6, column: "jack_flow_m3_per_s" };
const TIME: Axis = Axis { label: "settling time", unit: "s", factor: 1.0, column: "settling_time_s" };
const FLOWS: &str = "QJ, cm³/s";
const PRESSURES: &str = "P1, MPa";

/// What a figure of pressures shows, times the supply pressure, where a curve leaves it far behind.
const SHOWN: f64 = 2.5;
/// What a figure near null shows, m, and one of settling times, which are short beyond.
const NEAR_NULL_M: f64 = 60e-6;
const SETTLING_SHOWN_M: f64 = 150e-6;

/// Every figure, in the order of the thesis.
pub fn figures(valve: &Valve) -> Vec<Figure> {
    let valves = "Section 3.2: characteristic curves of the reference model's valve";
    let developed = "Section 5.3: the developed fluid's curves beside the reference model's";
    let pressure = |models: &[CurveModel], id: &str, heading: &str, caption: &str| {
        let series: Vec<Vec<&Series>> = models.iter().map(|&model| valve.pressure(model)).collect();
        curves(&series, (id, heading, caption), FLOWS, PRESSURE, 1e6)
    };
    let flow = |models: &[CurveModel], id: &str, heading: &str, caption: &str| {
        let series: Vec<Vec<&Series>> = models.iter().map(|&model| valve.flow(model)).collect();
        curves(&series, (id, heading, caption), PRESSURES, FLOW, 1e-6)
    };
    let [reference, both] = [&[CurveModel::Reference][..], &[CurveModel::Reference, CurveModel::Developed]];
    let mut beside = pressure(
        both,
        "figure-5.8",
        developed,
        "Figure 5.8, P12 over XS; dashed: the developed fluid. What lies beyond the frame is in the data.",
    );
    beside.y_limits = Some((-SHOWN * valve.supply_pa, SHOWN * valve.supply_pa));
    let open = pressure(reference, "figure-3.4a", valves, "Figures 3.4 a and 4.16, P12 over XS.");
    let near = [
        near_null(&open, "Figures 3.4 a and 4.16, P12 over XS, near null."),
        near_null(&beside, "Figure 5.8, P12 over XS, near null; dashed: the developed fluid."),
    ];
    let [near_open, near_beside] = near;
    vec![
        open,
        flow(reference, "figure-3.4b", valves, "Figures 3.4 b and 4.17, QJ over XS."),
        near_open,
        pressure(
            &[CurveModel::Linear],
            "figure-5.2",
            "Section 5.1: curves of the linear fluid",
            "Figure 5.2, P12 over XS.",
        ),
        pressure(
            &[CurveModel::Evolved],
            "figure-5.5",
            "Section 5.2: curves of the evolved fluid",
            "Figure 5.5, P12 over XS.",
        ),
        beside,
        flow(both, "figure-5.9", developed, "Figure 5.9, QJ over XS; dashed: the developed fluid."),
        near_beside,
        within(map(valve), SETTLING_SHOWN_M),
        within(bell(valve), SETTLING_SHOWN_M),
        within(fitted(valve), SETTLING_SHOWN_M),
    ]
}

/// Curves of one or two models, a constant each; `shown` brings the constant into the legend's unit.
fn curves(
    models: &[Vec<&Series>],
    (id, heading, caption): (&str, &str, &str),
    legend: &'static str,
    y: Axis,
    shown: f64,
) -> Figure {
    let mut lines = Vec::new();
    for (model, series) in models.iter().enumerate() {
        for (at, series) in series.iter().enumerate() {
            let constant = rounded(series.constant * shown);
            let look = if models.len() == 1 { Look::Level(at) } else { Look::LevelOfModel(at, model) };
            lines.push(Line {
                label: if model == 0 { constant.replace('-', "−") } else { String::new() },
                prefix: format!("{}_{}_{constant}", name(series.model), if y == PRESSURE { "qj" } else { "p1" }),
                look,
                values: series.y.clone(),
            });
        }
    }
    figure((id, heading, caption), legend, y, models[0][0].x.clone(), lines)
}

fn figure(
    (id, heading, caption): (&str, &str, &str),
    legend: &'static str,
    y: Axis,
    abscissae: Vec<f64>,
    lines: Vec<Line>,
) -> Figure {
    Figure {
        id: id.into(),
        heading: heading.into(),
        caption: caption.into(),
        legend,
        folded: None,
        y_limits: None,
        x: SPOOL,
        y,
        abscissae,
        lines,
    }
}

/// A constant with one decimal, or none where it is whole.
fn rounded(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), |whole| if whole == "-0" { "0".into() } else { whole.into() })
}

/// The part of a figure around null.
fn within(figure: Figure, reach_m: f64) -> Figure {
    let inside: Vec<usize> = (0..figure.abscissae.len()).filter(|&i| figure.abscissae[i].abs() <= reach_m).collect();
    let part = |values: &[f64]| inside.iter().map(|&i| values[i]).collect();
    let lines = figure.lines.iter().map(|line| Line { values: part(&line.values), ..line.clone() }).collect();
    Figure { abscissae: part(&figure.abscissae), lines, ..figure }
}

/// The same curves around null, for a reader who asks.
fn near_null(of: &Figure, caption: &str) -> Figure {
    let part = within(of.clone(), NEAR_NULL_M);
    Figure { id: format!("{}-near-null", of.id), caption: caption.into(), folded: Some("Near null"), ..part }
}

/// The map: a line per flow.
fn map(valve: &Valve) -> Figure {
    let times = &valve.settling.times;
    let lines = times.iter().enumerate().map(|(at, times)| measured(times, Look::Level(at)));
    figure(
        ("figure-5.10", SETTLING, "Figure 5.10, settling time over XS."),
        FLOWS,
        TIME,
        times[0].spool_position_m.clone(),
        lines.collect(),
    )
}

fn measured(times: &Times, look: Look) -> Line {
    let flow = rounded(times.jack_flow_m3_per_s * 1e6);
    Line {
        label: flow.replace('-', "−"),
        prefix: format!("qj_{flow}"),
        look,
        values: times.settling_s.iter().map(|settling_s| settling_s.unwrap_or(f64::NAN)).collect(),
    }
}

/// The bell's value at a spool position and a flow, s.
fn fit_s(valve: &Valve, spool_position_m: f64, jack_flow_m3_per_s: f64) -> f64 {
    let (bell, growth) = (&valve.settling.bell, &valve.settling.growth);
    let squared = (spool_position_m / valve.settling.spool_saturation_m).powi(2);
    bell.a_s / (bell.b * squared + bell.c) * (1.0 + growth.slope_s_per_m3 * jack_flow_m3_per_s.abs())
}

/// The bell beside the settling times at zero flow.
fn bell(valve: &Valve) -> Figure {
    let times = &valve.settling.times[valve.settling.times.len() / 2];
    let x = &times.spool_position_m;
    let measured = Line { label: "valve".into(), prefix: "valve".into(), ..measured(times, Look::Model(0)) };
    let values = x.iter().map(|&x| fit_s(valve, x, 0.0)).collect();
    let fitted = Line { label: "bell".into(), prefix: "bell".into(), look: Look::Model(1), values };
    figure(
        ("figure-5.11", SETTLING, "Figure 5.11, settling time at zero flow and the bell fitted to it."),
        "",
        TIME,
        x.clone(),
        vec![measured, fitted],
    )
}

/// The map and its fit.
fn fitted(valve: &Valve) -> Figure {
    let times = &valve.settling.times;
    let x = &times[0].spool_position_m;
    // The flows are symmetrical: one side shows both.
    let shown = || times.iter().enumerate().skip(times.len() / 2);
    let mut lines: Vec<Line> = shown().map(|(at, times)| measured(times, Look::LevelOfModel(at, 0))).collect();
    lines.extend(shown().map(|(at, times)| Line {
        label: String::new(),
        prefix: format!("fit_qj_{}", rounded(times.jack_flow_m3_per_s * 1e6)),
        look: Look::LevelOfModel(at, 1),
        values: x.iter().map(|&x| fit_s(valve, x, times.jack_flow_m3_per_s)).collect(),
    }));
    let caption = "Figure 5.12, settling time over XS; dashed: the bell, grown with the flow.";
    figure(("figure-5.12", SETTLING, caption), FLOWS, TIME, x.clone(), lines)
}
