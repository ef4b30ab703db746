//! What holds at every step of any run: numbers, stops, oil that neither appears nor vanishes, energy that only leaves.

use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;
use serde_json::Value as Json;

use elevon::models::blocks::{Input, end_stop, jack};
use elevon::models::checks::ParamsError;
use elevon::models::fault::Faults;
use elevon::models::monitoring::large_step::{LargeStep, TIME_STEP_MAX_S};
use elevon::models::parameters::{ParameterSet, Value};
use elevon::models::reference::passages::{self, Flows};
use elevon::models::reference::{self, jack as reference_jack, pipe};
use elevon::models::{blocks::friction::FrictionModel, monitoring};

/// Steps of one run: some hundred at the ends of the stops, the rest wherever the parameters lead.
const STEPS: u32 = 1500;
/// The time step of the monitoring model in a simulation, s.
const MONITORING_STEP_S: f64 = 1e-5;

/// A value over a range: at its ends, at zero, or spread over the decades that the range spans.
fn spread(min: f64, max: f64, unit: f64) -> f64 {
    let decades = |max: f64, unit: f64| max * 10f64.powf(-14.0 * (1.0 - unit));
    match unit {
        u if u < 0.08 => min,
        u if u > 0.92 => max,
        u if min > 0.0 => min * (max / min).powf(u),
        u if u < 0.2 => 0.0,
        u if min < 0.0 && u < 0.55 => -decades(-min, (u - 0.2) / 0.35),
        u => decades(max, u),
    }
}

/// What a parameter's text may be.
fn texts(name: &str) -> &'static [&'static str] {
    match name {
        "reference.torque_motor.force_model" => &["fixed_gain", "magnetic_circuit"],
        "reference.oil.oil" => &["constant", "mil_prf_5606", "mil_prf_83282"],
        "reference.friction.model" => &["coulomb", "karnopp", "borello"],
        _ => &[],
    }
}

/// A set drawn over all ranges, and whether it was valid as drawn. A value beyond a bound that others draw is put on
/// that bound, which is the hardest place that validates.
fn drawn_set(units: &[f64]) -> (ParameterSet, bool) {
    let reference = ParameterSet::reference();
    let mut json = reference.to_json();
    for (parameter, &unit) in reference.parameters().iter().zip(units) {
        let known = texts(&parameter.name);
        let value = match (&parameter.value, parameter.limits) {
            // The reference set draws this one's range closer than any other set's may be.
            (Value::Number(_), _) if parameter.name.ends_with("second_stage.friction_dynamic_n") => {
                Json::from(spread(0.0, 1e3, unit))
            }
            (Value::Number(_), Some(limits)) => Json::from(spread(limits.min, limits.max, unit)),
            (Value::Text(_), _) if !known.is_empty() => {
                Json::from(known[(unit * known.len() as f64) as usize % known.len()])
            }
            _ => continue,
        };
        *json.pointer_mut(&format!("/{}", parameter.name.replace('.', "/"))).unwrap() = value;
    }
    for round in 0..6 {
        match ParameterSet::from_json("drawn", &json) {
            Ok(set) => return (set, round == 0),
            Err(errors) => {
                for error in errors {
                    let ParamsError::OutOfRange { value, limits } = error else { panic!("{error}") };
                    assert!(limits.min <= limits.max, "an empty range: {limits:?}");
                    let path = format!("/{}", limits.name.replace('.', "/"));
                    *json.pointer_mut(&path).unwrap() = Json::from(value.max(limits.min).min(limits.max));
                }
            }
        }
    }
    panic!("no valid set near {json}")
}

/// Faults over their whole ranges.
fn drawn_faults(u: &[f64]) -> Faults {
    Faults {
        kgm: spread(0.0, 1.0, u[0]),
        fdj_n: spread(200.0, 2000.0, u[1]),
        clearance_m: spread(0.0, 1e-4, u[2]),
        clogging: spread(0.0, 1.0, u[3]),
        feedback_backlash_m: spread(0.0, 1e-4, u[4]),
        jack_backlash_m: spread(0.0, 0.01, u[5]),
        current_offset_a: spread(-0.02, 0.02, u[6]),
        hysteresis_a: spread(0.0, 0.02, u[7]),
    }
}

/// The command, noise, load and supply of a step, from four shapes each: none, constant, alternating, a slow square wave.
fn input(step: u32, shapes: [u8; 4], sizes: &[f64]) -> Input {
    let shape = |kind: u8| match kind {
        0 => 0.0,
        1 => 1.0,
        2 => f64::from(step % 2) * 2.0 - 1.0,
        _ => f64::from(step / 200 % 2) * 2.0 - 1.0,
    };
    Input {
        position_command_m: shape(shapes[0]) * spread(0.0, 1e4, sizes[0]),
        interference_a: shape(shapes[1]) * spread(0.0, 50.0, sizes[1]),
        external_load_n: shape(shapes[2]) * spread(0.0, 1e7, sizes[2]),
        supply_factor: 1.0 + shape(shapes[3]) * spread(0.0, 1.0, sizes[3]),
    }
}

