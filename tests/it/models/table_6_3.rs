//! The reference model against the thesis's Table 6.3.

use rayon::prelude::*;

use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::statistics::mean_between;
use elevon::numeric::watch::Unwatched;
use elevon::reproduction::thesis::{TABLE_6_3, cases};

/// A diagnostic run at the model's own rate, up to the end of the pressure feature.
pub fn diagnostic(model: ModelKind, kgm: f64, fdj_n: f64) -> Trace {
    let faults = Faults { kgm, fdj_n, ..Faults::default() };
    let recipe = Simulation::new(model, Drive::Diagnostic, faults, 5.11, 100_000.0);
    simulate(&recipe, &ParameterSet::reference(), &Unwatched).unwrap()
}

/// The thesis's two features: current over 1.8 to 1.9 s in mA, pressure over 5.09 to 5.11 s in kPa.
pub fn features(trace: &Trace) -> (f64, f64) {
    let mean = |channel, from_s, to_s| mean_between(trace.time_s(), trace.channel(channel).unwrap(), from_s, to_s);
    let current_a = mean(Channel::ServovalveCurrent, 1.8, 1.9).unwrap();
    (current_a * 1e3, mean(Channel::LoadPressure, 5.09, 5.11).unwrap() * 1e-3)
}

#[test]
fn validate_table_6_3_comes_out_within_0_2_percent() {
    cases().par_iter().zip(TABLE_6_3).for_each(|(&(kgm, fdj_n), (thesis_ma, thesis_kpa))| {
        let (current_ma, pressure_kpa) = features(&diagnostic(ModelKind::Reference, kgm, fdj_n));
        let errors = [current_ma / thesis_ma - 1.0, pressure_kpa / thesis_kpa - 1.0];
        assert!(errors.iter().all(|e| e.abs() < 2e-3), "KGM {kgm}, FDJ {fdj_n}: relative errors {errors:?}");
        println!("{kgm} {fdj_n} {current_ma:.4} {pressure_kpa:.3} {errors:?}");
    });
}
