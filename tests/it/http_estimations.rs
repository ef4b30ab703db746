//! Estimations of traces that are kept, and what an upload asks of its estimation, over HTTP.

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{Answer, RECORDED, Service, still_csv};

/// Uploads a trace that says nothing to a new actuator, and estimates it: the actuator's id and the trace's.
async fn uploaded(service: &Service) -> (String, String) {
    let actuator = service.registered("EHA-1").await;
    let path = format!("/v1/actuators/{actuator}/traces?{RECORDED}");
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    (actuator, accepted.text("/trace/id"))
}

/// Simulates an actuator's answer to the diagnostic command: the trace's id.
async fn simulated(service: &Service) -> String {
    let body = json!({"model": "monitoring", "command": "diagnostic", "faults": {"kgm": 0.2, "fdj_n": 600.0},
        "duration_s": 6.0, "sample_rate_hz": 1000.0});
    let queued = service.post_json("/v1/simulations", &body).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    service.get(queued.header("location")).await.expect(StatusCode::OK).text("/result/trace_id")
}

/// The body of an estimation with other fields beside its trace.
fn asking(trace: &str, fields: Value) -> Value {
    let mut body = json!({"trace_id": trace});
    body.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    body
}

async fn estimate(service: &Service, trace: &str, fields: Value) -> Answer {
    service.post_json("/v1/estimations", &asking(trace, fields)).await
}

/// What the newest job was asked to do, as the store keeps it.
async fn newest_spec(service: &Service) -> Value {
    let database = service.database().await;
    let spec: String =
        sqlx::query_scalar("SELECT spec FROM jobs ORDER BY id DESC LIMIT 1").fetch_one(&database).await.unwrap();
    serde_json::from_str(&spec).unwrap()
}

#[tokio::test]
async fn recovers_the_faults_of_a_trace_that_is_kept_with_the_search_that_is_asked_for() {
    let service = Service::new().await;
    let trace = simulated(&service).await;
    let fields = json!({"method": "pso", "population": 20, "generations": 4, "seed": 7, "objective": "features"});
    let queued = estimate(&service, &trace, fields).await.expect(StatusCode::ACCEPTED);
    assert_eq!((queued.text("/job/kind"), queued.text("/job/state")), ("estimation".into(), "queued".into()));
    assert_eq!(queued.header("location"), format!("/v1/jobs/{}", queued.text("/job/id")));
    service.work().await;
    let job = service.get(queued.header("location")).await.expect(StatusCode::OK);
    assert_eq!((job.text("/state"), job.text("/result/trace_id")), ("succeeded".into(), trace));
    assert_eq!((job.value("/result/seed"), job.value("/result/method")), (json!(7), json!("pso")));
    assert!((job.value("/result/kgm").as_f64().unwrap() - 0.2).abs() < 0.05, "{:#}", job.json());
    assert!((job.value("/result/fdj_n").as_f64().unwrap() - 600.0).abs() < 100.0, "{:#}", job.json());
}

#[tokio::test]
async fn the_history_shows_the_estimate_that_was_asked_for_last() {
    let service = Service::new().await;
    let (actuator, trace) = uploaded(&service).await;
    let path = format!("/v1/actuators/{actuator}/health");
    let first = service.get(&path).await.expect(StatusCode::OK);
    let queued = estimate(&service, &trace, json!({"seed": 3})).await.expect(StatusCode::ACCEPTED);
    assert_eq!(service.get(&path).await.json(), first.json(), "an estimate that is not made yet changes nothing");
    service.work().await;
    let history = service.get(&path).await.expect(StatusCode::OK);
    assert_eq!(history.value("/items").as_array().unwrap().len(), 1);
    assert_eq!(history.text("/items/0/trace_id"), trace);
    assert_eq!(history.text("/items/0/job_id"), queued.text("/job/id"));
    assert_ne!(history.json(), first.json());
}

#[tokio::test]
async fn an_excluded_trace_can_be_estimated_and_stays_out_of_the_history() {
    let service = Service::new().await;
    let (actuator, trace) = uploaded(&service).await;
    let path = format!("/v1/traces/{trace}");
    let body = json!({"excluded": true, "reason": " sensor unplugged "});
    let excluded = service.patch_json(&path, &body).await.expect(StatusCode::OK);
    assert_eq!((excluded.value("/excluded"), excluded.text("/reason")), (json!(true), "sensor unplugged".into()));
    assert_eq!(service.get(&path).await.json(), excluded.json());
    let queued = estimate(&service, &trace, json!({})).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    assert_eq!(service.get(queued.header("location")).await.text("/state"), "succeeded");
    let health = format!("/v1/actuators/{actuator}/health");
    assert_eq!(service.get(&health).await.value("/items"), json!([]));
    let back = service.patch_json(&path, &json!({"excluded": false, "reason": "mended"})).await.expect(StatusCode::OK);
    assert_eq!((back.value("/excluded"), back.text("/reason")), (json!(false), String::new()));
    assert_eq!(service.get(&health).await.text("/items/0/job_id"), queued.text("/job/id"));
}

#[tokio::test]
async fn an_exclusion_that_cannot_be_is_refused() {
    let service = Service::new().await;
    let (_, trace) = uploaded(&service).await;
    let path = format!("/v1/traces/{trace}");
    for (body, status, pointer) in [
        (json!({"reason": "bad"}), 400, ""),
        (json!({"excluded": "yes"}), 400, "/excluded"),
        (json!({"excluded": true, "why": "bad"}), 400, "/why"),
        (json!({"excluded": true, "reason": "a\u{7}"}), 422, "/reason"),
        (json!({"excluded": true, "reason": "a".repeat(2001)}), 422, "/reason"),
    ] {
        service.patch_json(&path, &body).await.expect_problem(status, &[pointer]);
    }
    service.patch_json("/v1/traces/7", &json!({"excluded": true})).await.expect_problem(404, &[]);
    assert_eq!(service.get(&path).await.value("/excluded"), json!(false));
}

