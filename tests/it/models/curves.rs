//! The characteristic curves and the settling times, against the thesis's text and against the capacities' routine.

use elevon::characterisation::curves::{CurveModel, Curves, FLOWS_M3_PER_S, Series, curves};
use elevon::characterisation::settling::{THESIS_SLOPE_S_PER_M3, TOLERANCE_PA, settling};
use elevon::characterisation::valve::Valve;
use elevon::models::parameters::ParameterSet;
use elevon::models::reference::{passages, pipe};
use elevon::numeric::watch::Unwatched;

fn of(all: &[Series], model: CurveModel) -> Vec<&Series> {
    all.iter().filter(|series| series.model == model).collect()
}

fn at(series: &Series, spool_um: f64) -> f64 {
    let near = |x: &f64| (x * 1e6 - spool_um).abs() < 1e-6;
    series.y[series.x.iter().position(near).unwrap()]
}

fn built_in() -> Curves {
    curves(&ParameterSet::reference())
}

#[test]
fn validate_section_3_2_the_pressure_is_the_supply_s_at_large_openings_and_above_it_at_small_ones_with_flow() {
    let curves = built_in();
    for series in of(&curves.pressure, CurveModel::Reference) {
        assert!((at(series, 600.0) / 20e6 - 1.0).abs() < 0.02 && (at(series, -600.0) / 20e6 + 1.0).abs() < 0.02);
        let peak_pa = series.y.iter().map(|y| y.abs()).fold(0.0, f64::max);
        let hammers = series.constant != 0.0;
        assert_eq!(peak_pa > 22e6, hammers, "{}: {peak_pa}", series.label);
    }
}

#[test]
fn validate_section_3_2_the_flow_vanishes_where_no_pressure_difference_is_present() {
    let curves = built_in();
    let flows = of(&curves.flow, CurveModel::Reference);
    let (at_return, at_supply) = (flows[0], flows[4]);
    assert_eq!((at_return.constant, at_supply.constant), (0.6e6, 20.6e6));
    // The horizontal segments: all that flows is what the closed edge lets through.
    for um in [-600.0, -300.0, -100.0] {
        assert!(at(at_return, um).abs() < 0.01 * at(at_return, 600.0), "{um}");
        assert!(at(at_supply, -um).abs() < 0.01 * at(at_return, 600.0), "{um}");
    }
    assert!(flows.windows(2).all(|two| at(two[0], 300.0) > at(two[1], 300.0)), "less flows into more pressure");
}

/// The root of the mean squared difference of a model's curves from the reference valve's, where the spool is open.
fn rms(all: &[Series], model: CurveModel, driving_only: bool) -> f64 {
    let squares = of(all, model).into_iter().zip(of(all, CurveModel::Reference)).flat_map(|(own, reference)| {
        let counts = |x: f64| x.abs() >= 50e-6 && (!driving_only || x * own.constant >= 0.0);
        let square = |(i, &x): (usize, &f64)| counts(x).then(|| (own.y[i] - reference.y[i]).powi(2));
        own.x.iter().enumerate().filter_map(square).collect::<Vec<_>>()
    });
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn validate_chapter_5_the_developed_fluid_is_the_only_one_near_the_reference_valve_in_pressure_and_flow() {
    let curves = built_in();
    let models = [CurveModel::Linear, CurveModel::Evolved, CurveModel::Developed];
    let [linear_pa, evolved_pa, developed_pa] = models.map(|model| rms(&curves.pressure, model, true));
    println!("pressure, Pa: {linear_pa} {evolved_pa} {developed_pa}");
    assert!(evolved_pa.max(developed_pa) < 0.7 * linear_pa, "the linear pressure does not fall with the flow");
    let [linear, evolved, developed] = models.map(|model| rms(&curves.flow, model, false));
    println!("flow, m3/s: {linear} {evolved} {developed}");
    assert!(developed < 0.2 * linear.min(evolved), "the others' flow is not the root of the pressure");
}

#[test]
fn validate_section_5_1_the_linear_fluid_s_gains_are_its_parameters() {
    let set = ParameterSet::reference();
    let fluid = &set.monitoring_model().fluid;
    let gains = built_in().gains;
    let linear = gains.iter().find(|gains| gains.model == CurveModel::Linear).unwrap();
    assert!((linear.pressure_gain_pa_per_m / fluid.pressure_gain_pa_per_m() - 1.0).abs() < 1e-9);
    assert!((linear.flow_gain_m2_per_s / fluid.linear_flow_gain_m2_per_s - 1.0).abs() < 1e-9);
}

#[test]
fn determinism_curves_are_odd_to_the_last_digits_and_the_same_on_any_number_of_threads() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (curves, alone) = (built_in(), pool.install(built_in));
    assert_eq!(curves, alone);
    for (one, other) in [(0, 4), (1, 3), (2, 2)] {
        let reference = of(&curves.pressure, CurveModel::Reference);
        for (y, mirrored) in reference[one].y.iter().zip(reference[other].y.iter().rev()) {
            assert!((y + mirrored).abs() < 1.0, "{y} {mirrored}");
        }
    }
}

