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
    let mut own = set.monitoring_model().clone();
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
    // ASV GPF/(CS + ASV² GPF/GQF); the ratio of the gains in this form stays finite when the filter is closed.
    let ratio_pa_s_per_m3 = spool.pressure_gain_pa_per_m / spool.flow_gain_m2_per_s * open.sqrt();
    let resistance_n_s_per_m = spool.damping_n_s_per_m + spool.end_area_m2.powi(2) * ratio_pa_s_per_m3;
    own.second_stage.spool_speed_gain_per_s =
        spool.end_area_m2 * spool.pressure_gain_pa_per_m * open / resistance_n_s_per_m;
    own.second_stage.spool_position_max_m = spool.spool_position_max_m;
    own.fluid.supply_pressure_differential_pa = supply_pa;
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(from: &str, to: &str) -> monitoring::Params {
        let text = ParameterSet::reference().to_toml();
        assert!(text.contains(from), "{from}");
        derived(&ParameterSet::parse(&text.replacen(from, to, 1)).unwrap())
    }

    #[test]
    fn validate_section_4_2_the_first_stage_is_the_reference_model_s_transfer_function() {
        let own = derived(&ParameterSet::reference());
        // sqrt((27000 + 6000)/0.003) and ASV GPF/(CS + ASV² GPF/GQF) = 8e6/8001.
        assert!((own.first_stage.natural_frequency_rad_per_s - 3_316.624_790_4).abs() < 1e-6);
        assert!((own.second_stage.spool_speed_gain_per_s - 8e6 / 8001.0).abs() < 1e-9);
        assert_eq!(own.fluid.supply_pressure_differential_pa, 20e6);
    }

    #[test]
    fn a_magnetic_spring_stiffens_the_flapper_and_a_clogged_filter_slows_the_spool() {
        let own = derived(&ParameterSet::reference());
        let magnetic = with("force_model = \"fixed_gain\"", "force_model = \"magnetic_circuit\"").first_stage;
        assert!(magnetic.flapper_stiffness_n_per_m > own.first_stage.flapper_stiffness_n_per_m + 1e3);
        assert!(magnetic.natural_frequency_rad_per_s > own.first_stage.natural_frequency_rad_per_s);
        let clogged = with("filter_clogging = 0.0", "filter_clogging = 0.75").second_stage;
        // GQF, and with it the speed, falls with the root of what is left open.
        assert!((clogged.spool_speed_gain_per_s / own.second_stage.spool_speed_gain_per_s - 0.5).abs() < 1e-3);
        assert_eq!(with("filter_clogging = 0.0", "filter_clogging = 1.0").second_stage.spool_speed_gain_per_s, 0.0);
    }
}
