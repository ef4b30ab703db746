//! From an upload or a simulation to its result, over HTTP.

use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::header::ACCEPT;
use axum::http::{Request, StatusCode};
use serde_json::{Value, json};

use tokio::time::timeout;

use super::http_support::{Answer, PATIENCE, PAUSE, RECORDED, Service, still_csv};

fn simulation() -> Value {
    json!({"model": "monitoring", "command": "diagnostic", "faults": {"kgm": 0.2, "fdj_n": 600.0},
        "duration_s": 6.0, "sample_rate_hz": 1000.0})
}

async fn data_as(service: &Service, trace: &str, accept: &str) -> Answer {
    let request = Request::get(format!("/v1/traces/{trace}/data")).header(ACCEPT, accept);
    service.send(request.body(Body::empty()).unwrap()).await
}

#[tokio::test]
async fn recovers_the_faults_of_a_simulated_actuator_through_upload_job_and_history() {
    let service = Service::new().await;
    let queued = service.post_json("/v1/simulations", &simulation()).await.expect(StatusCode::ACCEPTED);
    assert_eq!(queued.header("location"), format!("/v1/jobs/{}", queued.text("/job/id")));
    service.work().await;
    let simulated = service.get(queued.header("location")).await.expect(StatusCode::OK);
    assert_eq!(simulated.text("/state"), "succeeded");
    let csv = data_as(&service, &simulated.text("/result/trace_id"), "text/csv").await.expect(StatusCode::OK);

    let actuator = service.registered("EHA-1").await;
    let path = format!("/v1/actuators/{actuator}/traces?{RECORDED}&seed=7&population=20&generations=4&method=pso");
    let accepted = service.post(&path, Some("text/csv"), csv.body).await.expect(StatusCode::ACCEPTED);
    assert_eq!(accepted.text("/job/state"), "queued");
    service.work().await;
    let job = service.get(accepted.header("location")).await.expect(StatusCode::OK);
    assert_eq!((job.text("/state"), job.value("/attempt")), ("succeeded".into(), json!(1)));
    assert_eq!((job.value("/result/seed"), job.value("/result/method")), (json!(7), json!("pso")));

    let history = service.get(&format!("/v1/actuators/{actuator}/health")).await.expect(StatusCode::OK);
    let row = history.value("/items/0");
    assert_eq!((&row["trace_id"], &row["job_id"]), (&accepted.value("/trace/id"), &accepted.value("/job/id")));
    assert_eq!((&row["recorded_at"], &row["usage"]), (&json!("2026-03-01T12:00:00Z"), &json!(100.5)));
    assert_eq!(row["verdict"], "conclusive");
    assert!((row["kgm"].as_f64().unwrap() - 0.2).abs() < 0.05, "{row:#}");
    assert!((row["fdj_n"].as_f64().unwrap() - 600.0).abs() < 100.0, "{row:#}");

    let life = service.get(&format!("/v1/actuators/{actuator}/remaining-life")).await.expect(StatusCode::OK);
    assert_eq!((life.text("/actuator_id"), life.value("/usage")), (actuator.clone(), json!(100.5)));
    let median = life.value("/forecast/quantiles/0.5");
    let fleet = service.get("/v1/fleet/health").await.expect(StatusCode::OK).value("/items/0");
    assert_eq!(fleet["remaining_life"]["quantiles"]["0.5"], median);
    assert_eq!(fleet["risk"], life.value("/risk"));
    assert_eq!(fleet["newest"]["kgm"], row["kgm"]);
}

#[tokio::test]
async fn a_trace_that_tells_nothing_succeeds_inconclusively_and_stands_in_the_history() {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    let path = format!("/v1/actuators/{actuator}/traces?{RECORDED}");
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let job = service.get(accepted.header("location")).await.expect(StatusCode::OK);
    assert_eq!(job.text("/state"), "succeeded");
    assert_eq!(job.text("/result/verdict"), "inconclusive");
    let history = service.get(&format!("/v1/actuators/{actuator}/health")).await.expect(StatusCode::OK);
    assert_eq!(history.value("/items/0/kgm"), Value::Null);
    assert_eq!(history.text("/items/0/verdict"), "inconclusive");
}

#[tokio::test]
async fn a_trace_record_tells_what_was_uploaded() {
    let service = Service::new().await;
    let path = service.upload_path().await.replace("usage", "columns=Cor:servovalve_current_ma&usage");
    let csv = still_csv().replace("servovalve_current_a", "Cor");
    let accepted = service.post(&path, Some("Text/CSV"), csv.clone()).await.expect(StatusCode::ACCEPTED);
    let record = service.get(&format!("/v1/traces/{}", accepted.text("/trace/id"))).await.expect(StatusCode::OK);
    assert_eq!(record.json(), accepted.value("/trace"));
    assert_eq!(record.text("/media_type"), "text/csv");
    assert_eq!(record.text("/columns"), "Cor:servovalve_current_ma");
    assert_eq!(record.value("/samples"), json!(20));
    assert_eq!(record.value("/size_bytes"), json!(csv.len()));
    assert_eq!(record.text("/recorded_at"), "2026-03-01T12:00:00Z");
}

