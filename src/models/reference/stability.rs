//! How long a time step a parameter set allows: each part of the model on its own, linear about rest.
//!
//! Source: Jury's conditions for the semi-implicit step (velocities first) of the flapper (4.1.2) and of the jack
//! between its two capacities (4.1.3, 4.1.4).
//! Signs: none.
//! Range: half of the step at which a part stops being stable; a passage fills half of a capacity in it at most.
//! Limits: the position loop as a whole may still oscillate, as a real one does: end stops and the current's limit bound
//! it. An orifice's flow is steeper than any step near zero drop; there the pressure jumps about zero by less than it is filled.

use super::{Params, first_stage, passages, second_stage};
use crate::models::blocks::{jack, torque_motor};
use crate::models::checks::Checks;
use crate::models::fault::CLEARANCE_MAX_M;

/// The shortest and the longest time step of any set, s.
const TIME_STEP_S: (f64, f64) = (1e-7, 2e-5);
/// No oil of the tables is lighter, kg/m³.
const DENSITY_MIN_KG_PER_M3: f64 = 730.0;

/// The time step's range as the rest of the set draws it.
pub(super) fn check(own: &Params, motor: &torque_motor::Params, jack: &jack::Params, checks: &mut Checks) {
    let spring_n_per_m = own.torque_motor.spring_a_per_m() * motor.force_gain_n_per_a;
    let max_s = flapper_s(&own.first_stage, spring_n_per_m)
        .min(capacities_s(&own.fluid, jack))
        .min(passages_s(&own.fluid, &own.second_stage));
    checks.within_drawn("reference.time_step_s", own.time_step_s, TIME_STEP_S, (TIME_STEP_S.0, max_s), "s");
}

/// The flapper's longest step, s: half the root of w² h² + 2 c h = 4 for its stiffness and damping per mass.
fn flapper_s(p: &first_stage::Params, magnetic_spring_n_per_m: f64) -> f64 {
    let damping_per_s = p.damping_n_s_per_m() / p.mass_kg;
    let squared = (p.stiffness_n_per_m() + magnetic_spring_n_per_m) / p.mass_kg;
    2.0 / (damping_per_s + (damping_per_s * damping_per_s + 4.0 * squared).sqrt())
}

/// The longest step of the jack's mass on the springs of its two capacities and the air, s: with the decay rates of its
/// velocity (a) and of the load pressure (b) and the squared frequency (r), half the root of r h² = (2 - a h)(2 - b h).
fn capacities_s(p: &passages::Params, jack: &jack::Params) -> f64 {
    let stiffness = 2.0 * p.bulk_modulus_pa / p.chamber_volume_m3;
    let a = jack.damping_n_s_per_m / jack.mass_kg;
    let b = stiffness * p.leakage_m3_per_s_per_pa;
    let r = (stiffness * jack.area_m2 * jack.area_m2 + jack.aerodynamic_stiffness_n_per_m) / jack.mass_kg;
    2.0 / ((a + b) + ((a - b) * (a - b) + 4.0 * r).sqrt())
}

/// The step in which the two passages of a capacity, open as far as they go, pass half of what fills it to the supply, s.
fn passages_s(p: &passages::Params, spool: &second_stage::Params) -> f64 {
    p.chamber_volume_m3 / fill_per_s(p, spool)
}

/// The volume that takes a second to fill as above, m³/s.
fn fill_per_s(p: &passages::Params, spool: &second_stage::Params) -> f64 {
    let differential_pa = p.supply_pressure_pa - p.return_pressure_pa;
    let clearance_m = p.radial_clearance_m * p.clearance_factor + p.clearance_extra_m + CLEARANCE_MAX_M;
    let opening_m = spool.spool_position_max_m + (-p.overlap_supply_m).max(-p.overlap_return_m).max(0.0);
    let gap_m = clearance_m.hypot(opening_m);
    let discharge = p.discharge_coefficient * (1.0 + p.discharge_geometry_correction.abs());
    let density_kg_per_m3 = p.density_kg_per_m3.min(DENSITY_MIN_KG_PER_M3);
    let most = discharge * p.port_width_m * gap_m * (2.0 * differential_pa / density_kg_per_m3).sqrt();
    4.0 * p.bulk_modulus_pa * most / differential_pa
}