#[tokio::test]
async fn an_estimation_is_asked_for_faults_by_a_text_or_an_array() {
    let service = Service::new().await;
    let (_, trace) = uploaded(&service).await;
    for faults in [json!("clearance, kgm,fdj"), json!(["fdj", "clearance", "kgm"])] {
        let fields = json!({"faults": faults, "objective": "trace"});
        estimate(&service, &trace, fields).await.expect(StatusCode::ACCEPTED);
        let settings = newest_spec(&service).await["settings"].clone();
        assert_eq!((&settings["faults"], &settings["objective"]), (&json!("kgm,fdj,clearance"), &json!("trace")));
    }
    estimate(&service, &trace, json!({"faults": null})).await.expect(StatusCode::ACCEPTED);
    let settings = newest_spec(&service).await["settings"].clone();
    assert_eq!((&settings["faults"], &settings["objective"]), (&json!("kgm,fdj"), &json!("auto")));
    assert_eq!(
        (&settings["population"], &settings["generations"], &settings["seed"]),
        (&json!(40), &json!(10), &json!(1))
    );
}

#[tokio::test]
async fn a_field_that_cannot_be_read_is_told_with_what_was_found_and_expected() {
    let service = Service::new().await;
    let (_, trace) = uploaded(&service).await;
    let cases = [
        (json!({"faults": "kgm,rust"}), "/faults", "found \"rust\", expected some of kgm, fdj"),
        (json!({"faults": ["kgm", "rust"]}), "/faults/1", "`rust`, expected one of `kgm`"),
        (json!({"faults": ["kgm", "kgm"]}), "/faults", "found \"kgm\" twice, expected each fault once"),
        (json!({"faults": []}), "/faults", "found an empty array, expected some of kgm"),
        (json!({"faults": 7}), "/faults", "integer `7`, expected names of faults"),
        (json!({"objective": "best"}), "/objective", "`best`, expected one of `auto`"),
        (json!({"method": "luck"}), "/method", "`luck`, expected one of `ga`"),
        (json!({"ga": "selection=luck"}), "/ga", "found \"selection=luck\", expected "),
        (json!({"seed": -1}), "/seed", "`-1`, expected an integer, at least 0"),
        (json!({"trace": "x"}), "/trace", "unknown field `trace`, expected one of `trace_id`"),
    ];
    for (fields, pointer, told) in cases {
        let answer = estimate(&service, &trace, fields.clone()).await.expect_problem(400, &[pointer]);
        assert!(answer.text("/errors/0/detail").contains(told), "{fields}: {:#}", answer.json());
    }
    service.post_json("/v1/estimations", &json!({})).await.expect_problem(400, &[""]);
    service.post_json("/v1/estimations", &json!([trace])).await.expect_problem(400, &[""]);
    assert_eq!(service.get("/v1/jobs").await.value("/items").as_array().unwrap().len(), 1, "only the upload's");
}

#[tokio::test]
async fn every_field_of_an_estimation_out_of_range_and_a_trace_that_is_not_kept_are_told_at_once() {
    let service = Service::new().await;
    for id in ["7", "01890a5d-ac96-774b-bcce-b302099a8057"] {
        let fields = json!({"population": 3, "generations": 1001});
        let pointers = ["/trace_id", "/population", "/generations"];
        let answer = estimate(&service, id, fields).await.expect_problem(422, &pointers);
        let details = [0, 1, 2].map(|i| answer.text(&format!("/errors/{i}/detail")));
        assert_eq!(details[0], format!("found {id:?}, expected the id of a trace that the service keeps"));
        assert_eq!(details[1], "found 3, expected an integer, 4 to 1000");
        assert_eq!(details[2], "found 1001, expected an integer, 0 to 1000");
    }
    service.assert_nothing_is_stored().await;
}

#[tokio::test]
async fn a_full_queue_takes_no_estimation() {
    let service = Service::with(|config| config.jobs.queue_limit = 1).await;
    let (_, trace) = uploaded(&service).await;
    estimate(&service, &trace, json!({})).await.expect(StatusCode::ACCEPTED);
    let answer = estimate(&service, &trace, json!({})).await.expect_problem(503, &[]);
    assert!(answer.headers.contains_key("retry-after"));
}

#[tokio::test]
async fn an_upload_says_what_its_estimation_minimises_and_which_faults_it_looks_for() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let told = format!("{path}&objective=features&faults=fdj,kgm,current_offset");
    service.post(&told, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    let settings = newest_spec(&service).await["settings"].clone();
    assert_eq!((&settings["objective"], &settings["faults"]), (&json!("features"), &json!("kgm,fdj,current_offset")));
    let wrong = format!("{path}&objective=best&faults=kgm,rust");
    let answer = service.post(&wrong, Some("text/csv"), still_csv()).await;
    let answer = answer.expect_problem(400, &["?objective", "?faults"]);
    assert_eq!(answer.text("/errors/0/detail"), "found \"best\", expected one of auto, features, trace");
    assert!(answer.text("/errors/1/detail").starts_with("found \"rust\", expected some of kgm, fdj, clearance"));
}