/// The reference model's states against their bounds.
fn check_reference(set: &ParameterSet, s: &reference::State) -> Result<(), String> {
    let (own, shared) = (set.reference_model(), set.shared());
    let within = |name: &str, value: f64, limit: f64| {
        if value.abs() <= limit { Ok(()) } else { Err(format!("{name} {value}, limit {limit}")) }
    };
    let dt = own.time_step_s;
    within("current", s.torque_motor.current_a, shared.torque_motor.current_max_a)?;
    within("integral", s.controller.integral_a, shared.torque_motor.current_max_a)?;
    within("flapper", s.first_stage.position_m, own.first_stage.flapper_position_max_m)?;
    within("spool", s.second_stage.position_m, own.second_stage.spool_position_max_m)?;
    within("jack", s.jack.position_m, shared.jack.position_max_m)?;
    within("jack velocity", s.jack.velocity_m_per_s, 2.0001 * shared.jack.position_max_m / dt)?;
    within("measured", s.jack.measured_m, shared.jack.position_max_m + shared.jack.position_quantum_m)?;
    for (name, pressure_pa) in [("P1", s.pipe.port_1_pa), ("P2", s.pipe.port_2_pa)] {
        if !(pressure_pa.is_finite() && pressure_pa >= own.fluid.vapour_pressure_pa) {
            return Err(format!("{name} {pressure_pa}"));
        }
    }
    let others = [s.torque_motor.effective_a, s.first_stage.velocity_m_per_s, s.second_stage.velocity_m_per_s];
    let memory = [s.pipe.auxiliary_1_pa, s.pipe.auxiliary_2_pa, s.jack_flow_m3_per_s, s.controller.error_m];
    if others.iter().chain(&memory).all(|value| value.is_finite()) { Ok(()) } else { Err(format!("{s:?}")) }
}

/// The monitoring model's states against their bounds.
fn check_monitoring(set: &ParameterSet, s: &monitoring::State<f64>) -> Result<(), String> {
    let (own, shared) = (set.monitoring_model(), set.shared());
    let within = |name: &str, value: f64, limit: f64| {
        if value.abs() <= limit { Ok(()) } else { Err(format!("{name} {value}, limit {limit}")) }
    };
    within("current", s.servovalve_current_a, shared.torque_motor.current_max_a)?;
    within("flapper", s.flapper_position_m, own.first_stage.flapper_position_max_m)?;
    within("spool", s.spool_position_m, own.second_stage.spool_position_max_m)?;
    within("jack", s.jack_position_m, shared.jack.position_max_m)?;
    let others = [s.flapper_velocity_m_per_s, s.load_pressure_pa, s.jack_velocity_m_per_s];
    if others.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(format!("{s:?}")) }
}

/// Sets that validated as drawn, and all that were drawn.
static AS_DRAWN: [AtomicUsize; 2] = [AtomicUsize::new(0), AtomicUsize::new(0)];

