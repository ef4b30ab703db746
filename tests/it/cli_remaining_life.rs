//! `elevon remaining-life` as a process.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

const PROBABILITIES: [&str; 7] = ["0.05", "0.1", "0.25", "0.5", "0.75", "0.9", "0.95"];

/// A folder with one history in it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn with(name: &str, text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), text).unwrap();
        Self(folder)
    }

    fn run(&self, args: &[&str]) -> Output {
        forecast(self.0.path(), args)
    }
}

fn forecast(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_elevon")).current_dir(folder).arg("remaining-life").args(args).output().unwrap()
}

/// The one JSON document of a run that ended well.
#[track_caller]
fn document(output: &Output) -> Value {
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && error.is_empty(), "{error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn of_csv(text: &str, args: &[&str]) -> Value {
    document(&Folder::with("h.csv", text).run(&[&["h.csv", "--json"], args].concat()))
}

fn of_json(file: &Value, args: &[&str]) -> Value {
    document(&Folder::with("h.json", &file.to_string()).run(&[&["h.json", "--json"], args].concat()))
}

/// Asserts bad usage or bad input: status 2, one line on standard error that says all of this, nothing elsewhere.
#[track_caller]
fn refused(file: &str, text: &str, args: &[&str], says: &[&str]) {
    let output = Folder::with(file, text).run(&[&[file, "--json"], args].concat());
    let error = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
    assert!(output.stdout.is_empty());
    for part in says {
        assert!(error.contains(part), "{part} is not in: {error}");
    }
}

/// A level that grows by 0.004 per hour from 0.02, seen every 2 hours with a small regular scatter, up to the usage 78.
fn growing(observations: usize) -> (Vec<f64>, Vec<f64>) {
    let usage = (0..observations).map(|i| 2.0 * i as f64);
    let value = (0..observations).map(|i| 0.02 + 0.008 * i as f64 + 0.004 * (f64::from((i % 3) as u8) - 1.0));
    (usage.collect(), value.collect())
}

fn csv((usage, value): &(Vec<f64>, Vec<f64>), header: &str) -> String {
    usage.iter().zip(value).fold(format!("{header}\n"), |text, (usage, value)| text + &format!("{usage},{value}\n"))
}

fn quantiles(forecast: &Value) -> Vec<Option<f64>> {
    PROBABILITIES.iter().map(|p| forecast["quantiles"][p].as_f64()).collect()
}

/// The fields of the contract, and quantiles in rising order that are null only at the end.
#[track_caller]
fn assert_shape(forecast: &Value) {
    let fields = forecast.as_object().unwrap();
    let known =
        ["at", "unit", "quantiles", "mean", "reached", "probability_beyond_horizon", "horizon", "models", "elapsed_s"];
    assert!(known.iter().all(|field| fields.contains_key(*field)), "{forecast}");
    assert_eq!(forecast["quantiles"].as_object().unwrap().keys().collect::<Vec<_>>(), PROBABILITIES);
    let found = quantiles(forecast);
    let told: Vec<f64> = found.iter().map_while(|quantile| *quantile).collect();
    assert_eq!(told.len(), found.iter().flatten().count(), "{forecast}");
    assert!(told.is_sorted() && told.iter().all(|q| *q <= forecast["horizon"].as_f64().unwrap()), "{forecast}");
    assert!(forecast["reached"].is_boolean() && forecast["models"].is_array() && forecast["elapsed_s"].is_number());
}