/// The least volume of a capacity that the shortest step can follow, m³.
pub(super) fn chamber_volume_min_m3(p: &passages::Params, jack: &jack::Params, spool: &second_stage::Params) -> f64 {
    // r h² + 2 (a + b) h <= 4 at twice the shortest step, a little more because bounds are told in three digits.
    let shortest_s = 1.02 * TIME_STEP_S.0;
    let h = 2.0 * shortest_s;
    let spring = 2.0 * p.bulk_modulus_pa * jack.area_m2 * jack.area_m2 / jack.mass_kg * h * h;
    let leak = 4.0 * p.bulk_modulus_pa * p.leakage_m3_per_s_per_pa * h;
    let damping = 2.0 * jack.damping_n_s_per_m / jack.mass_kg * h;
    let air = jack.aerodynamic_stiffness_n_per_m / jack.mass_kg * h * h;
    ((spring + leak) / (4.0 - damping - air)).max(fill_per_s(p, spool) * shortest_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;
    use crate::models::reference::{self, pipe};

    /// How much a free swing from 1e-6 (m or m/s) grew or fell in a number of steps.
    fn swing(steps: u32, mut after: impl FnMut() -> f64) -> f64 {
        (0..steps).map(|_| after().abs()).skip(steps as usize / 2).fold(0.0, f64::max) / 1e-6
    }

    #[test]
    fn the_flapper_swings_out_at_its_longest_step_and_up_at_2_1_times_that() {
        for damping_ratio in [0.01, 0.6, 5.0] {
            let own = ParameterSet::reference().reference_model().first_stage;
            let p = first_stage::Params { damping_ratio, flapper_position_max_m: 1e-2, ..own };
            let grown = |time_step_s: f64| {
                let block = first_stage::Block::new(&p);
                let mut s = first_stage::State { position_m: 1e-6, velocity_m_per_s: 0.0 };
                swing(2000, || {
                    s = block.step(&s, 0.0, 0.0, time_step_s);
                    s.position_m
                })
            };
            let longest_s = flapper_s(&p, 0.0);
            assert!(grown(longest_s) < 0.1, "{damping_ratio}: {}", grown(longest_s));
            assert!(grown(2.1 * longest_s) > 10.0, "{damping_ratio}: {}", grown(2.1 * longest_s));
        }
    }

    #[test]
    fn the_jack_between_its_capacities_swings_out_at_its_longest_step_and_up_at_2_1_times_that() {
        let set = ParameterSet::reference();
        for (leakage, stiffness) in [(0.0, 0.0), (3e-11, 0.0), (0.0, 1e7), (1e-8, 1e6)] {
            let mut fluid = set.reference_model().fluid;
            fluid.leakage_m3_per_s_per_pa = leakage;
            let jack = jack::Params { aerodynamic_stiffness_n_per_m: stiffness, ..set.shared().jack };
            let grown = |time_step_s: f64| {
                let block = pipe::Block::new(&fluid);
                let (mut pressures, mut position, mut velocity) = (pipe::State::at_rest(1e7), 0.0, 1e-6);
                swing(20_000, || {
                    pressures =
                        block.step(&pressures, &passages::Flows::default(), jack.area_m2 * velocity, time_step_s);
                    let force_n = jack.driving_force_n(pressures.load_pressure_pa(), position)
                        - jack.damping_n_s_per_m * velocity;
                    velocity += force_n / jack.mass_kg * time_step_s;
                    position += velocity * time_step_s;
                    velocity
                })
            };
            let longest_s = capacities_s(&fluid, &jack);
            assert!(grown(longest_s) < 1.0, "{leakage} {stiffness}: {}", grown(longest_s));
            assert!(grown(2.1 * longest_s) > 10.0 * grown(longest_s), "{leakage} {stiffness}");
        }
    }

    fn errors(replaced: &[(&str, &str)]) -> Vec<String> {
        let mut text = ParameterSet::reference().to_toml();
        for (from, to) in replaced {
            assert!(text.contains(from), "{from}");
            text = text.replacen(from, to, 1);
        }
        ParameterSet::parse(&text).unwrap_err().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_set_that_the_time_step_cannot_follow_is_told_which_one_could() {
        assert_eq!(
            errors(&[("leakage_m3_per_s_per_pa = 5.69e-14", "leakage_m3_per_s_per_pa = 1e-8")]),
            ["reference.time_step_s: found 1e-5, expected 1e-7 to 6.25e-6 s"]
        );
        assert_eq!(
            errors(&[("mass_kg = 3e-3", "mass_kg = 1e-5"), ("damping_ratio = 0.6", "damping_ratio = 5.0")]),
            ["reference.time_step_s: found 1e-5, expected 1e-7 to 1.72e-6 s"]
        );
        assert_eq!(
            errors(&[
                ("mass_kg = 10.0", "mass_kg = 0.01"),
                ("leakage_m3_per_s_per_pa = 5.69e-14", "leakage_m3_per_s_per_pa = 1e-8")
            ]),
            ["reference.time_step_s: found 1e-5, expected 1e-7 to 5.96e-6 s"]
        );
    }

    #[test]
    fn what_no_time_step_could_follow_is_told_itself() {
        let light = ("mass_kg = 10.0", "mass_kg = 0.01");
        assert_eq!(
            errors(&[light, ("damping_n_s_per_m = 345.0", "damping_n_s_per_m = 1e5")]),
            ["jack.damping_n_s_per_m: found 1e5, expected 0 to 1000 N s/m"]
        );
        let small = ("chamber_volume_m3 = 2e-4", "chamber_volume_m3 = 1e-6");
        assert_eq!(
            errors(&[("area_m2 = 8.0e-4", "area_m2 = 1.0"), small]),
            ["reference.fluid.chamber_volume_m3: found 1e-6, expected 3.33e-6 to 1 m3"]
        );
        let strong = ("magnetomotive_force_a = 30.0", "magnetomotive_force_a = 3e3");
        let found = errors(&[("\"fixed_gain\"", "\"magnetic_circuit\""), strong]);
        assert_eq!(
            found,
            ["reference.torque_motor.magnetic_circuit.magnetomotive_force_a: found 3000, expected 0 to 171 A"]
        );
    }

    #[test]
    fn a_wrong_value_draws_no_other_s_range() {
        assert_eq!(errors(&[("area_m2 = 8.0e-4", "area_m2 = -1e9")]).len(), 1);
    }

    #[test]
    fn the_reference_set_is_far_from_its_bounds() {
        let set = ParameterSet::reference();
        let own: &reference::Params = set.reference_model();
        let longest_s = flapper_s(&own.first_stage, 0.0)
            .min(capacities_s(&own.fluid, &set.shared().jack))
            .min(passages_s(&own.fluid, &own.second_stage));
        assert!(longest_s > 10.0 * own.time_step_s, "{longest_s}");
    }
}
