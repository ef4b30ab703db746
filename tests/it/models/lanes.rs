//! What runs in lanes against the same in plain numbers: the optimiser's large step, the reference model's passages.

use std::collections::BTreeMap;

use elevon::estimation::evaluate::{Evaluator, Proposal};
use elevon::estimation::{features, manoeuvre};
use elevon::models::blocks::Input;
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::reference::Model;
use elevon::models::simulate::ModelKind;
use elevon::models::trace::{Channel, Trace};

use super::table_6_3::{diagnostic, features};

fn evaluator() -> Evaluator {
    let rate_hz = 1000.0;
    let time_s: Vec<f64> = (0..=6000).map(|k| f64::from(k) / rate_hz).collect();
    let command_m = time_s.iter().map(|&t| elevon::models::drive::Drive::Diagnostic.position_m(t, 6.0)).collect();
    let silent = [Channel::ServovalveCurrent, Channel::LoadPressure].map(|c| (c, vec![0.0; 6001]));
    let channels = BTreeMap::from_iter(silent.into_iter().chain([(Channel::PositionCommand, command_m)]));
    let trace = Trace::try_new(time_s, channels, Vec::new()).unwrap();
    let found = manoeuvre::find(trace.time_s(), trace.position_command_m());
    let measured = features::measure(&trace, &found, &ParameterSet::reference().shared()).unwrap();
    Evaluator::new(&trace, &measured, &ParameterSet::reference())
}

#[test]
fn parity_a_candidate_s_features_do_not_depend_on_its_neighbours() {
    let evaluator = evaluator();
    let proposal = |i: u32| Proposal { kgm: f64::from(i % 9) * 0.11, fdj_n: 200.0 + 41.0 * f64::from(i) };
    let all: Vec<Proposal> = (0..43).map(proposal).collect();
    let together = evaluator.features(&all);
    for size in [1, 3, 8, 17, 40] {
        let apart: Vec<_> = all.chunks(size).flat_map(|part| evaluator.features(part)).collect();
        assert_eq!(together, apart, "in parts of {size}");
    }
}

#[test]
fn validate_the_large_step_gives_the_features_of_the_fine_one() {
    let evaluator = evaluator();
    let mut worst = (0.0_f64, 0.0_f64);
    for (kgm, fdj_n) in [(0.0, 200.0), (0.0, 1000.0), (0.2, 600.0), (0.4, 200.0), (0.4, 1000.0), (0.6, 2000.0)] {
        let (current_ma, pressure_kpa) = features(&diagnostic(ModelKind::Monitoring, kgm, fdj_n));
        let large = evaluator.features(&[Proposal { kgm, fdj_n }])[0];
        let current = (large.servovalve_current_a * 1e3 / current_ma - 1.0).abs();
        let pressure = (large.load_pressure_pa * 1e-3 / pressure_kpa - 1.0).abs();
        println!("{kgm} {fdj_n}: {current:.2e} {pressure:.2e}");
        worst = (worst.0.max(current), worst.1.max(pressure));
    }
    assert!(worst.0 < 1e-4 && worst.1 < 1e-4, "{worst:?}");
}

#[test]
fn parity_a_simulation_gives_the_bits_of_the_reference_model_in_plain_numbers() {
    // The time loop has the passages in a register of four where the processor has such; this loop never has.
    let faults = Faults { kgm: 0.2, fdj_n: 800.0, ..Faults::default() };
    let set = ParameterSet::reference();
    let model = Model::new(&set.shared(), set.reference_model(), &faults);
    let trace = super::faults::run(&set, faults, "diagnostic", 5.0);
    let columns = [Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition, Channel::JackVelocity];
    let mut s = model.start();
    for step in 0..=500_000_u32 {
        s = model.step(&s, &Input::command(Drive::Diagnostic.position_m(f64::from(step) / 1e5, 6.0)));
        if step % 100 == 0 {
            let plain =
                [s.torque_motor.current_a, s.pipe.load_pressure_pa(), s.jack.measured_m, s.jack.velocity_m_per_s];
            let recorded = columns.map(|channel| trace.channel(channel).unwrap()[step as usize / 100]);
            assert_eq!(plain.map(f64::to_bits), recorded.map(f64::to_bits), "step {step}");
        }
    }
}
