//! The reference model's torque motor: what disturbs the current, and the force as the magnetic circuit makes it.
//!
//! Source: sections 3.2.2 (threshold), 4.1.1 (hysteresis, offset, interference) and 4.1.2, figures 4.6 and 4.7.
//! Signs: a positive current pushes the flapper in the positive direction; a flapper displaced along that direction
//! lowers the force, as the thesis prints its fluxes (the usual physics of a permanent-magnet motor has the other sign).
//! Range: the current is held within ±CorM.
//! Limits: no saturation of the iron, no eddy currents; the two fluxes make the force linear in both arguments.

use serde::{Deserialize, Serialize};

use super::first_stage;
use crate::models::blocks::{backlash, end_stop, hysteresis, torque_motor};
use crate::models::checks::Checks;

/// How the force follows from the current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceModel {
    /// The fixed gain GM.
    FixedGain,
    /// The two fluxes through the air gaps, scaled so that the gain at null is GM.
    MagneticCircuit,
}

/// The parameters that only this model's torque motor has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// Half the width of the magnetic hysteresis, A.
    #[doc(alias = "His")]
    pub hysteresis_a: f64,
    /// Offset of the current, A.
    #[doc(alias = "Ofs")]
    pub current_offset_a: f64,
    /// The least change of current after a reversal that the valve answers, A.
    pub threshold_a: f64,
    /// How long a value of the interference, a band-limited white noise, is held, s; 0 for the time step.
    pub interference_sample_time_s: f64,
    /// Fixed gain or magnetic circuit.
    pub force_model: ForceModel,
    /// The magnetic circuit.
    pub magnetic_circuit: MagneticCircuit,
}

/// The magnetic circuit; the reluctance R0 and the section Ag cancel in the scaled force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MagneticCircuit {
    /// Magnetomotive force of the magnets, A.
    #[doc(alias = "Vp")]
    pub magnetomotive_force_a: f64,
    /// Windings on the armature, dimensionless.
    pub windings: f64,
    /// Length of an air gap, m.
    #[doc(alias = "lg")]
    pub gap_length_m: f64,
    /// Length of the armature, m.
    #[doc(alias = "La")]
    pub armature_length_m: f64,
    /// Arm from the armature's axis to the flapper's tip, m.
    #[doc(alias = "ls")]
    pub flapper_arm_m: f64,
    /// Correction for the flux at the armature's edges, dimensionless.
    pub edge_lambda: f64,
    /// Factor of the second edge correction, dimensionless.
    pub edge_alpha: f64,
    /// The second edge correction, dimensionless.
    pub edge_r: f64,
}

impl MagneticCircuit {
    /// The current, A, whose force a flapper displacement of one metre takes away: 1/m of Vp/(n (lambda + alpha r)).
    fn current_per_displacement_a_per_m(&self) -> f64 {
        let edge = self.edge_lambda + self.edge_alpha * self.edge_r;
        let gap_part_per_m = 0.5 * self.armature_length_m / (self.flapper_arm_m * self.gap_length_m);
        self.magnetomotive_force_a / (self.windings * edge) * gap_part_per_m
    }
}

impl Params {
    pub(crate) fn check(&self, shared: &torque_motor::Params, flapper: &first_stage::Params, checks: &mut Checks) {
        checks.within("reference.torque_motor.hysteresis_a", self.hysteresis_a, 0.0, 1.0, "A");
        checks.within("reference.torque_motor.current_offset_a", self.current_offset_a, -1.0, 1.0, "A");
        checks.within("reference.torque_motor.threshold_a", self.threshold_a, 0.0, 1.0, "A");
        let held_s = self.interference_sample_time_s;
        checks.within("reference.torque_motor.interference_sample_time_s", held_s, 0.0, 1.0, "s");
        let c = &self.magnetic_circuit;
        checks.within("reference.torque_motor.magnetic_circuit.windings", c.windings, 1.0, 1e6, "");
        checks.within("reference.torque_motor.magnetic_circuit.gap_length_m", c.gap_length_m, 1e-5, 0.1, "m");
        checks.within("reference.torque_motor.magnetic_circuit.armature_length_m", c.armature_length_m, 1e-4, 1.0, "m");
        checks.within("reference.torque_motor.magnetic_circuit.flapper_arm_m", c.flapper_arm_m, 1e-4, 1.0, "m");
        checks.within("reference.torque_motor.magnetic_circuit.edge_lambda", c.edge_lambda, 0.1, 10.0, "");
        checks.within("reference.torque_motor.magnetic_circuit.edge_alpha", c.edge_alpha, 0.0, 10.0, "");
        checks.within("reference.torque_motor.magnetic_circuit.edge_r", c.edge_r, 0.0, 10.0, "");
        let force_a = c.magnetomotive_force_a;
        // A magnetic spring that is no more than the flapper's own springs, where there is one.
        let per_ampere = self.spring_a_per_m() / force_a * shared.force_gain_n_per_a;
        let force_max_a = if per_ampere > 0.0 { flapper.stiffness_n_per_m() / per_ampere } else { f64::INFINITY };
        let name = "reference.torque_motor.magnetic_circuit.magnetomotive_force_a";
        checks.within_drawn(name, force_a, (0.0, 1e4), (0.0, force_max_a), "A");
    }

    /// Stiffness of the magnetic spring over the gain GM, A/m; zero with the fixed gain.
    #[must_use]
    pub fn spring_a_per_m(&self) -> f64 {
        match self.force_model {
            ForceModel::FixedGain => 0.0,
            ForceModel::MagneticCircuit => self.magnetic_circuit.current_per_displacement_a_per_m(),
        }
    }
}

