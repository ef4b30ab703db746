//! The monitoring model against the reference model, where no table of the thesis was used.

use rayon::prelude::*;

use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::ModelKind;

use super::table_6_3::{diagnostic, features};

#[test]
fn validate_the_current_ratio_and_the_pressure_difference_between_the_tables_fault_levels() {
    let pairs: Vec<(f64, f64)> =
        [0.05, 0.15, 0.25, 0.35].iter().flat_map(|&k| [300.0, 500.0, 700.0, 900.0].map(|f| (k, f))).collect();
    let differences: Vec<(f64, f64)> = pairs
        .par_iter()
        .map(|&(kgm, fdj_n)| {
            let (reference_ma, reference_kpa) = features(&diagnostic(ModelKind::Reference, kgm, fdj_n));
            let (monitoring_ma, monitoring_kpa) = features(&diagnostic(ModelKind::Monitoring, kgm, fdj_n));
            (reference_ma / monitoring_ma, (reference_kpa - monitoring_kpa) * 1e3)
        })
        .collect();
    for (pair, difference) in pairs.iter().zip(&differences) {
        println!("{pair:?} {difference:?}");
    }
    let spread = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt())
    };
    let (ratio, ratio_std) = spread(differences.iter().map(|d| d.0).collect());
    let (_, pressure_std_pa) = spread(differences.iter().map(|d| d.1).collect());
    println!("ratio {ratio} +- {ratio_std}, pressure +- {pressure_std_pa} Pa");
    let set = ParameterSet::reference();
    let bias = &set.monitoring_model().bias;
    assert!((bias.current_ratio - ratio).abs() < 1e-4, "{ratio}");
    // Two values in truth, with and without the oscillation: the spread has to cover the further one.
    let furthest = differences.iter().map(|d| (d.0 - ratio).abs()).fold(0.0, f64::max);
    assert!((0.9..=1.1).contains(&(bias.current_ratio_std / furthest)), "{furthest}, standard deviation {ratio_std}");
    assert!((0.9..=3.0).contains(&(bias.load_pressure_std_pa / pressure_std_pa)), "{pressure_std_pa}");
    // The surface, at levels of which it has none: quiet runs lie within its spread, which has room for a spool that rests.
    let surface_off = pairs.iter().zip(&differences).map(|(&(kgm, fdj_n), &(ratio, pressure_pa))| {
        let known = bias.at(kgm, fdj_n);
        let off = (ratio - known.current_ratio, pressure_pa - known.load_pressure_pa);
        assert!(off.0.abs() < 2.5 * known.current_ratio_std, "KGM {kgm}, FDJ {fdj_n}: {off:?}, {known:?}");
        assert!(off.1.abs() < 3.0 * known.load_pressure_std_pa, "KGM {kgm}, FDJ {fdj_n}: {off:?}, {known:?}");
        off.0.powi(2)
    });
    let surface_std = (surface_off.sum::<f64>() / pairs.len() as f64).sqrt();
    println!("about the surface {surface_std}");
    assert!(surface_std < 0.3 * ratio_std, "{surface_std}, about the mean {ratio_std}");
}
