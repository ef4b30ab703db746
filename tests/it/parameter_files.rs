//! The parameter files that come with the program.

use std::fs;
use std::path::Path;

use elevon::estimation::{Settings, Verdict, estimate};
use elevon::jobs::kind::SimulationSpec;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::simulate;
use elevon::numeric::watch::Unwatched;
use serde::Deserialize as _;
use serde_json::json;

/// Every file of `config/actuators` with its name.
fn files() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/actuators");
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
    paths.map(|path| (name(&path), fs::read_to_string(&path).unwrap())).collect()
}

#[test]
fn every_parameter_file_is_valid_and_holds_the_set_of_its_name() {
    let files = files();
    assert!(files.len() >= 2, "{files:?}");
    for (name, text) in files {
        let set = ParameterSet::parse(&text).unwrap_or_else(|errors| panic!("{name}.toml: {errors:#?}"));
        assert_eq!(set.name(), name);
    }
}

#[test]
fn recovers_the_faults_of_the_small_aileron_s_own_reference_model_with_its_set_and_twice_the_friction_with_the_built_in_one()
 {
    let (_, text) = files().into_iter().find(|(name, _)| name == "small-aileron").unwrap();
    let set = ParameterSet::parse(&text).unwrap();
    let recipe = json!({"model": "reference", "command": "diagnostic", "faults": {"kgm": 0.2, "fdj_n": 400.0},
        "duration_s": 6.0, "sample_rate_hz": 1000.0});
    let recipe = SimulationSpec::deserialize(recipe).unwrap().recipe().unwrap();
    let trace = simulate(&recipe, &set, &Unwatched).unwrap();
    let with = |set: &ParameterSet| estimate(&trace, set, &Settings::default(), &Unwatched).unwrap();
    let (own, built_in) = (with(&set), with(&ParameterSet::reference()));
    assert_eq!((own.parameter_set_hash.as_str(), own.verdict), (set.hash(), Verdict::Conclusive), "{:?}", own.reasons);
    assert!((own.kgm.unwrap() - 0.2).abs() < 3.0 * own.kgm_std.unwrap(), "{own:?}");
    assert!((own.fdj_n.unwrap() - 400.0).abs() < 0.5, "{own:?}");
    assert!((built_in.fdj_n.unwrap() - 800.0).abs() < 2.0, "half the jack's area, the same pressure: {built_in:?}");
}