/// The routine of section 4.1.3 at the model's own time step: the load pressure over time.
fn routine(spool_position_m: f64, jack_flow_m3_per_s: f64, steps: usize) -> Vec<f64> {
    let set = ParameterSet::reference();
    let fluid = &set.reference_model().fluid;
    let (valve, capacities) = (passages::Block::new(fluid), pipe::Block::new(fluid));
    let mut s = pipe::State::at_rest(0.5 * (fluid.supply_pressure_pa + fluid.return_pressure_pa));
    (0..steps)
        .map(|_| {
            let flows = valve.step(spool_position_m, fluid.supply_pressure_pa, s.port_1_pa, s.port_2_pa);
            s = capacities.step(&s, &flows, jack_flow_m3_per_s, 1e-5);
            s.load_pressure_pa()
        })
        .collect()
}

#[test]
fn validate_section_4_1_3_the_steady_pressure_and_the_settling_time_are_the_routine_s() {
    let valve = Valve::new(&ParameterSet::reference());
    for (spool_um, flow, duration_s) in [(60.0, 0.0, 3.0), (200.0, 6e-6, 1.0), (-40.0, -3e-6, 6.0), (60.0, -6e-6, 6.0)]
    {
        let spool_m = spool_um * 1e-6;
        let pressures_pa = routine(spool_m, flow, (duration_s * 1e5) as usize);
        let end_pa = valve.steady(spool_m, flow).load_pressure_pa();
        assert!((pressures_pa.last().unwrap() - end_pa).abs() < 100.0, "{spool_um} {flow}: {end_pa}");
        let outside = pressures_pa.iter().rposition(|pa| (pa - end_pa).abs() > TOLERANCE_PA).unwrap();
        let (routine_s, own_s) = ((outside + 1) as f64 * 1e-5, valve.settling_s(spool_m, flow, TOLERANCE_PA).unwrap());
        println!("{spool_um} {flow}: {routine_s} {own_s}");
        assert!((own_s / routine_s - 1.0).abs() < 0.01, "{spool_um} {flow}: {routine_s} {own_s}");
    }
}

#[test]
fn a_steady_state_is_found_for_any_lap_and_feeds_what_is_drawn() {
    let text = ParameterSet::reference().to_toml();
    for (lap, leakage) in [("7.3e-6", "5.69e-14"), ("-20e-6", "0.0"), ("0.0", "1e-9"), ("200e-6", "1e-12")] {
        let text = text
            .replace("overlap_supply_m = 7.3e-6", &format!("overlap_supply_m = {lap}"))
            .replace("overlap_return_m = 7.3e-6", &format!("overlap_return_m = {lap}"))
            .replace("leakage_m3_per_s_per_pa = 5.69e-14", &format!("leakage_m3_per_s_per_pa = {leakage}"));
        let set = ParameterSet::parse(&text).unwrap();
        let fluid = &set.reference_model().fluid;
        let (valve, passages) = (Valve::new(&set), passages::Block::new(fluid));
        for flow in FLOWS_M3_PER_S {
            for spool_m in [-300e-6, -10e-6, 0.0, 20e-6, 600e-6] {
                let steady = valve.steady(spool_m, flow);
                let (port_1_pa, port_2_pa) = (steady.port_1_pa, steady.port_2_pa);
                let flows = passages.step(spool_m, fluid.supply_pressure_pa, port_1_pa, port_2_pa);
                let absorbed = flow + fluid.leakage_m3_per_s_per_pa * steady.load_pressure_pa();
                let into_1 = flows.supply_to_1 - flows.from_1_to_return - absorbed;
                let into_2 = absorbed - (flows.from_2_to_return - flows.supply_to_2);
                // A chamber at the vapour pressure may be drained further.
                let still = |into: f64, pa: f64| into.abs() < 1e-11 || (pa == fluid.vapour_pressure_pa && into < 0.0);
                assert!(still(into_1, port_1_pa) && still(into_2, port_2_pa), "{lap} {flow} {spool_m}: {steady:?}");
            }
        }
    }
}

#[test]
fn validate_section_5_3_the_settling_time_is_a_bell_that_grows_with_the_flow() {
    let map = settling(&ParameterSet::reference(), &Unwatched).unwrap();
    let zero = &map.times[2];
    let null = zero.spool_position_m.iter().position(|x| *x == 0.0).unwrap();
    assert_eq!(zero.settling_s[null], Some(0.0), "without flow and opening nothing has to settle");
    let (peak_s, _) = zero.peak().unwrap();
    let ends = [zero.settling_s[0], *zero.settling_s.last().unwrap()];
    assert!(ends.iter().all(|end| end.unwrap() < 0.02 * peak_s), "a bell: {ends:?} {peak_s}");
    for (one, other) in [(0, 4), (1, 3)] {
        let (left, right) = (map.times[one].peak().unwrap(), map.times[other].peak().unwrap());
        assert!((left.0 - right.0).abs() < 1e-6 * left.0 && left.1 == -right.1, "symmetrical about the y axis");
    }
    println!("{:?} {:?}", map.bell, map.growth);
    assert!(map.bell.rms_s < 0.02 * peak_s && map.bell.worst_s < 0.1 * peak_s, "{:?}", map.bell);
    // At 3e-6 m3/s, where the thesis reads its slope, the peak has grown by its half; beyond, ours grows faster.
    let slope_at_3 = (map.growth.ratio[2] - 1.0) / map.growth.flow_m3_per_s[2];
    assert!((slope_at_3 / THESIS_SLOPE_S_PER_M3 - 1.0).abs() < 0.2, "{slope_at_3}");
}
