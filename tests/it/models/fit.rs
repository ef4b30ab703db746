//! The fit of the monitoring model to a reference model: on the built-in set, and on actuators quite unlike it.

use std::sync::OnceLock;

use elevon::characterisation::fit::{FitError, fit};
use elevon::characterisation::report::{Fitted, Origin};
use elevon::estimation::{Settings, estimate};
use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::numeric::watch::Unwatched;

/// The built-in set with other values: (section, name, value).
fn set(changes: &[(&str, &str, &str)]) -> ParameterSet {
    let mut text = ParameterSet::reference().to_toml();
    for (section, name, value) in changes {
        let section = text.find(&format!("[{section}]")).unwrap();
        let start = section + text[section..].find(&format!("\n{name} =")).unwrap() + 1;
        let end = start + text[start..].find('\n').unwrap();
        text.replace_range(start..end, &format!("{name} = {value}"));
    }
    ParameterSet::parse(&text).unwrap()
}

fn built_in() -> &'static Fitted {
    static FITTED: OnceLock<Fitted> = OnceLock::new();
    FITTED.get_or_init(|| fit(&ParameterSet::reference(), &Unwatched).unwrap())
}

#[test]
fn recovers_the_built_in_monitoring_model_from_the_built_in_reference_model() {
    let changes = built_in().changes(&ParameterSet::reference(), &[]);
    assert_eq!(changes.len(), 27);
    for change in changes {
        // The leakage's optimum is flat: a tenth of it moves the pressure feature by some 15 Pa. The gain is fitted to
        // the ramp's opening, the built-in one to 0.6 mm; the bias follows the gain.
        let within = match change.name.trim_start_matches("monitoring.") {
            "fluid.flow_gain_m2_per_s" => 0.005,
            "fluid.leakage_m3_per_s_per_pa" => 0.1,
            "fluid.lag_scale_s" => 0.025,
            "bias.current_ratio" => 0.003,
            "bias.current_ratio_std" => 0.1,
            "bias.load_pressure_std_pa" => 0.5,
            _ => 1e-3,
        };
        let old = change.old.unwrap();
        println!("{} {} {}", change.name, old, change.new);
        assert!((change.new / old - 1.0).abs() <= within, "{}: {} was {old}", change.name, change.new);
        assert!(change.origin != Origin::Kept || change.new == old, "{}", change.name);
    }
}

#[test]
fn validate_section_5_3_the_fit_agrees_with_the_reference_model_at_levels_that_it_has_not_seen() {
    let fitted = built_in();
    let [developed, evolved, linear] = &fitted.fluids[..] else { panic!("three fluids") };
    let worst = |fluid: &elevon::characterisation::report::FluidResiduals| {
        (fluid.worst(|r| r.current_percent), fluid.worst(|r| r.pressure_percent))
    };
    println!("{:?} {:?} {:?} {:?}", fitted.zero_flow, worst(developed), worst(evolved), worst(linear));
    assert!(fitted.zero_flow.rms_of_supply < 0.03);
    assert!(worst(developed).0 < 1.2 && worst(developed).1 < 0.01);
    assert!(worst(evolved).0 < 1.5 && worst(evolved).1 < 0.1);
    assert!(worst(linear).0 < 6.0 && worst(linear).1 < 0.1 && linear.limited_by_time_step);
}

/// A fit of an actuator, and the faults found with it in a trace of that actuator's reference model.
fn assert_fits(changes: &[(&str, &str, &str)]) {
    let set = set(changes);
    let fitted = fit(&set, &Unwatched).unwrap();
    let developed = &fitted.fluids[0];
    let (current, pressure) = (developed.worst(|r| r.current_percent), developed.worst(|r| r.pressure_percent));
    println!("{changes:?}: {current} % {pressure} %");
    assert!(current < 3.0 && pressure < 0.1, "{changes:?}: {current} % {pressure} %");
    assert_eq!(fitted.set.reference_model(), set.reference_model(), "the reference model stays");
    assert_eq!(ParameterSet::parse(&fitted.set.to_toml()).as_ref(), Ok(&fitted.set));
    let faults = Faults { kgm: 0.22, fdj_n: 640.0, ..Faults::default() };
    let recipe = Simulation::new(ModelKind::Reference, Drive::Diagnostic, faults, 6.0, 1000.0);
    let trace = simulate(&recipe, &set, &Unwatched).unwrap();
    let found = estimate(&trace, &fitted.set, &Settings::default(), &Unwatched).unwrap();
    let (kgm, fdj_n) = (found.kgm.unwrap(), found.fdj_n.unwrap());
    println!("{kgm} {fdj_n}");
    assert!((kgm - 0.22).abs() < 0.005 && (fdj_n - 640.0).abs() < 2.0, "{changes:?}: {kgm} {fdj_n}");
}

#[test]
fn recovers_faults_of_a_jack_twice_as_large_with_ports_twice_as_wide() {
    assert_fits(&[
        ("jack", "area_m2", "1.6e-3"),
        ("jack", "mass_kg", "25.0"),
        ("reference.fluid", "port_width_m", "3e-3"),
    ]);
}

#[test]
fn recovers_faults_of_an_underlapped_valve() {
    assert_fits(&[
        ("reference.fluid", "overlap_supply_m", "-5e-6"),
        ("reference.fluid", "overlap_return_m", "-5e-6"),
        ("controller", "proportional_gain_a_per_m", "0.45"),
    ]);
}

#[test]
fn recovers_faults_of_an_unevenly_lapped_valve_at_a_higher_supply() {
    assert_fits(&[
        ("reference.fluid", "supply_pressure_pa", "28.6e6"),
        ("reference.fluid", "overlap_supply_m", "20e-6"),
        ("reference.fluid", "overlap_return_m", "10e-6"),
        ("reference.first_stage", "mass_kg", "4e-3"),
    ]);
}

#[test]
fn an_actuator_that_does_not_show_the_features_is_told_with_every_level_and_the_reason() {
    let refused = |section, name, value| match fit(&set(&[(section, name, value)]), &Unwatched) {
        Err(FitError::Levels(errors)) => errors.iter().map(ToString::to_string).collect::<Vec<_>>(),
        other => panic!("{other:?}"),
    };
    let errors = refused("torque_motor", "current_max_a", "0.012");
    assert!(errors.len() < 41 && errors[0].contains("KGM 0.2") && errors[0].contains("saturates"), "{errors:?}");
    let errors = refused("jack", "position_max_m", "0.15");
    assert!(errors.len() == 41 && errors.iter().all(|e| e.contains("the ramp cannot be followed")), "{errors:?}");
    let errors = refused("reference.torque_motor", "current_offset_a", "0.015");
    assert!(errors.len() == 41 && errors.iter().all(|e| e.contains("expected 0.08 to 0.12")), "{errors:?}");
    let errors = refused("jack", "mass_kg", "0.5");
    assert!(errors.len() < 41 && errors.iter().all(|e| e.contains("it rests")), "{errors:?}");
}

#[test]
fn a_valve_without_a_pressure_gain_is_told() {
    let error = fit(&set(&[("reference.fluid", "leakage_m3_per_s_per_pa", "1e-9")]), &Unwatched).unwrap_err();
    assert!(matches!(error, FitError::NoValue { .. }), "{error}");
    assert!(error.to_string().starts_with("monitoring.fluid.spool_saturation_m: no value fits"), "{error}");
}

#[test]
fn determinism_a_fit_is_the_same_on_any_number_of_threads() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(&pool.install(|| fit(&ParameterSet::reference(), &Unwatched).unwrap()), built_in());
}
