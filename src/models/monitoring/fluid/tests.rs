use super::*;
use crate::models::parameters::ParameterSet;

const PSR: f64 = 20e6;
/// Spool positions, m, and flows, m³/s, inside and outside the saturation.
const POINTS: [(f64, f64); 7] =
    [(20e-6, 0.0), (20e-6, 3e-6), (-30e-6, 1e-6), (300e-6, 3e-5), (300e-6, -3e-5), (-100e-6, 1e-5), (0.0, 2e-6)];

fn params() -> Params {
    ParameterSet::reference().monitoring_model().fluid
}

fn steady_pa(fluid: FluidModel, spool_position_m: f64, flow_m3_per_s: f64) -> f64 {
    Block::new(&params(), fluid).steady_pa(spool_position_m, flow_m3_per_s, 1.0)
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * (PSR + expected.abs()), "found {found}, expected {expected}");
}

#[test]
fn validate_section_5_1_the_linear_pressure_is_the_superposition_within_the_supply() {
    let p = params();
    let (gp, gq) = (PSR / p.spool_saturation_m, p.linear_flow_gain_m2_per_s);
    for (xs, q) in POINTS {
        let expected = (gp * (xs - q / gq)).clamp(-PSR, PSR);
        assert_near(steady_pa(FluidModel::Linear, xs, q), expected);
    }
    assert_eq!(steady_pa(FluidModel::Linear, 1e-3, -1e-4), PSR);
    assert_eq!(steady_pa(FluidModel::Linear, -1e-3, 0.0), -PSR);
}

#[test]
fn validate_section_5_2_the_evolved_pressure_is_the_thesis_s_transfer_function() {
    let p = params();
    let (xss, clk) = (p.spool_saturation_m, p.leakage_m3_per_s_per_pa);
    let gpq = PSR / xss / p.evolved_flow_gain_m2_per_s;
    for (xs, q) in POINTS {
        let expected = (PSR * xs - gpq * xss * q) / (f64::max(xs.abs(), xss) + gpq * xss * clk);
        assert_near(steady_pa(FluidModel::Evolved, xs, q), expected);
    }
}

#[test]
fn validate_section_5_2_large_openings_reach_the_supply_and_small_ones_with_flow_pass_it() {
    let at = |xs: f64, q: f64| steady_pa(FluidModel::Evolved, xs, q);
    assert!((at(0.1, 0.0) / PSR - 1.0).abs() < 1e-3 && (at(-0.1, 0.0) / PSR + 1.0).abs() < 1e-3);
    assert!(at(0.0, -8e-5) > 2.0 * PSR, "the water hammer: {}", at(0.0, -8e-5));
    assert!(steady_pa(FluidModel::Linear, 0.0, -8e-5) <= PSR, "which the linear fluid cannot show");
}

#[test]
fn validate_section_5_2_more_leakage_lowers_the_pressure() {
    let leaky = Params { leakage_m3_per_s_per_pa: 1e-12, ..params() };
    for fluid in [FluidModel::Evolved, FluidModel::Developed] {
        // A flow from the jack, so that the developed fluid too has a pressure that leaks.
        let (tight, loose) = (steady_pa(fluid, 20e-6, -3e-6), Block::new(&leaky, fluid).steady_pa(20e-6, -3e-6, 1.0));
        assert!(loose < tight && loose > 0.0, "{fluid:?}: {loose} of {tight}");
    }
}

#[test]
fn validate_section_5_3_the_developed_pressure_is_the_thesis_s_function() {
    let p = params();
    let (xss, gq, clk) = (p.spool_saturation_m, p.flow_gain_m2_per_s, p.leakage_m3_per_s_per_pa);
    for (xs, q) in POINTS {
        let u: f64 = xs / xss;
        let expected = PSR * u.tanh() - q * f64::abs(q) / 4.5e-6 / (u * u * gq / (PSR / xss) + clk);
        assert_near(steady_pa(FluidModel::DevelopedWithoutLag, xs, q), expected);
        assert_near(steady_pa(FluidModel::Developed, xs, q), expected);
    }
}

#[test]
fn validate_section_5_3_the_first_version_answers_at_once_and_the_final_one_after_its_lag() {
    let p = params();
    let (xs, q) = (30e-6, 2e-6);
    let u: f64 = xs / p.spool_saturation_m;
    let lag_s = 2e-3 * 5.6 / (1.2 * u * u + 4.0) * (1.0 + 1.66667e5 * q);
    let mut s = State::<f64>::start((), 0.0);
    let steady_pa = steady_pa(FluidModel::Developed, xs, q);
    let first = Block::new(&p, FluidModel::DevelopedWithoutLag);
    assert_eq!(first.step(&s, xs, q, 1.0, 1e-6), steady_pa);
    let last = Block::new(&p, FluidModel::Developed);
    let steps = (lag_s / 1e-6).round() as usize;
    for _ in 0..steps {
        s.load_pressure_pa = last.step(&s, xs, q, 1.0, 1e-6);
    }
    let left = 1.0 - s.load_pressure_pa / steady_pa;
    assert!((left - (-1f64).exp()).abs() < 1e-3, "one lag leaves 1/e of the way: {left}");
}

#[test]
fn validate_section_5_2_the_supply_scales_the_pressure_and_not_what_the_flow_costs() {
    for fluid in FluidModel::ALL {
        let block = Block::new(&params(), fluid);
        let at = |q: f64, factor: f64| block.steady_pa(20e-6, q, factor);
        assert_near(at(0.0, 0.5), 0.5 * at(0.0, 1.0));
        assert_near(at(0.0, 0.5) - at(1e-6, 0.5), at(0.0, 1.0) - at(1e-6, 1.0));
        assert_eq!(at(0.0, 0.0), 0.0, "{fluid:?} without supply");
    }
    let linear = Block::new(&params(), FluidModel::Linear);
    assert_eq!(linear.steady_pa(1e-3, 0.0, 0.5), 0.5 * PSR, "the saturation is the supply's");
}

#[test]
fn the_flow_is_the_steady_pressure_s_inverse() {
    for fluid in FluidModel::ALL {
        let block = Block::new(&params(), fluid);
        for (xs, q) in [(20e-6, 3e-6), (-30e-6, 1e-6), (300e-6, 4e-5), (100e-6, -1e-7)] {
            let load_pa = block.steady_pa(xs, q, 1.0);
            if load_pa.abs() < PSR {
                let found = block.flow_m3_per_s(xs, load_pa);
                assert!((found - q).abs() < 1e-6 * q.abs(), "{fluid:?} at {xs}: {found}, expected {q}");
            }
        }
    }
}

#[test]
fn every_fluid_is_odd_in_spool_position_and_flow() {
    for fluid in FluidModel::ALL {
        for (xs, q) in POINTS {
            assert_eq!(steady_pa(fluid, xs, q), -steady_pa(fluid, -xs, -q), "{fluid:?} at {xs} {q}");
        }
    }
    assert!((steady_pa(FluidModel::Developed, 1e-3, 0.0) - PSR).abs() < 1.0);
}

#[test]
fn the_fluids_are_named_in_snake_case_and_the_final_one_is_the_default() {
    let names = FluidModel::ALL.map(|fluid| serde_json::to_value(fluid).unwrap());
    assert_eq!(names, ["linear", "evolved", "developed_without_lag", "developed"]);
    assert_eq!(FluidModel::default(), FluidModel::Developed);
}
