//! The diagnostic command by the fine step in plain numbers, and the same as the optimiser runs it: for the tests, and for
//! `benches/sweep.rs`.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use elevon::estimation::evaluate::Evaluator;
use elevon::estimation::features::{Features, measure};
use elevon::estimation::manoeuvre::find;
use elevon::models::blocks::Input;
use elevon::models::drive::Drive;
use elevon::models::monitoring::{Model, State};
use elevon::models::parameters::ParameterSet;
use elevon::models::trace::{Channel, Trace};

/// The diagnostic command by its samples at 1 kHz, as a trace that shows nothing.
pub fn trace() -> Trace {
    let time_s: Vec<f64> = (0..=6000).map(|k| f64::from(k) * 1e-3).collect();
    let command_m = time_s.iter().map(|&t| Drive::Diagnostic.position_m(t, 6.0)).collect();
    let silent = [Channel::ServovalveCurrent, Channel::LoadPressure].map(|c| (c, vec![0.0; 6001]));
    let channels = BTreeMap::from_iter(silent.into_iter().chain([(Channel::PositionCommand, command_m)]));
    Trace::try_new(time_s, channels, Vec::new()).unwrap()
}

/// What runs candidates on that command.
pub fn evaluator() -> Evaluator {
    let trace = trace();
    let measured =
        measure(&trace, &find(trace.time_s(), trace.position_command_m()), &ParameterSet::reference().shared())
            .unwrap();
    Evaluator::new(&trace, &measured, &ParameterSet::reference())
}

/// The features of a candidate by the semi-implicit step at so many steps a second.
pub fn features(kgm: f64, fdj_n: f64, steps_per_s: u32) -> Features {
    let set = ParameterSet::reference();
    let model = Model::new(&set.shared(), set.monitoring_model());
    let candidate = model.candidate(kgm, fdj_n);
    let window = |hundredths: RangeInclusive<u32>| {
        hundredths.start() * (steps_per_s / 100)..=hundredths.end() * (steps_per_s / 100)
    };
    let windows = [window(180..=190), window(509..=511)];
    let (mut s, mut sums) = (State::<f64>::start((), 0.0), [[0.0; 2]; 2]);
    for step in 0..=*windows[1].end() {
        let command_m = Drive::Diagnostic.position_m(f64::from(step) / f64::from(steps_per_s), 6.0);
        s = model.step(&candidate, &s, &Input::command(command_m), 1.0 / f64::from(steps_per_s));
        for (window, sum) in windows.iter().zip(&mut sums) {
            if window.contains(&step) {
                sum[0] += s.servovalve_current_a;
                sum[1] += s.load_pressure_pa;
            }
        }
    }
    let mean =
        |window: usize, of: usize| sums[window][of] / f64::from(windows[window].end() - windows[window].start() + 1);
    Features {
        servovalve_current_a: mean(0, 0),
        load_pressure_pa: mean(1, 1),
        ramp_pressure_pa: mean(0, 1),
        step_current_a: mean(1, 0),
    }
}

/// How far features are from those of the fine step: the two that are searched for relative to themselves, the ramp's
/// pressure and the current after the step relative to the other pressure and the other current.
pub fn errors(found: &Features, fine: &Features) -> [f64; 4] {
    let relative = |found: f64, fine: f64, scale: f64| ((found - fine) / scale).abs();
    [
        relative(found.servovalve_current_a, fine.servovalve_current_a, fine.servovalve_current_a),
        relative(found.load_pressure_pa, fine.load_pressure_pa, fine.load_pressure_pa),
        relative(found.ramp_pressure_pa, fine.ramp_pressure_pa, fine.load_pressure_pa),
        relative(found.step_current_a, fine.step_current_a, fine.servovalve_current_a),
    ]
}