#[test]
fn a_csv_gets_one_forecast_of_the_contract_s_shape() {
    let history = growing(40);
    let forecast = of_csv(&csv(&history, "usage,value"), &["--threshold", "0.4", "--direction", "rising"]);
    assert_shape(&forecast);
    assert_eq!((forecast["at"].as_f64(), forecast["unit"].as_str()), (Some(78.0), Some("flight_hours")));
    assert_eq!(forecast["horizon"].as_f64(), Some(20.0 * 78.0));
    // 0.02 + 0.004 * 95 is 0.4: 17 hours are left.
    let median = forecast["quantiles"]["0.5"].as_f64().unwrap();
    assert!((median - 17.0).abs() < 5.0, "{median}");
    let columns = csv(&history, "flight_cycles,kgm");
    let other = of_csv(&columns, &["--threshold", "0.4", "--direction", "rising"]);
    assert_eq!((&other["quantiles"], other["unit"].as_str()), (&forecast["quantiles"], Some("flight_cycles")));
    let told = of_csv(&columns, &["--threshold", "0.4", "--direction", "rising", "--unit", "flight_hours"]);
    assert_eq!(told["unit"], "flight_hours");
}

#[test]
fn a_json_history_says_what_is_asked_and_options_come_first() {
    let (usage, value) = growing(40);
    let file = json!({"threshold": 0.4, "direction": "rising", "usage": usage, "value": value, "at": 60});
    let forecast = of_json(&file, &[]);
    assert_shape(&forecast);
    assert_eq!(forecast["at"].as_f64(), Some(60.0));
    let past = csv(&growing(31), "t,h");
    let alike = of_csv(&past, &["--threshold", "0.4", "--direction", "rising"]);
    assert_eq!(quantiles(&forecast), quantiles(&alike));
    let later = of_json(&file, &["--at", "70", "--threshold", "0.5"]);
    assert_eq!(later["at"].as_f64(), Some(70.0));
    assert!(quantiles(&later)[3] > quantiles(&forecast)[3]);
}

#[test]
fn what_lies_beyond_the_horizon_is_null() {
    let text = csv(&growing(40), "usage,value");
    let forecast = of_csv(&text, &["--threshold", "0.4", "--direction", "rising", "--horizon", "5"]);
    assert_shape(&forecast);
    assert_eq!((forecast["horizon"].as_f64(), forecast["quantiles"]["0.95"].as_f64()), (Some(5.0), None));
    assert!(forecast["probability_beyond_horizon"].as_f64().unwrap() > 0.5);
    assert_eq!(forecast["act_by"]["usage"].as_f64(), quantiles(&forecast)[0].map(|remaining| 78.0 + remaining));
}

#[test]
fn the_risk_within_some_usage_and_the_usage_by_which_to_act_are_told() {
    let text = csv(&growing(40), "usage,value");
    let options = ["--threshold", "0.4", "--direction", "rising"];
    let plain = of_csv(&text, &options);
    assert!(plain["risk"].is_null());
    let quartile = plain["quantiles"]["0.25"].as_f64().unwrap();
    let asked = of_csv(&text, &[&options[..], &["--within", &quartile.to_string(), "--risk", "0.25"]].concat());
    assert_eq!(asked["quantiles"], plain["quantiles"]);
    assert!((asked["risk"]["probability"].as_f64().unwrap() - 0.25).abs() < 1e-3, "{asked}");
    assert!((asked["act_by"]["usage"].as_f64().unwrap() - 78.0 - quartile).abs() < 1e-2, "{asked}");
}

