//! Chapters 5 and 6: what both models do after a step, on a ramp and on a sine.

mod drawn;
mod judged;
mod told;

use super::runs::{each, recipe};
use super::table::Table;
use super::thesis::{FDJ_LEVELS_N, KGM_LEVELS};
use super::{Name, ReproductionError};
use crate::models::drive::Drive;
use crate::models::fault::FDJ_NOMINAL_N;
use crate::models::parameters::ParameterSet;
use crate::models::simulate::{ModelKind, simulate};
use crate::models::trace::{Channel, Trace};
use crate::numeric::watch::Watch;

/// Samples per second of a response: fine enough for its peaks.
const SAMPLE_RATE_HZ: f64 = 1e4;
/// Both models, in the order of their rows.
const MODELS: [(ModelKind, &str); 2] = [(ModelKind::Reference, "reference"), (ModelKind::Monitoring, "monitoring")];
/// The models' places in [`MODELS`].
const REFERENCE: usize = 0;
const MONITORING: usize = 1;
/// The commands' places in [`commands`].
const STEP: usize = 0;
const RAMP: usize = 1;
const SINE: usize = 2;
/// What a family of responses runs over, in the order of chapter 6.
const OVER: [&str; 2] = ["demagnetisation", "friction"];
const OVER_KGM: usize = 0;
const OVER_FDJ: usize = 1;
/// Where a response is steady, s: at the end of the ramp, and 1.1 s after the step, as in section 6.3; the last period of the
/// sine.
const STEADY_S: [(f64, f64); 3] = [(1.09, 1.11), (1.8, 1.9), (0.8, 1.0)];

/// A command of chapters 5 and 6.
struct Command {
    name: &'static str,
    /// In a sentence.
    what: &'static str,
    drive: Drive,
    duration_s: f64,
    /// The sections over KGM and over FDJ, and the first number of their figures, after "6.".
    sections: [(&'static str, usize); 2],
    /// The figure of chapter 5, the command that it shows, in words and in itself.
    nominal: (&'static str, &'static str, Drive),
}

fn commands() -> [Command; 3] {
    let (step, ramp) = (Drive::Step { level_m: 0.1 }, Drive::Ramp { slope_m_per_s: 0.1 });
    let sine = |amplitude_m| Drive::Sine { amplitude_m, frequency_hz: 5.0 };
    // The thesis numbers the figures of 6.2.2 and 6.2.3 like those of 6.1.2 and 6.1.3.
    [
        Command {
            name: "step",
            what: "a step of 0.1 m",
            drive: step.clone(),
            duration_s: 1.5,
            sections: [("6.1.1", 1), ("6.2.1", 16)],
            nominal: ("5.14", "a step of 0.1 m", step),
        },
        Command {
            name: "ramp",
            what: "a ramp of 0.1 m/s",
            drive: ramp.clone(),
            duration_s: 2.0,
            sections: [("6.1.2", 6), ("6.2.2", 6)],
            nominal: ("5.15", "a ramp of 0.1 m/s", ramp),
        },
        Command {
            name: "sine",
            what: "a sine of 0.2 m at 5 Hz",
            drive: sine(0.2),
            duration_s: 1.0,
            sections: [("6.1.3", 11), ("6.2.3", 11)],
            nominal: ("5.16", "a sine of 0.1 m at 5 Hz", sine(0.1)),
        },
    ]
}

/// What a run of chapter 6 was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Case {
    command: usize,
    model: usize,
    /// Whether it is chapter 5's command rather than chapter 6's.
    nominal: bool,
    kgm: f64,
    fdj_n: f64,
}

/// Every run.
struct Responses {
    commands: [Command; 3],
    cases: Vec<Case>,
    traces: Vec<Trace>,
}

impl Responses {
    fn run(set: &ParameterSet, watch: &dyn Watch) -> Result<Self, ReproductionError> {
        let commands = commands();
        let mut cases = Vec::new();
        for command in 0..commands.len() {
            for model in 0..MODELS.len() {
                let case = |nominal, (kgm, fdj_n)| Case { command, model, nominal, kgm, fdj_n };
                cases.push(case(true, level(OVER_KGM, 0)));
                cases.extend((0..KGM_LEVELS.len()).map(|at| case(false, level(OVER_KGM, at))));
                cases.extend((1..FDJ_LEVELS_N.len()).map(|at| case(false, level(OVER_FDJ, at))));
            }
        }
        let traces = each(&cases, watch, |case, quiet| {
            let Command { drive, duration_s, nominal, .. } = &commands[case.command];
            let drive = if case.nominal { &nominal.2 } else { drive }.clone();
            let faults = (case.kgm, case.fdj_n);
            Ok(simulate(&recipe(MODELS[case.model].0, drive, faults, *duration_s, SAMPLE_RATE_HZ), set, quiet)?)
        })?;
        Ok(Self { commands, cases, traces })
    }

