//! `elevon simulate`: commands, loads and supplies from files, and what a trace says of its making.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn simulate(folder: &Path, args: &str) -> Output {
    let args = format!("simulate --model reference {args}");
    let program = env!("CARGO_BIN_EXE_elevon");
    Command::new(program).current_dir(folder).args(args.split_whitespace()).output().unwrap()
}

/// A column of a simulated CSV.
fn column(output: &Output, name: &str) -> Vec<f64> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|found| found == name).unwrap_or_else(|| panic!("no {name}"));
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

/// The greatest difference of two columns.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Writes a CSV with 101 samples over a second.
fn write(folder: &Path, file: &str, header: &str, value: impl Fn(f64) -> f64) {
    let rows: String = (0..=100).map(|k| f64::from(k) / 100.0).map(|t| format!("{t},{}\n", value(t))).collect();
    std::fs::write(folder.join(file), format!("{header}\n{rows}")).unwrap();
}

#[test]
fn a_command_from_a_file_moves_the_jack_as_the_command_that_it_records_and_lasts_as_long() {
    let folder = tempfile::tempdir().unwrap();
    let sine = simulate(folder.path(), "--command sine:0.05@1 --duration 0.8 --sample-rate 5000 --out sine.csv");
    assert!(sine.status.success());
    let direct = simulate(folder.path(), "--command sine:0.05@1 --duration 0.8 --out -");
    let replayed = simulate(folder.path(), "--command file:sine.csv --out -");
    assert!(apart(&column(&direct, "jack_position_m"), &column(&replayed, "jack_position_m")) < 1e-7);
    write(folder.path(), "bare.csv", "time_ms,position_command_mm", |t| 100.0 * t);
    let times = std::fs::read_to_string(folder.path().join("bare.csv")).unwrap();
    // Times in milliseconds that do not begin at zero.
    let late: String = times.lines().enumerate().fold(String::new(), |text, (row, line)| {
        let (t, rest) = line.split_once(',').unwrap();
        let t = if row == 0 { t.to_owned() } else { (t.parse::<f64>().unwrap() * 1e3 + 5e3).to_string() };
        text + &t + "," + rest + "\n"
    });
    std::fs::write(folder.path().join("bare.csv"), late).unwrap();
    let ramp = simulate(folder.path(), "--command ramp:0.1 --duration 1 --out -");
    let bare = simulate(folder.path(), "--command file:bare.csv --out -");
    assert!(apart(&column(&ramp, "position_command_m"), &column(&bare, "position_command_m")) < 1e-12);
}

#[test]
fn validate_section_4_1_4_an_external_load_is_carried_by_the_pressure_whether_constant_or_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("load.csv"), "time_s,external_load_n\n0,800\n5,800\n").unwrap();
    let run = |more: &str| simulate(folder.path(), &format!("--command ramp:0.05 --duration 1 --out - {more}"));
    let (free, constant, recorded) = (run(""), run("--external-load 800"), run("--external-load file:load.csv"));
    let pressure = |output: &Output| *column(output, "load_pressure_pa").last().unwrap();
    // 800 N on 8 cm2 are 1 MPa.
    let rise_pa = pressure(&constant) - pressure(&free);
    assert!((rise_pa / 1e6 - 1.0).abs() < 0.01, "{rise_pa}");
    assert_eq!(constant.stdout, recorded.stdout);
    assert!(column(&recorded, "external_load_n").iter().all(|n| *n == 800.0));
    assert!(!String::from_utf8_lossy(&free.stdout).contains("external_load_n"));
}

#[test]
fn validate_section_4_1_2_the_supply_pressure_may_vary_during_a_run() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "supply.csv", "time_s,supply_pressure_bar", |t| if t < 0.1 { 206.0 } else { 60.0 });
    let run = |more: &str| simulate(folder.path(), &format!("--command step:0.2 --duration 0.6 --out - {more}"));
    let (nominal, same, falling) = (run(""), run("--supply-pressure 20.6e6"), run("--supply-pressure file:supply.csv"));
    let position = |output: &Output| column(output, "jack_position_m");
    assert_eq!(position(&nominal), position(&same));
    let (nominal, falling) = (position(&nominal), position(&falling));
    assert_eq!(nominal[..85], falling[..85], "until the pressure begins to fall");
    assert!(falling[250] < 0.9 * nominal[250], "{} {}", falling[250], nominal[250]);
}

#[test]
fn what_cannot_act_on_a_model_is_refused_with_file_and_column() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "load.csv", "time_s,external_load_n", |_| 2e6);
    for (args, says) in [
        ("--command file:missing.csv", vec!["missing.csv"]),
        ("--command file:load.csv", vec!["load.csv", "line 1", "position_command"]),
        ("--command step:0.1 --external-load file:load.csv", vec!["external_load_n", "found 2000000", "-1e6 to 1e6 N"]),
        ("--command step:0.1 --supply-pressure 1e8", vec!["supply_pressure_pa", "found 100000000", "at most 41200000"]),
        ("--command step:0.1 --supply-pressure lots", vec!["--supply-pressure", "lots", "a number or file:FILE"]),
        ("--command chirp:0.1@5", vec!["--command", "chirp", "0.1@5", "two frequencies"]),
    ] {
        let output = simulate(folder.path(), &format!("{args} --duration 0.2 --out -"));
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len(), error.lines().count()), (Some(2), 0, 1), "{error}");
        assert!(says.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn single_parameters_are_set_on_the_command_line_and_change_the_hash() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &str| {
        let args = format!("--command sine:0.05@2 --duration 0.2 --out trace.json {more}");
        let output = simulate(folder.path(), &args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read(folder.path().join("trace.json")).unwrap();
        serde_json::from_slice::<Value>(&text).unwrap()
    };
    let plain = run("");
    let changed = run("--set jack.mass_kg=20 --set reference.friction.model=karnopp");
    assert_ne!(plain["columns"]["jack_position_m"], changed["columns"]["jack_position_m"]);
    assert_ne!(plain["metadata"]["parameter_set_hash"], changed["metadata"]["parameter_set_hash"]);
    let refused = simulate(folder.path(), "--command step:0.1 --out - --set jack.mass_kg=0 --set jack.weight=1");
    let error = String::from_utf8(refused.stderr).unwrap();
    assert_eq!((refused.status.code(), error.lines().count()), (Some(2), 1), "{error}");
    assert!(error.contains("jack.weight: found an unknown parameter, expected area_m2"), "{error}");
    assert!(error.contains("jack.mass_kg: found 0, expected 0.01 to 10000 kg"), "{error}");
}

#[test]
fn a_trace_in_json_says_what_it_was_made_from() {
    let folder = tempfile::tempdir().unwrap();
    let args = "--command chirp:0.05@0.5-10 --duration 0.1 --kgm 0.2 --noise-power 5e-6 --seed 18446744073709551615";
    assert!(simulate(folder.path(), &format!("{args} --out trace.json")).status.success());
    let trace: Value = serde_json::from_slice(&std::fs::read(folder.path().join("trace.json")).unwrap()).unwrap();
    let made = &trace["metadata"];
    assert_eq!(made["seed"].as_u64(), Some(u64::MAX));
    assert_eq!(made["parameter_set_hash"].as_str().unwrap().len(), 64);
    assert_eq!((made["command"].as_str(), made["model"].as_str()), (Some("chirp:0.05@0.5-10"), Some("reference")));
    assert_eq!(made["faults"]["kgm"], 0.2);
    assert!(made["version"].is_string() && made["parameter_set"] == "reference");
}
