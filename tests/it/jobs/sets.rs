//! Which parameters a job computes with.

use elevon::estimation::Settings;
use elevon::estimation::request::Objective;
use elevon::jobs::kind::JobSpec;
use elevon::jobs::run::Models;
use elevon::jobs::sets;
use elevon::models::parameters::ParameterSet;
use elevon::store::records::{Actuator, Job, JobState, ParameterSetRecord};
use serde_json::{Value, json};

use super::bench::{Bench, csv, driven, simulation};
use crate::store_contract::samples::actuator;

/// A set of this name with a jack of this area.
fn set(name: &str, area_m2: f64) -> ParameterSet {
    let mut parameters = ParameterSet::reference().to_json();
    parameters["jack"]["area_m2"] = json!(area_m2);
    ParameterSet::from_json(name, &parameters).unwrap()
}

/// An actuator that is pinned to a version.
async fn pinned(bench: &Bench, serial_number: &str, set: &ParameterSetRecord) -> Actuator {
    let mut actuator = actuator(serial_number);
    (actuator.parameter_set, actuator.parameter_set_hash) = (set.name.clone(), set.hash.clone());
    bench.records.insert_actuator(&actuator).await.unwrap();
    actuator
}

async fn estimated(bench: &Bench, actuator: &Actuator) -> Job {
    // The whole trace would tell that a jack is another one: its spool stands elsewhere.
    let settings = Settings { objective: Objective::Features, ..Settings::default() };
    let job = bench.upload_with(actuator.id, 10, csv(), settings).await.1;
    assert_eq!(bench.run_all().await, 1);
    bench.job(job.id).await
}

#[tokio::test]
async fn an_actuator_s_traces_are_estimated_with_the_version_that_it_is_pinned_to() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let (older, newer) = (sets::record(&set("mine", 8.8e-4)), sets::record(&set("mine", 8.4e-4)));
    let mut frictions_n = Vec::new();
    for (serial_number, version) in [("A", &older), ("B", &newer)] {
        bench.records.insert_parameter_set(version).await.unwrap();
        pinned(&bench, serial_number, version).await;
    }
    for actuator in bench.records.actuators(&crate::store_contract::samples::all()).await.unwrap().items {
        let result = estimated(&bench, &actuator).await.result.unwrap();
        assert_eq!(result["parameter_set_hash"], actuator.parameter_set_hash, "{result}");
        frictions_n.push(result["fdj_n"].as_f64().unwrap_or_else(|| panic!("{result}")));
    }
    // As much pressure on more area is more friction.
    assert!((frictions_n[1] / frictions_n[0] - 8.4 / 8.8).abs() < 0.01, "{frictions_n:?}");
}

#[tokio::test]
async fn an_actuator_of_the_built_in_set_is_estimated_with_the_program_s_own() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let mut older = sets::record(&ParameterSet::reference());
    older.hash = "0".repeat(64);
    let actuator = pinned(&bench, "A", &older).await;
    let result = estimated(&bench, &actuator).await.result.unwrap();
    assert_eq!(result["parameter_set_hash"], ParameterSet::reference().hash());
}

#[tokio::test]
async fn a_set_that_this_version_cannot_use_fails_its_job_with_everything_that_is_wrong_and_the_next_job_runs() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let good = sets::record(&set("mine", 8.8e-4));
    let with = |hash: char, change: fn(&mut Value)| {
        let mut kept = ParameterSetRecord { hash: hash.to_string().repeat(64), ..sets::record(&set("mine", 8.8e-4)) };
        change(&mut kept.parameters);
        kept
    };
    let other = with('a', |values| {
        values["jack"].as_object_mut().unwrap().remove("mass_kg").unwrap();
        values["jack"]["colour"] = json!("red");
    });
    let cases = [
        (other, vec!["elevon", "jack.mass_kg: missing, expected 0.01 to 10000 kg", "jack.colour: found an unknown"]),
        (with('b', |values| *values = json!([7])), vec!["mine@bbbb", "not valid"]),
        (with('c', |_| ()), vec!["mine@cccc", "its hash is", &good.hash]),
    ];
    for (serial_number, (kept, says)) in ["A", "B", "C"].into_iter().zip(cases) {
        bench.records.insert_parameter_set(&kept).await.unwrap();
        let actuator = pinned(&bench, serial_number, &kept).await;
        let failed = estimated(&bench, &actuator).await;
        let error = failed.error.unwrap_or_default();
        assert_eq!(failed.state, JobState::Failed, "{error}");
        assert!(says.iter().all(|part| error.contains(part)), "{error}");
    }
    bench.records.insert_parameter_set(&good).await.unwrap();
    let actuator = pinned(&bench, "D", &good).await;
    assert_eq!(estimated(&bench, &actuator).await.state, JobState::Succeeded);
}

#[tokio::test]
async fn a_simulation_runs_with_the_set_that_it_names_and_says_which() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let mine = set("mine", 8.8e-4);
    bench.records.insert_parameter_set(&sets::record(&mine)).await.unwrap();
    let mut traces = Vec::new();
    for (name, expected) in [(None, ParameterSet::reference()), (Some(sets::named(&mine)), mine.clone())] {
        let JobSpec::Simulation(mut spec) = simulation() else { unreachable!() };
        spec.parameter_set = name;
        let job = bench.jobs.enqueue(JobSpec::Simulation(spec)).await.unwrap();
        assert_eq!(bench.run_all().await, 1);
        let result = bench.job(job.id).await.result.unwrap();
        assert_eq!(
            (&result["parameter_set"], &result["parameter_set_hash"]),
            (&json!(expected.name()), &json!(expected.hash()))
        );
        traces.push(bench.traces.get(result["trace_id"].as_str().unwrap().parse().unwrap()).await.unwrap().unwrap());
    }
    assert_ne!(traces[0], traces[1]);
}
