//! The reference model against the thesis's Table 6.3.

use rayon::prelude::*;

use elevon::models::drive::Drive;
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::statistics::mean_between;
use elevon::numeric::watch::Unwatched;

/// Section 6.3: KGM, FDJ in N, steady current in mA, steady pressure in kPa (the thesis prints MPa, a slip).
pub const TABLE_6_3: [(f64, f64, f64, f64); 25] = [
    (0.0, 200.0, 9.4089, 250.972),
    (0.0, 400.0, 9.4726, 501.076),
    (0.0, 600.0, 9.5324, 751.027),
    (0.0, 800.0, 9.6221, 1001.011),
    (0.0, 1000.0, 9.6944, 1251.038),
    (0.1, 200.0, 10.4586, 251.259),
    (0.1, 400.0, 10.5258, 501.294),
    (0.1, 600.0, 10.5934, 751.163),
    (0.1, 800.0, 10.6862, 1001.361),
    (0.1, 1000.0, 10.7662, 1251.460),
    (0.2, 200.0, 11.7648, 251.625),
    (0.2, 400.0, 11.8406, 501.718),
    (0.2, 600.0, 11.9156, 751.816),
    (0.2, 800.0, 12.0198, 1001.920),
    (0.2, 1000.0, 12.1045, 1251.821),
    (0.3, 200.0, 13.4388, 252.216),
    (0.3, 400.0, 13.5283, 502.112),
    (0.3, 600.0, 13.6169, 752.319),
    (0.3, 800.0, 13.7141, 1002.392),
    (0.3, 1000.0, 13.8309, 1252.352),
    (0.4, 200.0, 15.6703, 253.348),
    (0.4, 400.0, 15.7684, 503.585),
    (0.4, 600.0, 15.8739, 753.395),
    (0.4, 800.0, 16.0122, 1003.799),
    (0.4, 1000.0, 16.1249, 1253.851),
];

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
    TABLE_6_3.par_iter().for_each(|&(kgm, fdj_n, thesis_ma, thesis_kpa)| {
        let (current_ma, pressure_kpa) = features(&diagnostic(ModelKind::Reference, kgm, fdj_n));
        let errors = [current_ma / thesis_ma - 1.0, pressure_kpa / thesis_kpa - 1.0];
        assert!(errors.iter().all(|e| e.abs() < 2e-3), "KGM {kgm}, FDJ {fdj_n}: relative errors {errors:?}");
        println!("{kgm} {fdj_n} {current_ma:.4} {pressure_kpa:.3} {errors:?}");
    });
}
