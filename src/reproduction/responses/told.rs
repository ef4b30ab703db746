//! The rows: the feature tables that the thesis leaves empty, and what every response peaks and settles at.

use super::{Command, STEP, level};
use super::{
    FDJ_LEVELS_N, KGM_LEVELS, MODELS, OVER, OVER_FDJ, OVER_KGM, QUANTITIES, RAMP, REFERENCE, Responses, SINE, STEADY_S,
};
use crate::models::trace::{Channel, Trace};
use crate::reproduction::claims::{mean, peak, swing};
use crate::reproduction::table::{Comparison, Row};
use crate::reproduction::thesis::TABLE_6_3;

/// The rows, and what to know of them.
pub fn rows(responses: &Responses) -> (Vec<Row>, Vec<String>) {
    let (mut rows, far_percent) = feature_tables(responses);
    let notes = vec![
        format!(
            "The thesis leaves its tables 6.1.4 and 6.2.4 empty; ours are filled, and lie within {far_percent:.3} % of the rows of \
             table 6.3 with the same faults."
        ),
        "The thesis draws its responses and prints no figures of them, so the others are ours alone. Peak: the value furthest \
         from zero. Steady: the mean over 1.09 to 1.11 s of a step and 1.8 to 1.9 s of a ramp. Amplitude: half of the range over \
         the last period of a sine. Sampled at 10 kHz; figures show every tenth sample, details each."
            .into(),
    ];
    for command in 0..responses.commands.len() {
        let (_, what, _) = responses.commands[command].nominal;
        for (model, (_, name)) in MODELS.iter().enumerate() {
            let heading = format!("Section 5.3: {what}, both models without faults");
            let trace = responses.nominal(command, model);
            rows.push(row(
                heading,
                ("5.3", responses.commands[command].name, name),
                level(OVER_KGM, 0),
                measured(trace, command),
            ));
        }
    }
    for (over, fault) in OVER.iter().enumerate() {
        for (command, Command { name, what, sections, .. }) in responses.commands.iter().enumerate() {
            let section = sections[over].0;
            for (model, (_, model_name)) in MODELS.iter().enumerate() {
                for (at, trace) in responses.family(command, model, over).into_iter().enumerate() {
                    let heading = format!("Section {section}: {what}, growing {fault}");
                    rows.push(row(heading, (section, name, model_name), level(over, at), measured(trace, command)));
                }
            }
        }
    }
    for (i, row) in rows.iter_mut().enumerate() {
        row.case = i + 1;
    }
    (rows, notes)
}

/// Tables 6.1.4 and 6.2.4, and how far they are at most from table 6.3, %.
fn feature_tables(responses: &Responses) -> (Vec<Row>, f64) {
    let mut rows = Vec::new();
    let mut far_percent: f64 = 0.0;
    let currents = responses.family(RAMP, REFERENCE, OVER_KGM);
    for (at, trace) in currents.into_iter().enumerate().take(KGM_LEVELS.len()) {
        let current_ma = mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3;
        far_percent = far_percent.max((current_ma / TABLE_6_3[5 * at].0 - 1.0).abs() * 100.0);
        let heading = "Section 6.1.4: the steady current of the ramp, empty in the thesis".into();
        let current = vec![Comparison::feature("current_ma", None, current_ma)];
        rows.push(row(heading, ("6.1.4", "ramp", "reference"), level(OVER_KGM, at), current));
    }
    let pressures = responses.family(STEP, REFERENCE, OVER_FDJ);
    for (at, trace) in pressures.into_iter().enumerate().take(FDJ_LEVELS_N.len()) {
        let pressure_kpa = mean(trace, Channel::LoadPressure, STEADY_S[STEP]) * 1e-3;
        far_percent = far_percent.max((pressure_kpa / TABLE_6_3[at].1 - 1.0).abs() * 100.0);
        let heading = "Section 6.2.4: the steady pressure after the step, empty in the thesis".into();
        let pressure = vec![Comparison::feature("pressure_kpa", None, pressure_kpa)];
        rows.push(row(heading, ("6.2.4", "step", "reference"), level(OVER_FDJ, at), pressure));
    }
    (rows, far_percent)
}

fn row(
    heading: String,
    (section, command, model): (&str, &str, &str),
    (kgm, fdj_n): (f64, f64),
    quantities: Vec<Comparison>,
) -> Row {
    let labels = vec![("section", section.into()), ("command", command.into()), ("model", model.into())];
    Row { heading, case: 0, labels, kgm, fdj_n, quantities }
}

/// What a response peaks and settles at.
fn measured(trace: &Trace, command: usize) -> Vec<Comparison> {
    let mut quantities = Vec::new();
    for q in &QUANTITIES {
        let [peak_name, steady_name, amplitude_name] = q.rows;
        if command == SINE {
            let amplitude = swing(trace, q.channel, STEADY_S[SINE]) / 2.0;
            quantities.push(Comparison::feature(amplitude_name, None, amplitude * q.factor));
        } else {
            let steady = mean(trace, q.channel, STEADY_S[command]);
            quantities.push(Comparison::feature(peak_name, None, peak(trace, q.channel) * q.factor));
            quantities.push(Comparison::feature(steady_name, None, steady * q.factor));
        }
    }
    quantities
}
