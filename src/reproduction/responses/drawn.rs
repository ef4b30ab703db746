//! The figures.

use super::{MODELS, OVER, OVER_FDJ, OVER_KGM, QUANTITIES, Quantity, RAMP, REFERENCE, Responses, STEP, level};
use crate::models::trace::Trace;
use crate::numeric::statistics::window;
use crate::reproduction::figure::{Axis, Figure, Line, Look};
use crate::reproduction::runs::values;

const TIME: Axis = Axis { label: "time", unit: "s", factor: 1.0, column: "time_s" };
/// Of so many samples a figure shows one.
const EVERY: usize = 10;
/// What a detail shows, s: a part of the end of the ramp.
const DETAIL_S: (f64, f64) = (1.85, 1.9);

/// The samples that a figure shows.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    /// All the time, with fewer samples.
    Whole,
    /// A short time, with every sample.
    Detail,
}

impl Shown {
    fn of(self, trace: &Trace, values: &[f64]) -> Vec<f64> {
        match self {
            Self::Whole => values.iter().step_by(EVERY).copied().collect(),
            Self::Detail => values[window(trace.time_s(), DETAIL_S.0, DETAIL_S.1)].to_vec(),
        }
    }
}

/// Every figure: chapter 5's, then chapter 6's, then those of section 7.2.
pub fn figures(responses: &Responses) -> Vec<Figure> {
    let mut figures = Vec::new();
    for command in 0..responses.commands.len() {
        figures.extend(QUANTITIES.iter().map(|quantity| nominal(responses, command, quantity)));
    }
    for over in 0..OVER.len() {
        for command in 0..responses.commands.len() {
            for model in 0..MODELS.len() {
                figures.extend((0..QUANTITIES.len()).map(|at| family(responses, command, over, model, at)));
            }
        }
    }
    // The captions of the thesis count on from 7.4 and use 7.16 twice; the figure of 400 N (7.11) is in its index only.
    for (command, over, quantity, first) in [(RAMP, OVER_KGM, 0, 4), (STEP, OVER_FDJ, 2, 10), (RAMP, OVER_FDJ, 0, 16)] {
        figures.extend((0..5).map(|at| beside(responses, command, over, &QUANTITIES[quantity], (first, at))));
    }
    figures
}

fn axis(quantity: &Quantity) -> Axis {
    let Quantity { label, unit, factor, channel, .. } = *quantity;
    Axis { label, unit, factor, column: channel.column() }
}

fn line(shown: Shown, trace: &Trace, quantity: &Quantity, label: String, prefix: String, look: Look) -> Line {
    Line { label, prefix, look, values: shown.of(trace, values(trace, quantity.channel)) }
}

/// Both models' lines.
fn of_models(traces: [&Trace; 2], quantity: &Quantity) -> Vec<Line> {
    let models = MODELS.iter().zip(traces).enumerate();
    models
        .map(|(model, ((_, name), trace))| {
            line(Shown::Whole, trace, quantity, format!("{name} model"), (*name).into(), Look::Model(model))
        })
        .collect()
}

fn nominal(responses: &Responses, command: usize, quantity: &Quantity) -> Figure {
    let (number, what, _) = &responses.commands[command].nominal;
    let traces = [0, 1].map(|model| responses.nominal(command, model));
    Figure {
        id: format!("figure-{number}-{}", quantity.symbol.to_lowercase()),
        heading: format!("Section 5.3: {what}, both models without faults"),
        caption: format!("Figure {number}, {}: {what}.", quantity.symbol),
        legend: "",
        folded: None,
        y_limits: None,
        x: TIME,
        y: axis(quantity),
        abscissae: Shown::Whole.of(traces[0], traces[0].time_s()),
        lines: of_models(traces, quantity),
    }
}

fn family(responses: &Responses, command: usize, over: usize, model: usize, at: usize) -> Figure {
    let quantity = &QUANTITIES[at];
    let of = &responses.commands[command];
    let (section, first) = of.sections[over];
    let (model_name, number, symbol) = (MODELS[model].1, first + at, quantity.symbol);
    let traces = responses.family(command, model, over);
    // The thesis calls its figures 6.7 and 6.8 of section 6.2.2 details: the jack may stick and slip too fast for a whole ramp.
    let is_detail = (command, over) == (RAMP, OVER_FDJ) && ["DXJ", "P12"].contains(&symbol);
    let (shown, detail) = if is_detail { (Shown::Detail, " (detail)") } else { (Shown::Whole, "") };
    let lines = traces.iter().enumerate().map(|(at, trace)| {
        let (kgm, fdj_n) = level(over, at);
        let (label, prefix) = if over == OVER_KGM {
            (format!("{kgm}"), format!("kgm_{kgm}"))
        } else {
            (format!("{fdj_n}"), format!("fdj_{fdj_n}_n"))
        };
        line(shown, trace, quantity, label, prefix, Look::Level(at))
    });
    Figure {
        id: format!("figure-6.{number}-section-{section}-{}-{model_name}", symbol.to_lowercase()),
        heading: format!("Section {section}: {}, growing {}", of.what, OVER[over]),
        caption: format!("Figure 6.{number} of section {section}, {symbol}{detail}: {}, {model_name} model.", of.what),
        legend: if over == OVER_KGM { "KGM" } else { "FDJ, N" },
        folded: (model != REFERENCE).then_some("The same by the monitoring model"),
        y_limits: None,
        x: TIME,
        y: axis(quantity),
        abscissae: shown.of(traces[0], traces[0].time_s()),
        lines: lines.collect(),
    }
}

/// Both models beside each other at one level of a fault.
fn beside(
    responses: &Responses,
    command: usize,
    over: usize,
    quantity: &Quantity,
    (first, at): (usize, usize),
) -> Figure {
    let of = &responses.commands[command];
    let traces = [0, 1].map(|model| responses.family(command, model, over)[at]);
    let (kgm, fdj_n) = level(over, at);
    let fault = if over == OVER_KGM { format!("KGM {kgm}") } else { format!("FDJ {fdj_n} N") };
    let (number, symbol) = (first + at, quantity.symbol);
    Figure {
        id: format!("figure-7.{number}-{}", symbol.to_lowercase()),
        heading: format!("Section 7.2: {symbol} after {}, both models, growing {}", of.what, OVER[over]),
        caption: format!("Figure 7.{number}, {symbol}: {}, {fault}.", of.what),
        legend: "",
        folded: Some("Both models at each of the five levels"),
        y_limits: None,
        x: TIME,
        y: axis(quantity),
        abscissae: Shown::Whole.of(traces[0], traces[0].time_s()),
        lines: of_models(traces, quantity),
    }
}