#[tokio::test]
async fn accept_chooses_the_form_of_the_samples() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    let trace = accepted.text("/trace/id");
    let csv = data_as(&service, &trace, "text/csv").await.expect(StatusCode::OK);
    assert_eq!(csv.header("content-type"), "text/csv");
    assert!(csv.body.starts_with(b"time_s,position_command_m"), "{:?}", csv.body);
    let json = data_as(&service, &trace, "application/json, text/csv;q=0.5").await.expect(StatusCode::OK);
    assert_eq!(json.header("content-type"), "application/json");
    assert_eq!(json.value("/columns/time_s").as_array().unwrap().len(), 20);
    let refused = data_as(&service, &trace, "text/html").await.expect_problem(406, &[]);
    assert!(refused.text("/detail").contains("text/csv"));
}

#[tokio::test]
async fn samples_that_changed_since_they_were_kept_are_not_served() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    let trace = accepted.text("/trace/id");
    std::fs::write(service.trace_file(&trace), still_csv().replacen("0,0,0,0", "0,0,0,1", 1)).unwrap();
    data_as(&service, &trace, "text/csv").await.expect_problem(500, &[]);
}

#[tokio::test]
async fn a_simulation_without_a_command_is_told_so_once() {
    let mut body = simulation();
    body["command"] = json!("");
    let answer = Service::new().await.post_json("/v1/simulations", &body).await.expect_problem(422, &["/command"]);
    assert_eq!(answer.text("/errors/0/detail"), "found 0 characters, expected 1 to 10000");
    body["command"] = json!("dance");
    let answer = Service::new().await.post_json("/v1/simulations", &body).await.expect_problem(422, &["/command"]);
    assert!(answer.text("/errors/0/detail").starts_with("found \"dance\", expected "), "{}", answer.json());
}

#[tokio::test]
async fn every_field_of_a_simulation_out_of_range_is_told_at_once() {
    let body = json!({"model": "reference", "command": "dance", "faults": {"kgm": 1.5, "fdj_n": 100.0},
        "noise_power": -1.0, "duration_s": 0.0, "sample_rate_hz": 0.5});
    let service = Service::new().await;
    let answer = service.post_json("/v1/simulations", &body).await;
    let pointers: Vec<_> = answer.value("/errors").as_array().unwrap().iter().map(|e| e["pointer"].clone()).collect();
    for pointer in ["/command", "/faults/kgm", "/faults/fdj_n", "/noise_power", "/duration_s", "/sample_rate_hz"] {
        assert!(pointers.contains(&json!(pointer)), "{pointer} is missing in {pointers:?}");
    }
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    service.assert_nothing_is_stored().await;
}

/// The last value of a column of the trace that a simulation makes.
async fn simulated_end(service: &Service, changes: Value, column: &str) -> f64 {
    let mut body = json!({"model": "monitoring", "command": "ramp:0.05", "duration_s": 1.0, "sample_rate_hz": 100.0});
    body.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    let queued = service.post_json("/v1/simulations", &body).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let done = service.get(queued.header("location")).await.expect(StatusCode::OK);
    assert_eq!(done.text("/state"), "succeeded", "{}", done.json());
    let trace = done.text("/result/trace_id");
    let data = data_as(service, &trace, "application/json").await.expect(StatusCode::OK);
    let values = data.value(&format!("/columns/{column}"));
    values.as_array().unwrap().last().unwrap().as_f64().unwrap()
}

#[tokio::test]
async fn a_simulation_chooses_its_fluid_load_and_supply() {
    let service = Service::new().await;
    let pressure = async |changes: Value| simulated_end(&service, changes, "load_pressure_pa").await;
    let developed = pressure(json!({})).await;
    assert_eq!(pressure(json!({"fluid": "developed"})).await, developed);
    for fluid in ["linear", "evolved"] {
        assert_ne!(pressure(json!({"fluid": fluid})).await, developed, "{fluid}");
    }
    let loaded = pressure(json!({"external_load_n": 800.0})).await;
    assert!(((loaded - developed) / 1e6 - 1.0).abs() < 0.01, "800 N on 8 cm2 are 1 MPa: {loaded} {developed}");
    let current = async |changes: Value| simulated_end(&service, changes, "servovalve_current_a").await;
    assert!(current(json!({"supply_pressure_pa": 8e6})).await > current(json!({})).await, "section 5.2");
    let mut chirp = simulation();
    chirp["command"] = json!("chirp:0.05@0.5-10");
    service.post_json("/v1/simulations", &chirp).await.expect(StatusCode::ACCEPTED);
}

#[tokio::test]
async fn a_fluid_for_the_reference_model_and_too_much_load_or_supply_are_told_by_their_fields() {
    let body = json!({"model": "reference", "command": "diagnostic", "fluid": "linear", "external_load_n": 2e6,
        "supply_pressure_pa": 1e9, "duration_s": 1.0, "sample_rate_hz": 100.0});
    let pointers = ["/external_load_n", "/fluid", "/supply_pressure_pa"];
    let answer = Service::new().await.post_json("/v1/simulations", &body).await.expect_problem(422, &pointers);
    assert!(
        answer.text("/errors/2/detail").contains("found 1000000000, expected at most 41200000 Pa"),
        "{}",
        answer.json()
    );
}