proptest! {
    #![proptest_config(super::cases(2000))]

    // Of the sets drawn over the whole ranges about one in four validates as it is; the others do with each value that
    // a joint bound excludes on that bound. Both kinds run.
    #[test]
    fn no_set_that_validates_leaves_the_numbers_or_the_stops(
        units in proptest::collection::vec(0.0..1.0, 120),
        fault_units in proptest::collection::vec(0.0..1.0, 8),
        sizes in proptest::collection::vec(0.0..1.0, 4),
        shapes in proptest::array::uniform4(0_u8..4),
    ) {
        let (set, as_drawn) = drawn_set(&units);
        AS_DRAWN[0].fetch_add(usize::from(as_drawn), Ordering::Relaxed);
        AS_DRAWN[1].fetch_add(1, Ordering::Relaxed);
        let faults = drawn_faults(&fault_units);
        let model = reference::Model::new(&set.shared(), set.reference_model(), &faults);
        let mut s = model.start();
        for step in 0..STEPS {
            s = model.step(&s, &input(step, shapes, &sizes));
            let checked = check_reference(&set, &s);
            prop_assert!(checked.is_ok(), "step {step}: {checked:?} {}", set.to_toml());
        }
        let model = monitoring::Model::new(&set.shared(), set.monitoring_model());
        let large = LargeStep::new(&model, TIME_STEP_MAX_S);
        let candidate = model.candidate(faults.kgm, faults.fdj_n);
        let (mut fine, mut coarse) = (monitoring::State::start((), 0.0), monitoring::State::start((), 0.0));
        for step in 0..STEPS {
            let input = input(step, shapes, &sizes);
            fine = model.step(&candidate, &fine, &input, MONITORING_STEP_S);
            coarse = large.step(&candidate, &coarse, input.position_command_m);
            for (name, s) in [("fine", &fine), ("coarse", &coarse)] {
                let checked = check_monitoring(&set, s);
                prop_assert!(checked.is_ok(), "{name} step {step}: {checked:?} {}", set.to_toml());
            }
        }
        println!("{:?} of {:?} sets validated as drawn", AS_DRAWN[0], AS_DRAWN[1]);
    }

    // Section 4.1.2 and 4.1.4: the saturated integrator resets the velocity.
    #[test]
    fn validate_section_4_1_4_an_end_stop_holds_the_position_and_only_takes_energy(
        limit in 1e-6..10.0_f64, position in -20.0..20.0_f64, velocity in -1e3..1e3_f64,
    ) {
        let (held, after) = end_stop::step(limit, position, velocity);
        prop_assert!(held.abs() <= limit && after.abs() <= velocity.abs());
        let expected = if position.abs() > limit { (limit.copysign(position), 0.0) } else { (position, velocity) };
        prop_assert_eq!((held, after), expected);
    }

    // Section 4.1.3: what the supply gives beyond what the return takes stays in the two capacities; what the jack and
    // the leakage take from one they give to the other.
    #[test]
    fn validate_section_4_1_3_the_capacities_keep_the_oil_that_does_not_leave(
        spool in -1.2e-3..1.2e-3_f64, p1 in 2e3..2.1e7_f64, p2 in 2e3..2.1e7_f64, jack_flow in -1e-3..1e-3_f64,
        leakage in 0.0..1e-10_f64, dt in 1e-7..2e-5_f64,
    ) {
        let fluid = passages::Params {
            leakage_m3_per_s_per_pa: leakage, ..ParameterSet::reference().reference_model().fluid
        };
        let flows = passages::Block::new(&fluid).step(spool, fluid.supply_pressure_pa, p1, p2);
        let before = pipe::State { port_1_pa: p1, port_2_pa: p2, auxiliary_1_pa: p1, auxiliary_2_pa: p2 };
        let after = pipe::Block::new(&fluid).step(&before, &flows, jack_flow, dt);
        let Flows { supply_to_1, from_1_to_return, supply_to_2, from_2_to_return } = flows;
        let kept_m3 = (after.auxiliary_1_pa - p1 + (after.auxiliary_2_pa - p2)) * fluid.chamber_volume_m3
            / fluid.bulk_modulus_pa;
        let entered_m3 = (supply_to_1 + supply_to_2 - from_1_to_return - from_2_to_return) * dt;
        prop_assert!((kept_m3 - entered_m3).abs() < 1e-20, "{kept_m3} {entered_m3}");
        let mirrored = passages::Block::new(&fluid).step(-spool, fluid.supply_pressure_pa, p2, p1);
        prop_assert_eq!(Flows {
            supply_to_1: supply_to_2, from_1_to_return: from_2_to_return,
            supply_to_2: supply_to_1, from_2_to_return: from_1_to_return,
        }, mirrored, "the spool the other way is the same valve with its chambers exchanged");
    }

    // Section 4.1.4 without pressure: mass, aerodynamic spring, damping, dry friction. The semi-implicit step keeps
    // m v²/2 + k x²/2 - h k x v/2 of a free swing exactly, so that the energy itself stays within (1 + w h/2)/(1 - w h/2)
    // of what it was, and friction and damping only take from it.
    #[test]
    fn validate_section_4_1_4_a_passive_jack_gains_no_energy_beyond_its_integrator_s(
        mass in 1.0..100.0_f64, stiffness in 0.0..1e7_f64, damping in 0.0..1e3_f64, fdj in 1.0..2000.0_f64,
        position in -0.2..0.2_f64, velocity in -2.0..2.0_f64, borello in any::<bool>(),
    ) {
        let set = ParameterSet::reference();
        let params = jack::Params {
            mass_kg: mass, aerodynamic_stiffness_n_per_m: stiffness, damping_n_s_per_m: damping, ..set.shared().jack
        };
        let model = if borello { FrictionModel::Borello } else { FrictionModel::Karnopp };
        let friction = reference_jack::Friction { model, ..set.reference_model().friction };
        let block = reference_jack::Block::new(&params, &friction, fdj);
        let energy_j = |s: &reference_jack::State| {
            0.5 * mass * s.velocity_m_per_s.powi(2) + 0.5 * stiffness * s.position_m.powi(2)
        };
        let mut s = reference_jack::State {
            position_m: position, velocity_m_per_s: velocity, surface_m: position, measured_m: position,
        };
        let dt = 1e-5;
        let half = 0.5 * (stiffness / mass).sqrt() * dt;
        let most_j = energy_j(&s) * (1.0 + half) / (1.0 - half) * (1.0 + 1e-12);
        for step in 0..5000 {
            s = block.step(&s, 0.0, 0.0, dt);
            prop_assert!(energy_j(&s) <= most_j, "step {step}: {} of {most_j} J", energy_j(&s));
        }
    }
}
