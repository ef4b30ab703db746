//! Actuators and their maintenance over HTTP.

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{Answer, Service};

fn actuator() -> Value {
    json!({"serial_number": "EHA-1", "tail_number": "I-ELVN", "location": "left aileron"})
}

/// The answer to a registration that differs from a good one in one field.
async fn registered_with(field: &str, value: Value) -> Answer {
    let mut body = actuator();
    body[field] = value;
    Service::new().await.post_json("/v1/actuators", &body).await
}

#[tokio::test]
async fn an_actuator_is_registered_with_defaults_and_found_at_its_location() {
    let service = Service::new().await;
    let answer = service.post_json("/v1/actuators", &actuator()).await.expect(StatusCode::CREATED);
    assert_eq!(answer.value("/thresholds"), json!({"kgm": 0.4, "fdj_n": 1000.0}));
    assert_eq!(answer.text("/usage_unit"), "flight_hours");
    assert_eq!(answer.text("/parameter_set"), "reference");
    let found = service.get(answer.header("location")).await.expect(StatusCode::OK);
    assert_eq!(found.json(), answer.json());
}

#[tokio::test]
async fn white_space_around_texts_does_not_count_and_one_threshold_may_be_given_alone() {
    let body = json!({"serial_number": " EHA-1\n", "tail_number": "I-ELVN", "location": "x",
        "thresholds": {"fdj_n": 800.0}, "usage_unit": "flight_cycles", "parameter_set": "reference"});
    let answer = Service::new().await.post_json("/v1/actuators", &body).await.expect(StatusCode::CREATED);
    assert_eq!(answer.text("/serial_number"), "EHA-1");
    assert_eq!(answer.value("/thresholds"), json!({"kgm": 0.4, "fdj_n": 800.0}));
    assert_eq!(answer.text("/usage_unit"), "flight_cycles");
}

#[tokio::test]
async fn a_serial_number_that_is_taken_is_a_conflict() {
    let service = Service::new().await;
    service.registered("EHA-1").await;
    service.post_json("/v1/actuators", &actuator()).await.expect_problem(409, &["/serial_number"]);
}

#[tokio::test]
async fn an_unknown_field_is_refused_by_its_pointer() {
    registered_with("serial", json!("x")).await.expect_problem(400, &["/serial"]);
    registered_with("thresholds", json!({"KGM": 0.3})).await.expect_problem(400, &["/thresholds/KGM"]);
}

#[tokio::test]
async fn a_wrong_type_is_refused_by_its_pointer() {
    registered_with("serial_number", json!(7)).await.expect_problem(400, &["/serial_number"]);
    registered_with("thresholds", json!({"kgm": "0.3"})).await.expect_problem(400, &["/thresholds/kgm"]);
    registered_with("usage_unit", json!("miles")).await.expect_problem(400, &["/usage_unit"]);
}

#[tokio::test]
async fn an_array_is_no_record() {
    let service = Service::new().await;
    let record = json!(["EHA-1", "I-ELVN", "left aileron", null, null, null]);
    let answer = service.post_json("/v1/actuators", &record).await.expect_problem(400, &[""]);
    assert!(answer.text("/detail").contains("found an array"));
    registered_with("thresholds", json!([0.3, 500])).await.expect_problem(400, &["/thresholds"]);
}

#[tokio::test]
async fn a_missing_field_is_named() {
    let body = json!({"serial_number": "EHA-1", "tail_number": "I-ELVN"});
    let answer = Service::new().await.post_json("/v1/actuators", &body).await.expect_problem(400, &[""]);
    assert!(answer.text("/detail").contains("location"));
}

#[tokio::test]
async fn every_value_out_of_range_is_told_at_once() {
    let body = json!({"serial_number": " ", "tail_number": "a\u{7}b", "location": "x".repeat(201),
        "parameter_set": "mine", "thresholds": {"kgm": 0.0, "fdj_n": 2001.0}});
    let pointers =
        ["/serial_number", "/tail_number", "/location", "/parameter_set", "/thresholds/kgm", "/thresholds/fdj_n"];
    Service::new().await.post_json("/v1/actuators", &body).await.expect_problem(422, &pointers);
}

