//! The trace objective: any command, every recorded channel, more faults than two.

use std::collections::BTreeMap;

use elevon::estimation::request::Objective;
use elevon::estimation::{Estimate, Settings, Verdict, estimate};
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Quantity, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::watch::Unwatched;

fn recipe(command: &str, faults: Faults, duration_s: f64) -> Simulation {
    Simulation::new(ModelKind::Reference, command.parse().unwrap(), faults, duration_s, 1000.0)
}

fn run(recipe: &Simulation) -> Trace {
    simulate(recipe, &ParameterSet::reference(), &Unwatched).unwrap()
}

/// The trace with these channels only.
fn only(trace: &Trace, channels: &[Channel]) -> Trace {
    let kept: BTreeMap<Channel, Vec<f64>> =
        channels.iter().map(|channel| (*channel, trace.channel(*channel).unwrap().to_vec())).collect();
    Trace::try_new(trace.time_s().to_vec(), kept, Vec::new()).unwrap()
}

const USUAL: [Channel; 4] =
    [Channel::PositionCommand, Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition];

fn estimated(trace: &Trace, faults: &str) -> Estimate {
    let settings = Settings { faults: faults.parse().unwrap(), objective: Objective::Trace, ..Settings::default() };
    estimate(trace, &ParameterSet::reference(), &settings, &Unwatched).unwrap()
}

fn assert_near(found: &Estimate, truth: &Faults, kgm: f64, fdj: f64) {
    assert_eq!(found.verdict, Verdict::Conclusive, "{found:?}");
    assert!((found.kgm.unwrap() - truth.kgm).abs() < kgm, "{truth:?}: {found:?}");
    assert!((found.fdj_n.unwrap() / truth.fdj_n - 1.0).abs() < fdj, "{truth:?}: {found:?}");
}

#[test]
fn sequences_and_sines_show_both_faults() {
    let (sequence, sine) = ("sequence:0.04@0,-0.03@0.5,0.02@1,-0.05@1.5,0@2", "sine:0.05@0.4");
    for (command, kgm, fdj_n) in [(sequence, 0.07, 350.0), (sequence, 0.38, 870.0), (sine, 0.22, 260.0)] {
        let truth = Faults { kgm, fdj_n, ..Faults::default() };
        assert_near(&estimated(&only(&run(&recipe(command, truth, 4.0)), &USUAL), "kgm,fdj"), &truth, 0.005, 0.01);
    }
}

#[test]
fn a_leak_is_told_from_demagnetisation_and_named_when_it_was_not_asked_for() {
    let truth = Faults { kgm: 0.2, fdj_n: 450.0, clearance_m: 25e-6, ..Faults::default() };
    let trace = run(&recipe("diagnostic", truth, 6.0));
    let found = estimated(&only(&trace, &USUAL), "kgm,fdj,clearance");
    assert_near(&found, &truth, 0.005, 0.01);
    assert!((found.faults["clearance_m"].unwrap() - 25e-6).abs() < 1e-6, "{found:?}");
    let blind = estimate(&trace, &ParameterSet::reference(), &Settings::default(), &Unwatched).unwrap();
    assert_eq!((blind.verdict, blind.objective.as_str()), (Verdict::Inconclusive, "trace"), "{blind:?}");
    assert!(blind.reasons.iter().any(|reason| reason.contains("spool_position_m")), "{blind:?}");
}

#[test]
fn noise_under_a_recorded_load_and_supply_does_no_harm() {
    let truth = Faults { kgm: 0.15, fdj_n: 500.0, ..Faults::default() };
    let quiet = recipe("diagnostic", truth, 6.0);
    let recipe = Simulation {
        noise_power_ma2_s: 5e-6,
        external_load_n: Some(Quantity::Constant(800.0)),
        supply_pressure_pa: Some(Quantity::Constant(19e6)),
        ..quiet
    };
    let outside = [Channel::ExternalLoad, Channel::SupplyPressure];
    let trace = only(&run(&recipe), &[USUAL.as_slice(), outside.as_slice()].concat());
    assert_near(&estimated(&trace, "kgm,fdj"), &truth, 0.005, 0.01);
}

#[test]
fn clogging_play_and_offset_are_estimated_when_asked_for() {
    let truth = Faults { kgm: 0.1, fdj_n: 400.0, current_offset_a: 1e-3, ..Faults::default() };
    let found = estimated(&only(&run(&recipe("diagnostic", truth, 6.0)), &USUAL), "kgm,fdj,current_offset");
    assert_near(&found, &truth, 0.005, 0.01);
    assert!((found.faults["current_offset_a"].unwrap() - 1e-3).abs() < 5e-5, "{found:?}");
    let truth = Faults { kgm: 0.1, fdj_n: 400.0, clogging: 0.3, ..Faults::default() };
    let found = estimated(&run(&recipe("diagnostic", truth, 6.0)), "kgm,fdj,clogging");
    assert_near(&found, &truth, 0.005, 0.01);
    assert!((found.faults["clogging"].unwrap() - 0.3).abs() < 0.03, "{found:?}");
}

#[test]
fn play_in_the_feedback_spring_is_estimated_from_small_motions_and_what_does_not_settle_is_null() {
    let truth = Faults { kgm: 0.1, fdj_n: 400.0, feedback_backlash_m: 5e-6, ..Faults::default() };
    let small = "sequence:0.01@0,-0.01@0.5,0.008@1,-0.008@1.5,0.005@2,-0.005@2.5";
    let found = estimated(&only(&run(&recipe(small, truth, 3.5)), &USUAL), "kgm,fdj,feedback_backlash");
    assert_near(&found, &truth, 0.005, 0.01);
    assert!((found.faults["feedback_backlash_m"].unwrap() - 5e-6).abs() < 5e-7, "{found:?}");
    let everything = "kgm,fdj,clearance,clogging,feedback_backlash,current_offset";
    let found = estimated(&run(&recipe("diagnostic", truth, 6.0)), everything);
    assert_near(&found, &truth, 0.005, 0.01);
    assert_eq!((found.faults["feedback_backlash_m"], found.faults["clogging"]), (None, None), "{found:?}");
    assert!(found.reasons.iter().any(|reason| reason.contains("clogging") && reason.contains("settle")), "{found:?}");
}

#[test]
fn what_was_not_asked_for_is_null_and_another_actuator_is_not_believed() {
    let truth = Faults { kgm: 0.0, fdj_n: 500.0, ..Faults::default() };
    let trace = run(&recipe("diagnostic", truth, 6.0));
    let found = estimated(&only(&trace, &USUAL), "fdj");
    assert_eq!((found.kgm, found.kgm_std), (None, None), "{found:?}");
    assert!((found.fdj_n.unwrap() / 500.0 - 1.0).abs() < 0.01, "{found:?}");
    let slower = [("controller.proportional_gain_a_per_m".to_owned(), "0.45".to_owned())];
    let set = ParameterSet::reference().with(&slower).unwrap();
    let settings = Settings { objective: Objective::Trace, ..Settings::default() };
    let foreign = estimate(&only(&trace, &USUAL), &set, &settings, &Unwatched).unwrap();
    assert_eq!(foreign.verdict, Verdict::Inconclusive, "{foreign:?}");
}