#[tokio::test]
async fn a_simulation_cannot_read_the_services_files() {
    let mut body = simulation();
    body["command"] = json!("file:/etc/passwd");
    let answer = Service::new().await.post_json("/v1/simulations", &body).await.expect_problem(422, &["/command"]);
    assert!(answer.text("/detail").contains("command line only"));
}

#[tokio::test]
async fn unknown_fields_of_a_simulation_are_malformed() {
    let service = Service::new().await;
    let mut body = simulation();
    body["faults"]["fdj"] = json!(3.0);
    service.post_json("/v1/simulations", &body).await.expect_problem(400, &["/faults/fdj"]);
    let mut body = simulation();
    body["noise"] = json!(3.0);
    service.post_json("/v1/simulations", &body).await.expect_problem(400, &["/noise"]);
    body = simulation();
    body["seed"] = json!(-3);
    service.post_json("/v1/simulations", &body).await.expect_problem(400, &["/seed"]);
}

#[tokio::test]
async fn a_queued_job_is_cancelled_once_and_does_not_run() {
    let service = Service::new().await;
    let queued = service.post_json("/v1/simulations", &simulation()).await.expect(StatusCode::ACCEPTED);
    let cancelled = service.delete(queued.header("location")).await.expect(StatusCode::OK);
    assert_eq!(cancelled.text("/state"), "cancelled");
    service.delete(queued.header("location")).await.expect_problem(409, &[]);
    service.work().await;
    let job = service.get(queued.header("location")).await.expect(StatusCode::OK);
    assert_eq!((job.text("/state"), job.value("/attempt")), ("cancelled".into(), json!(0)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_running_job_shows_its_progress_and_ends_soon_after_it_is_cancelled() {
    let service = Service::new().await;
    let long = json!({"model": "reference", "command": "diagnostic", "duration_s": 600.0, "sample_rate_hz": 1.0});
    let queued = service.post_json("/v1/simulations", &long).await.expect(StatusCode::ACCEPTED);
    let location = queued.header("location");
    let watched = async {
        loop {
            let job = service.get(location).await.expect(StatusCode::OK);
            assert!(["queued", "running"].contains(&job.text("/state").as_str()), "{:#}", job.json());
            let progress = job.value("/progress").as_f64().unwrap();
            if progress > 0.0 {
                assert!(progress < 1.0, "{progress}");
                break;
            }
            tokio::time::sleep(PAUSE).await;
        }
        let cancelled = service.delete(location).await.expect(StatusCode::OK);
        assert_eq!(cancelled.text("/state"), "cancelled");
        Instant::now()
    };
    let ((), cancelled_at) = timeout(PATIENCE, async { tokio::join!(service.work(), watched) }).await.unwrap();
    assert!(cancelled_at.elapsed() < Duration::from_secs(10), "{:?}", cancelled_at.elapsed());
    let job = service.get(location).await.expect(StatusCode::OK);
    assert_eq!((job.text("/state"), job.value("/result")), ("cancelled".into(), Value::Null));
}

#[tokio::test]
async fn a_job_that_succeeded_cannot_be_cancelled() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let answer = service.delete(accepted.header("location")).await.expect_problem(409, &[]);
    assert!(answer.text("/detail").contains("succeeded"));
}

#[tokio::test]
async fn jobs_are_listed_by_state_newest_first() {
    let service = Service::new().await;
    let mut locations = Vec::new();
    for _ in 0..3 {
        let queued = service.post_json("/v1/simulations", &simulation()).await.expect(StatusCode::ACCEPTED);
        locations.push(queued.header("location").to_owned());
    }
    service.delete(&locations[1]).await.expect(StatusCode::OK);
    let queued = service.get("/v1/jobs?state=queued&limit=1").await.expect(StatusCode::OK);
    assert!(locations[2].ends_with(&queued.text("/items/0/id")));
    let rest = format!("/v1/jobs?state=queued&limit=1&cursor={}", queued.text("/next_cursor"));
    let rest = service.get(&rest).await.expect(StatusCode::OK);
    assert!(locations[0].ends_with(&rest.text("/items/0/id")));
    assert_eq!(rest.value("/next_cursor"), Value::Null);
    service.get("/v1/jobs?state=done").await.expect_problem(400, &["?state"]);
}

#[tokio::test]
async fn what_is_no_job_and_no_trace_is_not_found() {
    let service = Service::new().await;
    for id in ["7", "01890a5d-ac96-774b-bcce-b302099a8057", "01890A5D-AC96-774B-BCCE-B302099A8057"] {
        service.get(&format!("/v1/jobs/{id}")).await.expect_problem(404, &[]);
        service.delete(&format!("/v1/jobs/{id}")).await.expect_problem(404, &[]);
        service.get(&format!("/v1/traces/{id}")).await.expect_problem(404, &[]);
        service.get(&format!("/v1/traces/{id}/data")).await.expect_problem(404, &[]);
    }
}