#[tokio::test]
async fn a_threshold_that_leaves_a_healthy_actuator_no_room_is_refused() {
    for (name, value) in [("kgm", 1e-320), ("kgm", 0.009), ("kgm", 1.1), ("fdj_n", 200.0000001), ("fdj_n", 2000.1)] {
        let refused = registered_with("thresholds", json!({name: value})).await;
        refused.expect_problem(422, &[&format!("/thresholds/{name}")]);
    }
    for thresholds in [json!({"kgm": 0.01, "fdj_n": 210.0}), json!({"kgm": 1.0, "fdj_n": 2000.0})] {
        registered_with("thresholds", thresholds).await.expect(StatusCode::CREATED);
    }
}

#[tokio::test]
async fn broken_json_and_json_of_another_shape_are_malformed() {
    let service = Service::new().await;
    for body in ["{", "[]", "7", "{} {}", "\u{feff}{}", r#"{"serial_number": "a", "serial_number": "b"}"#] {
        let answer = service.post("/v1/actuators", Some("application/json"), body).await;
        assert_eq!(answer.status, StatusCode::BAD_REQUEST, "{body}");
        assert_eq!(answer.header("content-type"), "application/problem+json");
    }
}

#[tokio::test]
async fn a_list_is_read_page_by_page() {
    let service = Service::new().await;
    for number in 0..5 {
        service.registered(&format!("EHA-{number}")).await;
    }
    let mut seen = Vec::new();
    let mut path = "/v1/actuators?limit=2".to_owned();
    for pages_left in [2, 1, 0] {
        let page = service.get(&path).await.expect(StatusCode::OK).json();
        seen.extend(page["items"].as_array().unwrap().iter().map(|item| item["serial_number"].clone()));
        let Some(cursor) = page["next_cursor"].as_str() else {
            assert_eq!(pages_left, 0);
            break;
        };
        path = format!("/v1/actuators?limit=2&cursor={cursor}");
    }
    assert_eq!(json!(seen), json!(["EHA-0", "EHA-1", "EHA-2", "EHA-3", "EHA-4"]));
}

#[tokio::test]
async fn what_is_no_actuator_is_not_found() {
    let service = Service::new().await;
    for id in ["7", "01890a5d-ac96-774b-bcce-b302099a8057", "%FF", "a%2Fb"] {
        for path in ["", "/health", "/remaining-life", "/maintenance"] {
            let answer = service.get(&format!("/v1/actuators/{id}{path}")).await;
            answer.expect_problem(404, &[]);
        }
    }
}

#[tokio::test]
async fn maintenance_is_reported_and_listed_by_its_time() {
    let service = Service::new().await;
    let path = format!("/v1/actuators/{}/maintenance", service.registered("EHA-1").await);
    for (kind, at) in [("overhauled", "2026-03-02T12:00:00+02:00"), ("inspected", "2026-03-01T12:00:00Z")] {
        let body = json!({"kind": kind, "at": at, "usage": 10.0, "note": "line 1\nline 2"});
        service.post_json(&path, &body).await.expect(StatusCode::CREATED);
    }
    let list = service.get(&path).await.expect(StatusCode::OK);
    assert_eq!(list.text("/items/0/kind"), "inspected");
    assert_eq!(list.text("/items/1/at"), "2026-03-02T10:00:00Z");
    assert_eq!(list.value("/next_cursor"), Value::Null);
}

#[tokio::test]
async fn maintenance_that_cannot_be_read_is_malformed_and_out_of_range_is_invalid() {
    let service = Service::new().await;
    let path = format!("/v1/actuators/{}/maintenance", service.registered("EHA-1").await);
    let event = |kind: &str, at: &str, usage: f64| json!({"kind": kind, "at": at, "usage": usage, "note": ""});
    let malformed = event("replaced", "2026-03-01T12:00:00", 1.0);
    service.post_json(&path, &malformed).await.expect_problem(400, &["/at"]);
    let unknown = event("painted", "2026-03-01T12:00:00Z", 1.0);
    service.post_json(&path, &unknown).await.expect_problem(400, &["/kind"]);
    let endless = event("replaced", "2026-03-01T12:00:00Z", 1.1e7);
    service.post_json(&path, &endless).await.expect_problem(422, &["/usage"]);
    let mut invalid = event("replaced", "2026-03-01T12:00:00Z", -1.0);
    invalid["note"] = json!("x".repeat(2001));
    service.post_json(&path, &invalid).await.expect_problem(422, &["/usage", "/note"]);
    assert_eq!(service.get(&path).await.value("/items"), json!([]));
}
