//! Every parameter that switches an effect on moves the signals as the thesis says. What one block shows alone is tested
//! there: the threshold and the magnetic circuit, the capacities' memory of vapour, the quantizer's step.

use serde_json::Value as Json;

use elevon::models::blocks::Input;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::reference::{Model, State, passages, pipe, second_stage};
use elevon::models::trace::{Channel, Trace};

use super::faults::{falls, mean, passes, rises, run};

/// The built-in set with other values.
fn set_with<V: Into<Json>>(changes: impl IntoIterator<Item = (&'static str, V)>) -> ParameterSet {
    let mut json = ParameterSet::reference().to_json();
    for (name, value) in changes {
        *json.pointer_mut(&format!("/{}", name.replace('.', "/"))).expect("a parameter") = value.into();
    }
    ParameterSet::from_json("other", &json).unwrap()
}

fn healthy(set: &ParameterSet, command: &str, duration_s: f64) -> Trace {
    run(set, Faults::default(), command, duration_s)
}

/// The mean current at the end of the diagnostic ramp, A.
fn ramp_current_a(set: &ParameterSet) -> f64 {
    mean(&healthy(set, "ramp:0.1", 2.0), Channel::ServovalveCurrent, 1.8, 1.9)
}

fn fluid(change: impl FnOnce(&mut passages::Params)) -> passages::Params {
    let mut fluid = ParameterSet::reference().reference_model().fluid;
    change(&mut fluid);
    fluid
}

/// The load pressure that a held spool settles to while nothing flows, Pa.
fn settled_pa(fluid: &passages::Params, spool_m: f64) -> f64 {
    let (valve, capacities) = (passages::Block::new(fluid), pipe::Block::new(fluid));
    let mut s = pipe::State::at_rest(0.5 * (fluid.supply_pressure_pa + fluid.return_pressure_pa));
    for _ in 0..200_000 {
        let flows = valve.step(spool_m, fluid.supply_pressure_pa, s.port_1_pa, s.port_2_pa);
        s = capacities.step(&s, &flows, 0.0, 1e-5);
    }
    s.load_pressure_pa()
}

/// The flow into chamber 1 of a held spool without load, m³/s.
fn free_flow(fluid: &passages::Params, spool_m: f64) -> f64 {
    let middle_pa = 0.5 * (fluid.supply_pressure_pa + fluid.return_pressure_pa);
    let flows = passages::Block::new(fluid).step(spool_m, fluid.supply_pressure_pa, middle_pa, middle_pa);
    flows.supply_to_1 - flows.from_1_to_return
}

/// The leakage of a centred valve from supply to return, m³/s.
fn null_leakage(fluid: &passages::Params) -> f64 {
    let middle_pa = 0.5 * (fluid.supply_pressure_pa + fluid.return_pressure_pa);
    let flows = passages::Block::new(fluid).step(0.0, fluid.supply_pressure_pa, middle_pa, middle_pa);
    flows.supply_to_1 + flows.supply_to_2
}

fn lapped(overlap_m: f64) -> passages::Params {
    // A tight clearance, a tight piston and turbulent flow, so that the lap and nothing else shows.
    fluid(|p| {
        (p.overlap_supply_m, p.overlap_return_m) = (overlap_m, overlap_m);
        (p.radial_clearance_m, p.transition_reynolds) = (1e-6, 0.0);
        (p.leakage_m3_per_s_per_pa, p.chamber_volume_m3) = (0.0, 1e-6);
    })
}

#[test]
fn validate_section_3_2_1_a_valve_without_lap_answers_at_once_and_in_proportion() {
    let flows: Vec<f64> = [20e-6, 40e-6, 80e-6].map(|x| free_flow(&lapped(0.0), x)).into();
    assert!((flows[1] / flows[0] - 2.0).abs() < 0.15 && (flows[2] / flows[1] - 2.0).abs() < 0.15, "{flows:?}");
}

#[test]
fn validate_section_3_2_1_an_overlap_leaks_less_and_has_a_dead_zone() {
    let overlapped = lapped(20e-6);
    assert!(null_leakage(&overlapped) < 0.1 * null_leakage(&lapped(0.0)));
    let (inside, outside) = (free_flow(&overlapped, 15e-6), free_flow(&overlapped, 40e-6));
    assert!(inside < 0.02 * outside, "{inside} {outside}");
    assert!((outside / free_flow(&lapped(0.0), 20e-6) - 1.0).abs() < 0.1, "beyond it, as without lap from its edge");
}

#[test]
fn validate_section_3_2_1_an_underlap_leaks_more_and_answers_with_less_pressure_and_more_flow() {
    let (zero, under) = (lapped(0.0), lapped(-20e-6));
    assert!(null_leakage(&under) > 5.0 * null_leakage(&zero));
    let pressures = [&under, &zero].map(|p| settled_pa(p, 2e-6));
    assert!(pressures[0] < 0.5 * pressures[1], "the pressure gain at null: {pressures:?}");
    // Both edges of a chamber work until one has closed.
    let gains = [&under, &zero].map(|p| free_flow(p, 10e-6));
    assert!(gains[0] > 1.5 * gains[1], "the flow gain at null: {gains:?}");
}

#[test]
fn validate_section_4_1_3_wear_and_eccentricity_of_the_sleeve_let_more_oil_through() {
    let worn = [1.0, 1.5, 2.0].map(|factor| null_leakage(&fluid(|p| p.clearance_factor = factor)));
    assert!(rises(&worn), "Khsv: {worn:?}");
    let extra = null_leakage(&fluid(|p| p.clearance_extra_m = p.radial_clearance_m));
    assert!((extra / worn[2] - 1.0).abs() < 1e-12, "the same gap by either parameter: {extra} {worn:?}");
    let covered = |eccentricity_ratio: f64| {
        null_leakage(&fluid(|p| {
            (p.overlap_supply_m, p.overlap_return_m, p.radial_clearance_m) = (1e-3, 1e-3, 2e-6);
            p.eccentricity_ratio = eccentricity_ratio;
        }))
    };
    let gain = covered(1.0) / covered(0.0);
    assert!((gain / 2.5 - 1.0).abs() < 0.01, "1 + 3/2 (e/c)² where the flow is laminar: {gain}");
    let currents =
        [1.0, 2.0, 4.0].map(|factor| ramp_current_a(&set_with([("reference.fluid.clearance_factor", factor)])));
    assert!(rises(&currents), "{currents:?}");
}

#[test]
fn validate_section_4_1_3_a_leaking_piston_takes_more_current() {
    let leakages = [5.69e-14, 1e-11, 3e-11];
    let currents = leakages.map(|clk| ramp_current_a(&set_with([("reference.fluid.leakage_m3_per_s_per_pa", clk)])));
    assert!(rises(&currents), "{currents:?}");
}

#[test]
fn validate_section_4_1_3_a_warmer_oil_leaks_more() {
    let at = |oil: &str, celsius: f64| {
        let oil =
            [("reference.oil.oil", Json::from(oil)), ("reference.oil.temperature_k", Json::from(celsius + 273.15))];
        let set = set_with(oil);
        let properties = set.reference_model().oil.properties(passages_oil(&set));
        null_leakage(&fluid(|p| {
            (p.density_kg_per_m3, p.kinematic_viscosity_m2_per_s) =
                (properties.density_kg_per_m3, properties.kinematic_viscosity_m2_per_s);
        }))
    };
    for oil in ["mil_prf_5606", "mil_prf_83282"] {
        let leakages = [-40.0, 0.0, 40.0, 100.0].map(|celsius| at(oil, celsius));
        assert!(rises(&leakages), "{oil}: {leakages:?}");
    }
}

fn passages_oil(set: &ParameterSet) -> elevon::models::reference::oil::Properties {
    let p = set.reference_model().fluid;
    elevon::models::reference::oil::Properties {
        density_kg_per_m3: p.density_kg_per_m3,
        kinematic_viscosity_m2_per_s: p.kinematic_viscosity_m2_per_s,
    }
}

#[test]
fn validate_section_4_1_2_the_supply_scales_the_first_stage_s_pressure_gain_and_the_root_of_it_its_flow_gain() {
    let mut p = ParameterSet::reference().reference_model().second_stage;
    (p.damping_n_s_per_m, p.friction_dynamic_n, p.friction_static_n) = (0.0, 0.0, 0.0);
    let speed = |supply_factor: f64| {
        let block = second_stage::Block::new(&p, p.nominal_pressure_differential_pa);
        block.step(&second_stage::State::default(), 1e-6, 0.0, supply_factor, 1e-6).velocity_m_per_s
    };
    assert!((speed(0.25) / speed(1.0) - 0.5).abs() < 1e-12, "GQF by the root of PSR");
    // The flow force that the nozzles' pressure just bears tells GPF.
    let held = |supply_factor: f64, jack_flow: f64| {
        let block = second_stage::Block::new(&p, p.nominal_pressure_differential_pa);
        let s = block.step(&second_stage::State::default(), 1e-6, jack_flow, supply_factor, 1e-6);
        s.velocity_m_per_s > 0.0
    };
    let most = p.end_area_m2 * p.pressure_gain_pa_per_m * 1e-6 / p.flow_force_n_s_per_m3;
    assert!(held(1.0, 0.99 * most) && !held(1.0, 1.01 * most), "GPF at the nominal supply");
    assert!(held(0.25, 0.2475 * most) && !held(0.25, 0.2525 * most), "GPF in proportion to PSR");
}

/// The whole loop on a step of 0.1 m under a load and a supply of its own.
fn step_under(external_load_n: f64, supply_factor: f64, duration_s: f64) -> (State, Option<f64>) {
    let set = ParameterSet::reference();
    let model = Model::new(&set.shared(), set.reference_model(), &Faults::default());
    let input = Input { external_load_n, supply_factor, ..Input::command(0.1) };
    let (mut s, mut passed_s) = (model.start(), None);
    for step in 0..(duration_s * 1e5) as u32 {
        s = model.step(&s, &input);
        if passed_s.is_none() && s.jack.position_m > 0.05 {
            passed_s = Some(f64::from(step) * 1e-5);
        }
    }
    (s, passed_s)
}

#[test]
fn validate_section_4_1_2_a_lower_supply_makes_the_actuator_slower() {
    let times: Vec<f64> = [1.2, 1.0, 0.7, 0.4].iter().map(|&psr| step_under(0.0, psr, 1.0).1.unwrap()).collect();
    assert!(rises(&times), "{times:?}");
}

#[test]
fn validate_section_4_1_4_loads_are_answered_by_pressure() {
    let area_m2 = ParameterSet::reference().shared().jack.area_m2;
    let on_ramp = |set: &ParameterSet| mean(&healthy(set, "ramp:0.1", 2.0), Channel::LoadPressure, 1.8, 1.9);
    let plain_pa = on_ramp(&ParameterSet::reference());
    let loaded_pa = on_ramp(&set_with([("jack.external_load_n", 2000.0)]));
    assert!(((loaded_pa - plain_pa) * area_m2 / 2000.0 - 1.0).abs() < 0.01, "{plain_pa} {loaded_pa}");
    let pulled_pa = on_ramp(&set_with([("jack.external_load_n", -2000.0)]));
    assert!(((plain_pa - pulled_pa) * area_m2 / 2000.0 - 1.0).abs() < 0.01, "{plain_pa} {pulled_pa}");
    // The aerodynamic stiffness opposes the displacement: at a mean of 0.185 m less the lag.
    let stiff = set_with([("jack.aerodynamic_stiffness_n_per_m", 1e4)]);
    let trace = healthy(&stiff, "ramp:0.1", 2.0);
    let force_n = 1e4 * mean(&trace, Channel::JackPosition, 1.8, 1.9);
    let answered_n = (mean(&trace, Channel::LoadPressure, 1.8, 1.9) - plain_pa) * area_m2;
    assert!((answered_n / force_n - 1.0).abs() < 0.01, "{answered_n} {force_n}");
    // A load that comes with the input acts as the set's own.
    let (s, _) = step_under(2000.0, 1.0, 1.5);
    let held_n = s.pipe.load_pressure_pa() * area_m2;
    assert!((held_n - 2000.0).abs() < 410.0, "within the static friction: {held_n}");
}

#[test]
fn validate_section_4_1_1_the_current_saturates_and_less_of_it_is_slower() {
    let limits = [0.038, 0.02, 0.012];
    let all = limits.map(|limit| healthy(&set_with([("torque_motor.current_max_a", limit)]), "step:0.1", 2.0));
    for (trace, limit) in all.iter().zip(limits) {
        let current = trace.channel(Channel::ServovalveCurrent).unwrap();
        assert_eq!(current.iter().fold(0.0_f64, |most, value| most.max(value.abs())), limit);
    }
    let times = all.each_ref().map(|trace| passes(trace, 0.05));
    assert!(rises(&times), "{times:?}");
}

#[test]
fn validate_section_4_1_2_a_hydraulic_offset_shifts_the_working_point() {
    let set = set_with([("reference.second_stage.hydraulic_offset_m", 2e-6)]);
    let (gain, motor) = (set.shared().controller.proportional_gain_a_per_m, set.shared().torque_motor);
    let stiffness = set.reference_model().first_stage;
    let stiffness = stiffness.armature_stiffness_n_per_m + stiffness.feedback_spring_stiffness_n_per_m;
    let trace = healthy(&set, "step:0", 3.0);
    // The flapper has to stand off by the offset, and the current that bends it there is asked for by an error.
    let needed_a = -2e-6 * stiffness / motor.force_gain_n_per_a;
    let current_a = mean(&trace, Channel::ServovalveCurrent, 2.9, 3.0);
    assert!((current_a - needed_a).abs() < 2e-4 && current_a < 0.0, "{current_a}, expected {needed_a}");
    let position_m = mean(&trace, Channel::JackPosition, 2.9, 3.0);
    assert!((position_m + current_a / gain).abs() < 1e-6, "{position_m}");
}

#[test]
fn validate_section_4_1_2_the_magnetic_circuit_s_spring_stiffens_the_flapper() {
    let circuits =
        ["fixed_gain", "magnetic_circuit"].map(|model| set_with([("reference.torque_motor.force_model", model)]));
    let peaks = circuits.each_ref().map(|set| {
        let trace = healthy(set, "step:0.003", 0.5);
        let (_, flapper) = trace.columns().find(|(name, _)| *name == "flapper_position_m").unwrap();
        flapper.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
    });
    assert!(falls(&peaks), "{peaks:?}");
    // The flapper returns to its middle on the ramp, where the spring takes nothing.
    let currents = circuits.each_ref().map(ramp_current_a);
    assert!((currents[1] / currents[0] - 1.0).abs() < 0.02, "{currents:?}");
}

#[test]
fn validate_section_4_1_4_the_recorded_position_is_whole_steps_of_the_quantizer() {
    let trace = healthy(&set_with([("jack.position_quantum_m", 1e-3)]), "step:0.02", 1.0);
    let positions = trace.channel(Channel::JackPosition).unwrap();
    assert!(positions.iter().all(|x| ((x / 1e-3).round() * 1e-3 - x).abs() < 1e-12));
    assert!((positions[1000] - 0.02).abs() < 1.1e-3, "{}", positions[1000]);
}

#[test]
fn validate_section_4_1_3_a_jack_that_is_pulled_hard_cavitates() {
    let set = ParameterSet::reference();
    let model = Model::new(&set.shared(), set.reference_model(), &Faults::default());
    let (mut s, mut vapour) = (model.start(), false);
    for _ in 0..20_000 {
        s = model.step(&s, &Input { external_load_n: -40e3, ..Input::command(0.0) });
        vapour |= s.pipe.auxiliary_1_pa < s.pipe.port_1_pa;
        assert!(s.pipe.port_1_pa >= set.reference_model().fluid.vapour_pressure_pa);
    }
    assert!(vapour, "the auxiliary pressure remembers the vapour");
}
