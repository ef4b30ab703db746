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
    assert_refused(&simulate(&["--fault", "rust=1", "--out", "x.csv"]), &["rust", "expected kgm, fdj"]);
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