#[test]
fn a_batch_answers_every_usage_in_its_order_from_what_came_before_it() {
    let (usage, value) = growing(40);
    // After the usage 40 the second history is another one.
    let other: Vec<f64> =
        usage.iter().zip(&value).map(|(usage, value)| if *usage > 40.0 { 3.0 } else { *value }).collect();
    let at = [60.0, 20.0, -5.0, 0.0, 40.0, 200.0];
    let file = json!({"threshold": 0.4, "direction": "rising", "histories": [
        {"id": "first", "usage": usage, "value": value, "at": at},
        {"id": 7, "usage": usage, "value": other, "at": [40.0, 20.0]},
        {"id": "empty", "usage": [], "value": [], "at": [1.0]},
    ]});
    let answers = of_json(&file, &[]);
    let ids: Vec<&Value> = answers.as_array().unwrap().iter().map(|answer| &answer["id"]).collect();
    assert_eq!(ids, [&json!("first"), &json!(7), &json!("empty")]);
    let first = answers[0]["forecasts"].as_array().unwrap();
    assert_eq!(first.iter().map(|forecast| forecast["at"].as_f64().unwrap()).collect::<Vec<_>>(), at);
    let second = answers[1]["forecasts"].as_array().unwrap();
    assert_eq!((&first[4]["quantiles"], &first[1]["quantiles"]), (&second[0]["quantiles"], &second[1]["quantiles"]));
    for index in [0, 1, 3, 4, 5] {
        assert_shape(&first[index]);
    }
    // Before the first observation nothing is known; with it alone, little.
    for nothing in [&first[2], &answers[2]["forecasts"][0]] {
        assert_eq!(quantiles(nothing), [None; 7]);
        assert!(nothing["reasons"][0].as_str().unwrap().starts_with("no observation"), "{nothing}");
    }
    assert!(first[3]["reasons"][0].as_str().unwrap().starts_with("only one observation"), "{}", first[3]);
    let alone =
        of_json(&json!({"threshold": 0.4, "direction": "rising", "usage": usage, "value": value}), &["--at", "20"]);
    assert_eq!(alone["quantiles"], first[1]["quantiles"]);
}

#[test]
fn a_history_with_several_usages_is_answered_as_an_entry_of_a_batch() {
    let (usage, value) = growing(20);
    let file = json!({"threshold": 0.4, "direction": "rising", "usage": usage, "value": value, "at": [30, 10]});
    let answer = of_json(&file, &[]);
    assert_eq!((answer["forecasts"].as_array().unwrap().len(), answer.get("id")), (2, None));
    assert_eq!(of_json(&file, &["--at", "30"])["quantiles"], answer["forecasts"][0]["quantiles"]);
}

#[test]
fn the_direction_is_inferred_only_where_the_values_tell_it() {
    let up = of_csv(&csv(&growing(20), "usage,value"), &["--threshold", "0.4"]);
    let reasons = up["reasons"].as_array().unwrap();
    assert!(reasons.iter().any(|reason| reason.as_str().unwrap().contains("taken to be rising")), "{reasons:?}");
    let down = of_csv("usage,value\n0,1\n10,0.9\n20,0.8\n30,0.7\n", &["--threshold", "0.3"]);
    assert!(down["reasons"].to_string().contains("taken to be falling"), "{down}");
    let threshold = ["--threshold", "0.4"];
    refused("h.csv", "usage,value\n0,0.5\n1,0.6\n2,0.7\n", &threshold, &["h.csv: direction: missing", "move away"]);
    refused("h.csv", "usage,value\n0,0.3\n1,0.5\n", &threshold, &["direction: missing", "both sides", "--direction"]);
}

#[test]
fn one_point_gets_the_wide_forecast_of_the_prior_with_a_reason() {
    let forecast = of_csv("usage,value\n100,0.1\n", &["--threshold", "0.4", "--life-start", "0"]);
    assert_shape(&forecast);
    assert!(forecast["reasons"][0].as_str().unwrap().starts_with("only one observation"), "{forecast}");
    let [low, median] = [quantiles(&forecast)[1], quantiles(&forecast)[3]].map(Option::unwrap);
    assert!(low < 0.5 * median, "{forecast}");
    // Past the threshold, one noisy value alone is no end of life.
    let past = of_csv("usage,value\n100,0.5\n", &["--threshold", "0.4", "--direction", "rising"]);
    assert_eq!(past["reached"], false, "{past}");
}

