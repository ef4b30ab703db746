//! The monitoring model's parameters that follow from the reference model's by formula.
//!
//! Source: section 4.2 beside section 4.1.2.
//! Signs: docs/conventions.md.
//! Range: any valid set.
//! Limits: at the set's own supply and clogging; a magnetic circuit counts by its spring.

use crate::models::monitoring;
use crate::models::parameters::ParameterSet;

/// The monitoring model of a set with everything derived that can be: both stages' motion, stops, PSR.
#[must_use]
pub fn derived(set: &ParameterSet) -> monitoring::Params {
    let reference = set.reference_model();
    let mut own = *set.monitoring_model();
    let (motor, flapper) = (&reference.torque_motor, &reference.first_stage);
    let magnetic_n_per_m = set.shared().torque_motor.force_gain_n_per_a * motor.spring_a_per_m();
    let stiffness_n_per_m = flapper.armature_stiffness_n_per_m + magnetic_n_per_m;
    let spring_n_per_m = flapper.feedback_spring_stiffness_n_per_m;
    own.first_stage = monitoring::first_stage::Params {
        // SNF² = (KF + KSF)/MF.
        natural_frequency_rad_per_s: ((stiffness_n_per_m + spring_n_per_m) / flapper.mass_kg).sqrt(),
        damping_ratio: flapper.damping_ratio,
        flapper_stiffness_n_per_m: stiffness_n_per_m,
        feedback_spring_stiffness_n_per_m: spring_n_per_m,
        flapper_position_max_m: flapper.flapper_position_max_m,
    };
    let spool = &reference.second_stage;
    let supply_pa = reference.fluid.supply_pressure_pa - reference.fluid.return_pressure_pa;
    let open = (1.0 - spool.filter_clogging) * supply_pa / spool.nominal_pressure_differential_pa;
    let (pressure_gain, flow_gain) = (spool.pressure_gain_pa_per_m * open, spool.flow_gain_m2_per_s * open.sqrt());
    let area_m2 = spool.end_area_m2;
    // ASV GPF/(CS + ASV² GPF/GQF), with both gains multiplied by GQF so that a closed filter gives no 0/0.
    own.second_stage.spool_speed_gain_per_s =
        area_m2 * pressure_gain * flow_gain / (spool.damping_n_s_per_m * flow_gain + area_m2.powi(2) * pressure_gain);
    own.second_stage.spool_position_max_m = spool.spool_position_max_m;
    own.fluid.supply_pressure_differential_pa = supply_pa;
    own
}