    fn find(&self, wanted: Case) -> &Trace {
        let at = self.cases.iter().position(|case| *case == wanted).expect("every level was run");
        &self.traces[at]
    }

    /// Chapter 5's response to a command.
    fn nominal(&self, command: usize, model: usize) -> &Trace {
        self.find(Case { command, model, nominal: true, kgm: 0.0, fdj_n: FDJ_NOMINAL_N })
    }

    /// Chapter 6's responses to a command as one fault grows.
    fn family(&self, command: usize, model: usize, over: usize) -> [&Trace; 5] {
        std::array::from_fn(|at| {
            let (kgm, fdj_n) = level(over, at);
            self.find(Case { command, model, nominal: false, kgm, fdj_n })
        })
    }
}

/// KGM and FDJ at a level of a family.
fn level(over: usize, at: usize) -> (f64, f64) {
    if over == OVER_KGM { (KGM_LEVELS[at], FDJ_NOMINAL_N) } else { (0.0, FDJ_LEVELS_N[at]) }
}

/// The responses: tables 6.1.4 and 6.2.4, rows with peaks and steady values, the thesis's statements, the figures.
pub fn table(set: &ParameterSet, watch: &dyn Watch) -> Result<Table, ReproductionError> {
    let responses = Responses::run(set, watch)?;
    let (rows, notes) = told::rows(&responses);
    let title = "Responses to a step, a ramp and a sine (chapters 5 and 6)";
    let mut table = Table::new(Name::Responses, title, rows, notes);
    table.claims = judged::claims(&responses, set.shared().jack.area_m2);
    table.figures = drawn::figures(&responses);
    Ok(table)
}

/// A quantity that chapter 6 plots, in the order of its figures.
struct Quantity {
    symbol: &'static str,
    channel: Channel,
    label: &'static str,
    unit: &'static str,
    /// From SI to the unit.
    factor: f64,
    /// The names in a row: the value furthest from zero, the steady value, the amplitude.
    rows: [&'static str; 3],
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        symbol: "Cor",
        channel: Channel::ServovalveCurrent,
        label: "current Cor",
        unit: "mA",
        factor: 1e3,
        rows: ["current_peak_ma", "current_steady_ma", "current_amplitude_ma"],
    },
    Quantity {
        symbol: "DXJ",
        channel: Channel::JackVelocity,
        label: "jack velocity DXJ",
        unit: "m/s",
        factor: 1.0,
        rows: ["jack_velocity_peak_m_per_s", "jack_velocity_steady_m_per_s", "jack_velocity_amplitude_m_per_s"],
    },
    Quantity {
        symbol: "P12",
        channel: Channel::LoadPressure,
        label: "load pressure P12",
        unit: "MPa",
        factor: 1e-6,
        rows: ["pressure_peak_mpa", "pressure_steady_mpa", "pressure_amplitude_mpa"],
    },
    Quantity {
        symbol: "XJ",
        channel: Channel::JackPosition,
        label: "jack position XJ",
        unit: "mm",
        factor: 1e3,
        rows: ["jack_position_peak_mm", "jack_position_steady_mm", "jack_position_amplitude_mm"],
    },
    Quantity {
        symbol: "XS",
        channel: Channel::SpoolPosition,
        label: "spool position XS",
        unit: "mm",
        factor: 1e3,
        rows: ["spool_position_peak_mm", "spool_position_steady_mm", "spool_position_amplitude_mm"],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::watch::Unwatched;

    #[test]
    fn every_section_has_its_rows_figures_and_statements() {
        let table = table(&ParameterSet::reference(), &Unwatched).unwrap();
        let sections = ["5.3", "6.1.1", "6.1.2", "6.1.3", "6.1.4", "6.2.1", "6.2.2", "6.2.3", "6.2.4", "7.2"];
        for section in sections {
            assert!(table.claims.iter().any(|claim| claim.section == section), "{section}");
        }
        for section in &sections[..9] {
            let rows: Vec<_> = table.rows.iter().filter(|row| row.labels[0].1 == *section).collect();
            assert!(rows.len() >= 5, "{section}");
        }
        let columns: Vec<&str> = table.figures.iter().map(|figure| figure.id.as_str()).collect();
        let mut unique = columns.clone();
        unique.sort_unstable();
        unique.dedup();
        assert_eq!(unique.len(), columns.len(), "two figures share a file");
        // Figures 5.14 to 5.16, the six sections of chapter 6 for two models, and figures 7.4 to 7.20.
        assert_eq!(columns.len(), 15 + 60 + 15);
    }
}
