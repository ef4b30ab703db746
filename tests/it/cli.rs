//! The program as a process: what it writes, what it says, its exit status.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs the program in a folder.
fn elevon(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_elevon")).current_dir(folder).args(args).output().unwrap()
}

/// Asserts bad usage or bad input: status 2, one line on standard error that says all of this, nothing elsewhere.
fn assert_refused(output: &Output, says: &[&str]) {
    let error = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(output.stdout.is_empty());
    assert_eq!(error.lines().count(), 1, "{error}");
    for part in says {
        assert!(error.contains(part), "{part} is not in: {error}");
    }
}

const SIMULATE: [&str; 7] = ["simulate", "--model", "reference", "--command", "diagnostic", "--kgm", "0.1"];

#[test]
fn simulates_a_trace_and_estimates_it_in_either_format() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["trace.csv", "trace.json"] {
        let simulated = elevon(folder.path(), &[&SIMULATE[..], &["--fdj-n", "400", "--out", file]].concat());
        assert!(simulated.status.success() && simulated.stdout.is_empty() && simulated.stderr.is_empty());
    }
    let estimated = elevon(folder.path(), &["estimate", "trace.csv", "trace.json", "--json"]);
    assert!(estimated.status.success());
    let reports: Vec<Value> = serde_json::from_slice(&estimated.stdout).unwrap();
    assert_eq!(reports.len(), 2);
    for (report, file) in reports.iter().zip(["trace.csv", "trace.json"]) {
        assert_eq!((report["file"].as_str(), report["verdict"].as_str()), (Some(file), Some("conclusive")));
        assert!((report["kgm"].as_f64().unwrap() - 0.1).abs() < 0.003, "{report}");
        assert!((report["fdj_n"].as_f64().unwrap() - 400.0).abs() < 1.0, "{report}");
        assert_eq!(report["parameter_set_hash"].as_str().unwrap().len(), 64);
        for field in ["kgm_std", "fdj_n_std", "cost", "evaluations", "elapsed_s", "seed"] {
            assert!(report[field].is_number(), "{field}: {report}");
        }
        assert!(report["method"].is_string() && report["objective"].is_string() && report["faults"].is_object());
    }
}

#[test]
fn standard_output_is_csv_with_the_contract_s_columns_first() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["simulate", "--model", "monitoring", "--command", "step:0.1", "--duration", "0.1", "--out", "-"];
    let output = elevon(folder.path(), &args);
    let text = String::from_utf8(output.stdout).unwrap();
    let first = "time_s,position_command_m,servovalve_current_a,load_pressure_pa,jack_position_m,";
    assert!(text.starts_with(first), "{}", text.lines().next().unwrap_or_default());
    assert_eq!(text.lines().count(), 102);
}

#[test]
fn the_method_of_the_search_and_its_choices_are_options() {
    let folder = tempfile::tempdir().unwrap();
    elevon(folder.path(), &[&SIMULATE[..], &["--fdj-n", "400", "--out", "trace.csv"]].concat());
    let estimate = |more: &[&str]| elevon(folder.path(), &[&["estimate", "trace.csv", "--json"], more].concat());
    for (options, method) in [
        (&["--method", "gwo"][..], "gwo"),
        (&["--ga", "thesis"], "ga"),
        (&["--ga", "crossover=heuristic:1.2"], "ga(crossover=heuristic:1.2)"),
    ] {
        let reports: Vec<Value> = serde_json::from_slice(&estimate(options).stdout).unwrap();
        assert_eq!((reports[0]["method"].as_str(), reports[0]["verdict"].as_str()), (Some(method), Some("conclusive")));
    }
    assert_refused(&estimate(&["--method", "luck"]), &["--method", "luck", "ga, de, pso, gwo, dragonfly, multistart"]);
    assert_refused(&estimate(&["--ga", "crossover=heuristic"]), &["--ga", "crossover=heuristic", "heuristic:RATIO"]);
}

