//! `elevon parameters` as a process.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use elevon::models::parameters::ParameterSet;

fn parameters(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_elevon")).current_dir(folder).arg("parameters").args(args).output().unwrap()
}

fn refusal(output: &Output) -> String {
    let error = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
    assert!(output.stdout.is_empty());
    error
}

#[test]
fn shows_what_each_model_needs_with_value_range_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let count = |args: &[&str]| {
        let output = parameters(folder.path(), args);
        assert!(output.status.success() && output.stderr.is_empty());
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((document["name"].as_str(), document["hash"].as_str().unwrap().len()), (Some("reference"), 64));
        document["parameters"].as_array().unwrap().clone()
    };
    let all = count(&["--json"]);
    let monitoring = count(&["show", "reference", "--model", "monitoring", "--json"]);
    let reference = count(&["show", "--model", "reference", "--json"]);
    assert_eq!(all.len(), ParameterSet::reference().parameters().len());
    let both = all.iter().filter(|parameter| parameter["model"] == "both").count();
    assert_eq!(monitoring.len() + reference.len(), all.len() + both);
    let gain = monitoring.iter().find(|p| p["name"] == "monitoring.fluid.flow_gain_m2_per_s").unwrap();
    assert_eq!((gain["value"].as_f64(), gain["unit"].as_str()), (Some(0.2062), Some("m2/s")));
    assert!(gain["min"].is_number() && gain["max"].is_number());
    let text = String::from_utf8(parameters(folder.path(), &[]).stdout).unwrap();
    assert!(text.lines().any(|line| line.starts_with("jack.area_m2 ") && line.ends_with("1e-6 to 1 m2")), "{text}");
}

#[test]
fn a_bad_set_is_refused_in_one_line_with_all_its_errors() {
    let folder = tempfile::tempdir().unwrap();
    let bad = ParameterSet::reference().to_toml().replace("mass_kg = 10.0", "mass = 10.0").replace("= 345.0", "= -1.0");
    fs::write(folder.path().join("bad.toml"), bad).unwrap();
    for args in [["check", "bad.toml"], ["show", "bad.toml"], ["fit", "bad.toml"]] {
        let error = refusal(&parameters(folder.path(), &args));
        for part in
            ["bad.toml", "jack.mass_kg: missing", "jack.mass: found an unknown", "jack.damping_n_s_per_m: found -1"]
        {
            assert!(error.contains(part), "{part} is not in {error}");
        }
    }
    assert!(
        refusal(&parameters(folder.path(), &["fit", "nowhere.toml"]))
            .contains("nowhere.toml: expected reference or a file")
    );
    let error = refusal(&parameters(folder.path(), &["fit", "--json", "--out", "-"]));
    assert!(error.contains("--out: found - with --json"), "{error}");
}

#[test]
fn fits_a_set_without_a_monitoring_model_and_writes_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let text = ParameterSet::reference().to_toml();
    let half = text[..text.find("[monitoring.first_stage]").unwrap()].replace("\"reference\"", "\"mine\"");
    fs::write(folder.path().join("half.toml"), half).unwrap();
    assert!(
        refusal(&parameters(folder.path(), &["check", "half.toml"])).contains("monitoring.bias.current_ratio: missing")
    );
    let output = parameters(folder.path(), &["fit", "half.toml", "--out", "whole.toml", "--json"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let values = document["parameters"].as_array().unwrap();
    assert!(values.iter().all(|value| value["old"].is_null() && value["new"].is_number()), "nothing was before");
    assert_eq!(document["features"].as_array().unwrap().len(), 3);
    assert!(document["zero_flow"]["rms_of_supply"].as_f64().unwrap() < 0.03);
    let checked = String::from_utf8(parameters(folder.path(), &["check", "whole.toml"]).stdout).unwrap();
    assert!(checked.contains("a valid set, mine") && checked.contains(document["hash"].as_str().unwrap()), "{checked}");
}