/// What the motor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// The hysteresis.
    pub hysteresis: hysteresis::State,
    /// Current in the motor, A.
    #[doc(alias = "Cor")]
    pub current_a: f64,
    /// The part of it that the valve answers, A: the current but for the threshold.
    pub effective_a: f64,
}

/// The motor with what can be worked out before a run.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    shared: torque_motor::Params,
    params: Params,
    demagnetisation: f64,
    spring_a_per_m: f64,
}

impl Block {
    /// Prepares the block for a demagnetisation KGM.
    #[must_use]
    pub fn new(shared: &torque_motor::Params, params: &Params, demagnetisation: f64) -> Self {
        Self { shared: *shared, params: *params, demagnetisation, spring_a_per_m: params.spring_a_per_m() }
    }

    /// The most current, A.
    #[must_use]
    pub fn current_max_a(&self) -> f64 {
        self.shared.current_max_a
    }

    /// The state after a step and the force on the flapper, N.
    #[inline(always)]
    #[must_use]
    pub fn step(&self, s: &State, asked_a: f64, interference_a: f64, flapper_position_m: f64) -> (State, f64) {
        let p = &self.params;
        let (hysteresis, shifted_a) = hysteresis::step(p.hysteresis_a, &s.hysteresis, asked_a);
        let disturbed_a = shifted_a + p.current_offset_a + interference_a;
        let (current_a, _) = end_stop::hold(self.shared.current_max_a, disturbed_a, 0.0);
        let effective_a = backlash::step(p.threshold_a, s.effective_a, current_a);
        let net_a = effective_a - self.spring_a_per_m * flapper_position_m;
        let force_n = torque_motor::force(&self.shared, net_a, self.demagnetisation);
        (State { hysteresis, current_a, effective_a }, force_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::parameters::ParameterSet;

    fn params() -> (torque_motor::Params, Params) {
        let set = ParameterSet::reference();
        (set.shared().torque_motor, set.reference_model().torque_motor)
    }

    #[test]
    fn validate_section_4_1_2_the_force_is_that_of_the_two_fluxes() {
        let (shared, mut p) = params();
        p.force_model = ForceModel::MagneticCircuit;
        let block = Block::new(&shared, &p, 0.0);
        let c = &p.magnetic_circuit;
        // The printed equations, with a reluctance and a section of which the scaled force must not depend.
        let (reluctance, section_m2, mu0) = (3.2e7, 1.1e-5, 4e-7 * std::f64::consts::PI);
        let edge = c.edge_lambda + c.edge_alpha * c.edge_r;
        let force_n = |current_a: f64, flapper_m: f64| {
            let x = flapper_m / c.flapper_arm_m * c.armature_length_m / 2.0 / c.gap_length_m;
            let half = 2.0 * reluctance;
            let phi_1 = c.magnetomotive_force_a / half * (1.0 - x) / edge + current_a * c.windings / half;
            let phi_2 = c.magnetomotive_force_a / half * (1.0 + x) / edge - current_a * c.windings / half;
            let torque = (phi_1 * phi_1 - phi_2 * phi_2) * c.armature_length_m / (2.0 * section_m2 * mu0);
            torque / c.armature_length_m
        };
        let scale = shared.force_gain_n_per_a * 1e-3 / force_n(1e-3, 0.0);
        for (current_a, flapper_m) in [(0.01, 0.0), (0.01, 20e-6), (-0.03, -30e-6), (0.0, 10e-6)] {
            let (_, ours) = block.step(&State::default(), current_a, 0.0, flapper_m);
            let expected = scale * force_n(current_a, flapper_m);
            assert!((ours - expected).abs() < 1e-9, "{current_a} {flapper_m}: {ours}, expected {expected}");
        }
    }

    #[test]
    fn the_magnetic_spring_stays_well_below_the_flapper_s_springs() {
        let (shared, p) = params();
        let spring_n_per_m = shared.force_gain_n_per_a * p.magnetic_circuit.current_per_displacement_a_per_m();
        assert!((1e3..8e3).contains(&spring_n_per_m), "{spring_n_per_m} N/m");
    }

    #[test]
    fn validate_section_3_2_2_a_reversal_smaller_than_the_threshold_changes_nothing() {
        let (shared, mut p) = params();
        p.threshold_a = 2e-4;
        let block = Block::new(&shared, &p, 0.0);
        let (risen, force_n) = block.step(&State::default(), 5e-3, 0.0, 0.0);
        let (held, held_n) = block.step(&risen, 4.9e-3, 0.0, 0.0);
        assert_eq!(force_n, held_n);
        let (_, fallen_n) = block.step(&held, 4.7e-3, 0.0, 0.0);
        assert!(fallen_n < held_n);
    }

    #[test]
    fn validate_section_4_1_1_hysteresis_offset_and_interference_add_to_the_current_within_its_limits() {
        let (shared, mut p) = params();
        (p.hysteresis_a, p.current_offset_a) = (1e-4, 3e-4);
        let block = Block::new(&shared, &p, 0.0);
        let (risen, _) = block.step(&State::default(), 5e-3, 2e-4, 0.0);
        assert!((risen.current_a - (5e-3 - 1e-4 + 3e-4 + 2e-4)).abs() < 1e-15);
        let (most, _) = block.step(&risen, 1.0, 0.0, 0.0);
        assert_eq!(most.current_a, shared.current_max_a);
    }
}