#[test]
fn an_inconclusive_estimate_is_an_answer() {
    let folder = tempfile::tempdir().unwrap();
    elevon(folder.path(), &["simulate", "--model", "reference", "--command", "step:0", "--out", "idle.csv"]);
    let output = elevon(folder.path(), &["estimate", "idle.csv"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("inconclusive") && text.contains("no manoeuvre"), "{text}");
}

#[test]
fn bad_usage_is_refused_in_one_line_that_names_the_field() {
    let folder = tempfile::tempdir().unwrap();
    let simulate = |more: &[&str]| elevon(folder.path(), &[&SIMULATE[..5], more].concat());
    assert_refused(&simulate(&["--kgm", "1.5", "--out", "x.csv"]), &["kgm", "found 1.5", "expected 0 to 1"]);
    assert_refused(&simulate(&["--fdj-n", "-5", "--out", "x.csv"]), &["fdj_n", "found -5", "expected 200 to 2000 N"]);
    assert_refused(&simulate(&["--fault", "rust=1", "--out", "x.csv"]), &["rust", "expected one of kgm, fdj"]);
    assert_refused(&simulate(&["--duration", "inf", "--out", "x.csv"]), &["duration_s", "found inf"]);
    assert_refused(&simulate(&["--out", "x.txt"]), &["x.txt", ".csv or .json"]);
    assert_refused(&elevon(folder.path(), &["simulate", "--model", "reference"]), &["--command"]);
    assert_refused(&elevon(folder.path(), &["estimate", "missing.csv"]), &["missing.csv"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
}

#[test]
fn a_bad_file_is_refused_in_one_line_that_names_file_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let text = "time_s,position_command_m,servovalve_current_ma\n0,0,1\n0.001,0,oops\n";
    std::fs::write(folder.path().join("bad.csv"), text).unwrap();
    let output = elevon(folder.path(), &["estimate", "bad.csv", "--json"]);
    assert_refused(&output, &["bad.csv", "line 3", "servovalve_current_ma", "oops"]);
}

#[test]
fn columns_are_mapped_by_an_option() {
    let folder = tempfile::tempdir().unwrap();
    elevon(folder.path(), &[&SIMULATE[..], &["--fdj-n", "400", "--out", "trace.csv"]].concat());
    let file = folder.path().join("trace.csv");
    let renamed = std::fs::read_to_string(&file).unwrap().replacen("servovalve_current_a", "Cor", 1);
    std::fs::write(&file, renamed).unwrap();
    let output = elevon(folder.path(), &["estimate", "trace.csv", "--columns", "Cor:servovalve_current_a", "--json"]);
    let reports: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(reports[0]["verdict"], "conclusive");
}

/// The built-in set's text with parts of it replaced.
fn set_with(replaced: &[(&str, &str)]) -> String {
    let mut text = include_str!("../../config/actuators/reference.toml").to_owned();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    text
}

#[test]
fn a_file_s_parameters_change_the_trace_and_the_estimate_and_its_hash() {
    let folder = tempfile::tempdir().unwrap();
    let changed = set_with(&[("name = \"reference\"", "name = \"large\""), ("area_m2 = 8.0e-4", "area_m2 = 8.8e-4")]);
    std::fs::write(folder.path().join("large.toml"), changed).unwrap();
    let sets =
        [("built-in", &[][..]), ("named", &["--parameters", "reference"]), ("file", &["--parameters", "large.toml"])];
    let (mut traces, mut reports) = (Vec::new(), Vec::new());
    for (name, option) in sets {
        let file = format!("{name}.csv");
        let simulated = elevon(folder.path(), &[&SIMULATE[..], &["--fdj-n", "400", "--out", &file], option].concat());
        assert!(simulated.status.success(), "{}", String::from_utf8_lossy(&simulated.stderr));
        traces.push(std::fs::read(folder.path().join(file)).unwrap());
        // The whole trace would tell that the jack is another one: its spool stands elsewhere.
        let estimate = ["estimate", "built-in.csv", "--json", "--objective", "features"];
        let estimated = elevon(folder.path(), &[&estimate, option].concat());
        let mut report: Vec<Value> = serde_json::from_slice(&estimated.stdout).unwrap();
        reports.push(report.remove(0));
    }
    assert!(traces[0] == traces[1] && traces[0] != traces[2]);
    let field = |name: &str| reports.iter().map(|report| report[name].clone()).collect::<Vec<_>>();
    let (hashes, frictions) = (field("parameter_set_hash"), field("fdj_n"));
    assert!(hashes[0] == hashes[1] && hashes[0] != hashes[2], "{hashes:?}");
    assert_eq!(frictions[0], frictions[1]);
    // The creeping jack's pressure is friction over area: as much pressure on a tenth more area is a tenth more friction.
    let ratio = frictions[2].as_f64().unwrap() / frictions[0].as_f64().unwrap();
    assert!((ratio - 1.1).abs() < 0.01, "{frictions:?}");
    let told = elevon(folder.path(), &["estimate", "built-in.csv", "--parameters", "large.toml"]);
    let shown = format!("parameter set large@{}", &hashes[2].as_str().unwrap()[..8]);
    assert!(String::from_utf8(told.stdout).unwrap().contains(&shown), "{shown}");
}

#[test]
fn every_error_of_a_parameter_file_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let bad = set_with(&[
        ("area_m2 = 8.0e-4", "area_m2 = -1.0"),
        ("mass_kg = 10.0", "mass_lb = 22.0"),
        ("oil = \"constant\"", "oil = \"olive\""),
    ]);
    std::fs::write(folder.path().join("bad.toml"), bad).unwrap();
    let says = [
        "bad.toml: jack.mass_lb: found an unknown parameter, expected area_m2, ",
        "; jack.area_m2: found -1, expected 1e-6 to 1 m2; jack.mass_kg: missing, expected 0.01 to 10000 kg",
        "; reference.oil.oil: found \"olive\", expected one of constant,",
    ];
    let simulated = elevon(folder.path(), &[&SIMULATE[..], &["--parameters", "bad.toml", "--out", "x.csv"]].concat());
    assert_refused(&simulated, &says);
    assert!(!folder.path().join("x.csv").exists());
    assert_refused(&elevon(folder.path(), &["estimate", "x.csv", "--parameters", "bad.toml"]), &says);
}

#[test]
fn what_is_no_parameter_set_is_refused_by_its_name_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, bytes: Option<&[u8]>, says: &[&str]| {
        if let Some(bytes) = bytes {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        assert_refused(&elevon(folder.path(), &["estimate", "x.csv", "--parameters", name]), says);
    };
    refused("aileron", None, &["aileron: expected reference or a file", "No such file"]);
    refused(".", None, &[".: expected reference or a file", "directory"]);
    refused("syntax.toml", Some(b"name = \"x\"\n[jack\n"), &["syntax.toml: line 2, column 6"]);
    refused("bytes.toml", Some(b"name = \"x\"\n\xff\n"), &["bytes.toml: line 2", "UTF-8"]);
    refused("long.toml", Some(&[b'#'; 1_000_001]), &["long.toml", "found more than 1000000 bytes"]);
    refused("empty.toml", Some(b""), &["empty.toml: name: missing, expected a text; controller."]);
}
