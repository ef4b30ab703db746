//! The monitoring model with each of chapter 5's fluids.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use elevon::models::blocks::Input;
use elevon::models::drive::Drive;
use elevon::models::monitoring::fluid::FluidModel;
use elevon::models::monitoring::{Model, State};
use elevon::models::parameters::ParameterSet;
use elevon::numeric::lane::{Both, Lanes, Register};
use elevon::reproduction::thesis::{TABLE_6_3, cases};

const TIME_STEP_S: f64 = 1e-5;

fn model(fluid: FluidModel) -> Model {
    let set = ParameterSet::reference();
    Model::with_fluid(&set.shared(), set.monitoring_model(), fluid)
}

/// What a run of the diagnostic command shows at the features' windows.
#[derive(Debug)]
struct Shown {
    /// Mean current, mA, and pressure, kPa.
    features: (f64, f64),
    /// How far the jack's velocity strays from the ramp's, m/s.
    stray_m_per_s: f64,
}

fn diagnostic(fluid: FluidModel, kgm: f64, fdj_n: f64) -> Shown {
    let model = model(fluid);
    let candidate = model.candidate(kgm, fdj_n);
    let mut s = State::<f64>::start((), 0.0);
    let mut shown = Shown { features: (0.0, 0.0), stray_m_per_s: 0.0 };
    for k in 0..=511_000 {
        let command_m = Drive::Diagnostic.position_m(f64::from(k) * TIME_STEP_S, 6.0);
        s = model.step(&candidate, &s, &Input::command(command_m), TIME_STEP_S);
        if (180_000..=190_000).contains(&k) {
            shown.features.0 += s.servovalve_current_a * 1e3 / 10_001.0;
            shown.stray_m_per_s = shown.stray_m_per_s.max((s.jack_velocity_m_per_s - 0.1).abs());
        }
        if k >= 509_000 {
            shown.features.1 += s.load_pressure_pa * 1e-3 / 2_001.0;
        }
    }
    shown
}

#[test]
fn validate_chapter_5_each_fluid_settles_in_the_closed_loop_at_the_reference_model_s_features() {
    // The current within this part of Table 6.3, the pressure within 0.1 %: the cruder the fluid, the less a current
    // fits every friction.
    for (fluid, within) in [(FluidModel::Linear, 0.06), (FluidModel::Evolved, 0.04), (FluidModel::Developed, 0.02)] {
        cases().par_iter().zip(TABLE_6_3).for_each(|(&(kgm, fdj_n), (thesis_ma, thesis_kpa))| {
            let Shown { features: (current_ma, pressure_kpa), stray_m_per_s } = diagnostic(fluid, kgm, fdj_n);
            let (current, pressure) = (current_ma / thesis_ma - 1.0, pressure_kpa / thesis_kpa - 1.0);
            println!("{fluid:?} {kgm} {fdj_n}: {current:+.4} {pressure:+.5} {stray_m_per_s:.1e}");
            assert!(current.abs() < within && pressure.abs() < 2e-3, "{fluid:?}, KGM {kgm}, FDJ {fdj_n}");
            assert!(stray_m_per_s < 1e-3, "{fluid:?}, KGM {kgm}, FDJ {fdj_n}: the jack follows the ramp evenly");
        });
    }
}

#[test]
fn validate_section_5_3_without_its_lag_the_developed_fluid_never_settles_in_the_closed_loop() {
    // "It was not possible to find a working point": an instant loss that grows with the squared flow drives the jack
    // to and fro from step to step.
    let shown = diagnostic(FluidModel::DevelopedWithoutLag, 0.0, 200.0);
    assert!(shown.stray_m_per_s > 0.05, "{shown:?}");
}

#[test]
fn more_supply_gives_more_force_on_the_jack_with_each_fluid() {
    for fluid in [FluidModel::Linear, FluidModel::Evolved, FluidModel::Developed] {
        let reached_m = |supply_factor: f64| {
            let model = model(fluid);
            let candidate = model.candidate(0.0, 200.0);
            let mut s = State::<f64>::start((), 0.0);
            let input = Input { supply_factor, ..Input::command(0.1) };
            for _ in 0..2_000 {
                s = model.step(&candidate, &s, &input, TIME_STEP_S);
            }
            s.jack_position_m
        };
        let (none, half, full) = (reached_m(0.0), reached_m(0.5), reached_m(1.0));
        assert!(none == 0.0 && half > 0.0 && full > half, "{fluid:?}: {none} {half} {full}");
    }
}

/// A step command for candidates in lock-step.
struct Batch<'a> {
    model: &'a Model,
    kgm: &'a [f64],
    pressures_pa: &'a mut [f64],
}

impl WithSimd for Batch<'_> {
    type Output = ();

    fn with_simd<S: Simd>(self, simd: S) {
        type Two<S> = Both<Register<S>, Register<S>>;
        let kgm = Two::load(simd, self.kgm);
        let candidate = self.model.candidate(kgm, kgm * 100.0 + 200.0);
        let mut s = State::<Two<S>>::start(simd, 0.0);
        for _ in 0..3_000 {
            s = self.model.step(&candidate, &s, &Input::command(0.01), TIME_STEP_S);
        }
        s.load_pressure_pa.store(self.pressures_pa);
    }
}

#[test]
fn parity_every_lane_gives_the_bits_of_the_plain_number_with_each_fluid() {
    for fluid in FluidModel::ALL {
        let model = model(fluid);
        // No instruction set has fewer than one lane in a register: two numbers fit everywhere.
        for pair in [[0.0, 0.1], [0.33, 0.7]] {
            let mut pressures_pa = [f64::NAN; 2];
            Arch::new().dispatch(Batch { model: &model, kgm: &pair, pressures_pa: &mut pressures_pa });
            for (kgm, found_pa) in pair.iter().zip(pressures_pa) {
                let candidate = model.candidate(*kgm, kgm * 100.0 + 200.0);
                let mut s = State::<f64>::start((), 0.0);
                for _ in 0..3_000 {
                    s = model.step(&candidate, &s, &Input::command(0.01), TIME_STEP_S);
                }
                assert!(found_pa != 0.0 && found_pa.to_bits() == s.load_pressure_pa.to_bits(), "{fluid:?} {kgm}");
            }
        }
    }
}