#[test]
fn equal_usages_are_an_answer_and_falling_ones_are_not() {
    let equal = of_csv("usage,value\n5,0.1\n5,0.12\n5,0.11\n", &["--threshold", "0.4"]);
    assert_shape(&equal);
    assert!(!equal["reasons"].as_array().unwrap().is_empty());
    let some_equal = of_csv("usage,value\n0,0.1\n5,0.12\n5,0.11\n9,0.2\n", &["--threshold", "0.4"]);
    assert_shape(&some_equal);
    let says = ["h.csv", "line 5", "column usage", "found 4", "expected 5 or more"];
    refused("h.csv", "# a comment\nusage,value\n0,0.1\n5,0.12\n4,0.11\n", &["--threshold", "0.4"], &says);
    let batch = r#"{"threshold": 1, "histories": [{"t": [0, 1], "h": [0, 0]}, {"t": [0, 2, 1], "h": [0, 0, 0]}]}"#;
    refused("h.json", batch, &[], &["h.json", "/histories/1/t/2", "found 1", "expected 2 or more"]);
}

#[test]
fn what_is_no_finite_number_is_refused_by_its_place() {
    let threshold = ["--threshold", "0.4"];
    let says = ["h.csv", "line 3", "column value", "NaN", "finite"];
    refused("h.csv", "usage,value\n0,0.1\n5,NaN\n", &threshold, &says);
    refused("h.csv", "usage,value\n0,0.1\ninf,0.2\n", &threshold, &["line 3", "column usage", "inf", "finite"]);
    refused("h.json", r#"{"usage": [0], "value": [NaN]}"#, &threshold, &["h.json", "/value/0", "NaN", "finite"]);
    refused("h.json", r#"{"usage": [0], "value": [null]}"#, &threshold, &["/value/0", "found null"]);
    refused(
        "h.csv",
        "usage,value,std\n0,0.1,0.01\n5,0.2,-0.01\n",
        &threshold,
        &["line 3", "std", "-0.01", "0 or more"],
    );
    let negative = r#"{"usage": [0, 1], "value": [0.1, 0.2], "std": [0.01, -1]}"#;
    refused("h.json", negative, &threshold, &["h.json", "/std/1", "found -1", "expected 0 or more"]);
}

#[test]
fn a_threshold_already_passed_is_reached_and_one_passed_and_left_is_not() {
    let (usage, value) = growing(60);
    let rising = ["--threshold", "0.3", "--direction", "rising"];
    let passed = of_csv(&csv(&(usage.clone(), value), "usage,value"), &rising);
    assert_eq!((passed["reached"].as_bool(), passed["quantiles"]["0.5"].as_f64()), (Some(true), Some(0.0)), "{passed}");
    let back: Vec<f64> = (0..60).map(|i| if i == 20 || i == 21 { 0.35 } else { 0.05 + 0.001 * f64::from(i) }).collect();
    let left = of_csv(&csv(&(usage, back), "usage,value"), &rising);
    assert_shape(&left);
    assert_eq!(left["reached"], false, "{left}");
    // Every value is beyond the threshold from the beginning.
    let all = of_csv("usage,value\n0,0.5\n1,0.6\n2,0.7\n3,0.8\n", &["--threshold", "0.4", "--direction", "rising"]);
    assert_eq!(all["reached"], true, "{all}");
}

#[test]
fn a_million_points_are_answered() {
    let rows = (0..1_000_000).map(|i| format!("{i},{:.6}\n", 0.02 + 3e-7 * f64::from(i) + 0.004 * f64::from(i % 3)));
    let folder = Folder::with("h.csv", &("usage,value\n".to_owned() + &rows.collect::<String>()));
    let started = Instant::now();
    let forecast = document(&folder.run(&["h.csv", "--threshold", "0.4", "--json"]));
    assert!(started.elapsed() < Duration::from_secs(20), "{:?}", started.elapsed());
    assert_shape(&forecast);
    // (0.4 - 0.024) / 3e-7 - 999999
    let median = forecast["quantiles"]["0.5"].as_f64().unwrap();
    assert!((median / 253_334.0 - 1.0).abs() < 0.3, "{median}");
}

#[test]
fn bad_usage_is_refused_by_the_name_of_the_option() {
    let text = "usage,value\n0,0.1\n5,0.2\n";
    let with = |args: &[&str], says: &[&str]| refused("h.csv", text, args, says);
    with(&[], &["h.csv", "threshold", "missing", "--threshold F"]);
    with(&["--threshold", "NaN"], &["--threshold", "NaN", "finite"]);
    with(&["--threshold", "0.4", "--horizon", "0"], &["--horizon", "0", "above 0"]);
    with(&["--threshold", "0.4", "--within", "-1"], &["--within", "-1", "0 or more"]);
    with(&["--threshold", "0.4", "--risk", "1"], &["--risk", "1", "above 0 and below 1"]);
    with(&["--threshold", "0.4", "--direction", "up"], &["--direction", "up", "rising or falling"]);
    with(&["--threshold", "0.4", "--unit", "days"], &["--unit", "days", "flight_hours or flight_cycles"]);
    with(&["--threshold", "0.4", "--alpha", "0.1"], &["--evaluate"]);
    let sided = ["--threshold", "0.4", "--direction", "rising", "--healthy", "0.5"];
    with(&sided, &["h.csv", "threshold", "found 0.4", "above healthy"]);
    let far = "usage,value\n0,0.1\n# two\n5,1e9\n";
    let rising = ["--threshold", "0.4", "--direction", "rising", "--healthy", "0"];
    refused("h.csv", far, &rising, &["h.csv", "line 4", "column value", "found 1000000000"]);
    refused("h.csv", "usage,level\n0,1\n", &rising, &["h.csv", "line 1", "level", "expected one of value"]);
    refused("h.txt", text, &rising, &["h.txt", ".csv or .json"]);
    let output = forecast(tempfile::tempdir().unwrap().path(), &["missing.csv", "--threshold", "1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("missing.csv"));
}

#[test]
fn a_person_is_told_quantiles_risk_laws_and_reasons() {
    let folder = Folder::with("h.csv", &csv(&growing(40), "flight_cycles,kgm"));
    let output = folder.run(&["h.csv", "--threshold", "0.4", "--within", "10"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for part in
        ["rising to the threshold 0.4", "50 %", "failure within 10.00 flight cycles: ", "act by usage", "laws: "]
    {
        assert!(text.contains(part), "{part} is not in: {text}");
    }
    assert!(text.contains("the direction is taken to be rising"), "{text}");
    let (usage, value) = growing(20);
    let batch = json!({"threshold": 0.4, "direction": "rising", "histories": [
        {"id": "left aileron", "usage": usage, "value": value, "at": [-1, 38]}]});
    let rows = Folder::with("h.json", &batch.to_string()).run(&["h.json"]);
    let rows = String::from_utf8(rows.stdout).unwrap();
    assert_eq!(rows.lines().count(), 4, "{rows}");
    assert!(rows.lines().nth(2).unwrap().contains("no observation of this life"), "{rows}");
}

#[test]
fn evaluation_scores_the_forecasts_that_are_told() {
    let (t, h) = growing(40);
    let cuts = json!({"early": 30, "late": 70, "after": 99});
    let file =
        json!({"threshold": 0.4, "histories": [{"id": 0, "shape": "linear", "t": t, "h": h, "cuts": cuts, "eol": 95}]});
    let predicted = of_json(&file, &["--direction", "rising"]);
    let medians: Vec<f64> =
        predicted[0]["forecasts"].as_array().unwrap().iter().map(|f| f["quantiles"]["0.5"].as_f64().unwrap()).collect();
    // The file's object is sorted by label: after, early, late.
    let accuracy = |median: f64, truth: f64| (1.0 - (median - truth).abs() / truth).max(0.0);
    let (early, late) = (accuracy(medians[1], 65.0), accuracy(medians[2], 25.0));
    let near = |found: &Value, expected: f64| {
        assert!((found.as_f64().unwrap() - expected).abs() < 1e-3, "{found} {expected}");
    };
    let scores = of_json(&file, &["--direction", "rising", "--evaluate"]);
    let all = &scores["overall"];
    assert_eq!((scores["left_out"].as_u64(), scores["histories"].as_u64()), (Some(1), Some(1)));
    assert_eq!(all["forecasts"].as_u64(), Some(2));
    near(&all["mra"], 0.5 * (early + late));
    near(&all["cra"], (30.0 * early + 70.0 * late) / 100.0);
    let hits = f64::from(u8::from(early >= 0.8)) + f64::from(u8::from(late >= 0.8));
    near(&all["alpha_lambda"], 0.5 * hits);
    let parts = scores["by_fraction_of_life"].as_array().unwrap();
    assert_eq!(parts.iter().map(|part| part["from"].as_f64().unwrap()).collect::<Vec<_>>(), [0.2, 0.6]);
    near(&parts[0]["mra"], early);
    near(&parts[1]["mra"], late);
    for field in ["prognostic_horizon", "prognostic_horizon_lasting", "convergence", "alpha", "beta"] {
        assert!(scores[field].is_number(), "{field}: {scores}");
    }
    for field in ["alpha_lambda_beta", "ncrps", "coverage_50", "coverage_90", "width_50", "width_90"] {
        assert!(all[field].is_number(), "{field}: {all}");
    }
    assert!(scores["elapsed_s"]["median"].as_f64().unwrap() <= scores["elapsed_s"]["max"].as_f64().unwrap());
    let told = Folder::with("h.json", &file.to_string()).run(&["h.json", "--direction", "rising", "--evaluate"]);
    let told = String::from_utf8(told.stdout).unwrap();
    assert!(told.starts_with("2 forecasts of 1 histories, 1 left out") && told.contains("convergence"), "{told}");
}

#[test]
fn evaluation_of_a_life_that_is_taken_for_over_agrees_with_values_by_hand() {
    // The last 25 values are past the threshold: life is taken for over, though the end that is told is 2 hours away.
    let (usage, value) = growing(60);
    let file = json!({"threshold": 0.3, "direction": "rising", "usage": usage, "value": value, "at": 118, "eol": 120});
    let scores = of_json(&file, &["--evaluate"]);
    let all = &scores["overall"];
    // The remaining life is forecast as 0 with every quantile: its error is the whole truth, its score 2 hours of 120.
    assert_eq!((all["mra"].as_f64(), all["alpha_lambda"].as_f64()), (Some(0.0), Some(0.0)), "{scores}");
    assert_eq!((all["coverage_90"].as_f64(), all["width_90"].as_f64()), (Some(0.0), Some(0.0)), "{scores}");
    assert!((all["ncrps"].as_f64().unwrap() - 2.0 / 120.0).abs() < 1e-12, "{scores}");
    // The end is foreseen within a fifth of life, 2 hours ahead: 2 of 120. The error is 1/60 from 118/120 to the end.
    assert!((scores["prognostic_horizon"].as_f64().unwrap() - 2.0 / 120.0).abs() < 1e-12, "{scores}");
    let centroid = (1.0_f64 / 120.0).hypot(1.0 / 120.0);
    assert!((scores["convergence"].as_f64().unwrap() - centroid).abs() < 1e-12, "{scores}");
}

#[test]
fn a_history_without_its_end_cannot_be_scored() {
    let file = r#"{"threshold": 0.4, "histories": [{"t": [0, 1], "h": [0.1, 0.2], "at": [1]}]}"#;
    refused("h.json", file, &["--evaluate"], &["h.json", "/histories/0/eol", "missing", "end"]);
    let over = r#"{"threshold": 0.4, "t": [0, 1], "h": [0.1, 0.2], "at": [1], "eol": 1}"#;
    refused("h.json", over, &["--evaluate"], &["h.json", "no forecast within a life"]);
    let text = "usage,value\n0,0.1\n1,0.2\n";
    refused("h.csv", text, &["--threshold", "0.4", "--evaluate"], &["h.csv", "eol", "missing"]);
    refused("h.csv", text, &["--threshold", "0.4", "--evaluate", "--horizon", "9"], &["--horizon", "--evaluate"]);
}
