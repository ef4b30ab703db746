//! Histories, forecasts and the fleet over HTTP.

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{Service, still_csv};

/// Uploads one trace of an actuator, recorded on a day of March 2026, and estimates it.
async fn recorded(service: &Service, actuator: &str, day: u32) {
    let path = format!("/v1/actuators/{actuator}/traces?recorded_at=2026-03-{day:02}T12:00:00Z&usage={day}");
    service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
}

fn usages(list: &Value) -> Vec<f64> {
    list["items"].as_array().unwrap().iter().map(|item| item["usage"].as_f64().unwrap()).collect()
}

#[tokio::test]
async fn a_history_is_sorted_by_time_of_recording_and_cut_by_from_and_to() {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    for day in [3, 1, 4, 2] {
        recorded(&service, &actuator, day).await;
    }
    let path = format!("/v1/actuators/{actuator}/health");
    assert_eq!(usages(&service.get(&path).await.json()), [1.0, 2.0, 3.0, 4.0]);
    let span = format!("{path}?from=2026-03-02T12:00:00Z&to=2026-03-04T14:00:00%2B02:00");
    assert_eq!(usages(&service.get(&span).await.json()), [2.0, 3.0]);
    let first = service.get(&format!("{path}?limit=3")).await.json();
    let rest = service.get(&format!("{path}?limit=3&cursor={}", first["next_cursor"].as_str().unwrap())).await.json();
    assert_eq!((usages(&first), usages(&rest)), (vec![1.0, 2.0, 3.0], vec![4.0]));
}

#[tokio::test]
async fn a_row_of_the_history_has_exactly_the_promised_fields() {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    recorded(&service, &actuator, 1).await;
    let row = service.get(&format!("/v1/actuators/{actuator}/health")).await.value("/items/0");
    let names: Vec<_> = row.as_object().unwrap().keys().collect();
    let promised = [
        "faults",
        "fdj_n",
        "fdj_n_growth",
        "fdj_n_growth_std",
        "fdj_n_std",
        "job_id",
        "kgm",
        "kgm_growth",
        "kgm_growth_std",
        "kgm_std",
        "recorded_at",
        "trace_id",
        "usage",
        "verdict",
    ];
    assert_eq!(names, promised);
    assert_eq!(row["faults"], json!({}));
}

#[tokio::test]
async fn a_row_of_the_history_shows_the_other_faults_as_its_estimate_does() {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    recorded(&service, &actuator, 1).await;
    let faults = json!({"clearance_m": 2.1e-6, "clearance_m_std": 1e-7, "clogging": null, "clogging_std": null});
    let update = sqlx::query("UPDATE health SET faults = ?1").bind(faults.to_string());
    update.execute(&service.database().await).await.unwrap();
    assert_eq!(service.get(&format!("/v1/actuators/{actuator}/health")).await.value("/items/0/faults"), faults);
}

#[tokio::test]
async fn a_span_or_a_page_that_is_none_is_refused_by_its_name() {
    let service = Service::new().await;
    let path = format!("/v1/actuators/{}/health", service.registered("EHA-1").await);
    let cases = [
        ("from=yesterday", 400, "?from"),
        ("to=2026-03-01", 400, "?to"),
        ("from=2026-03-02T00:00:00Z&to=2026-03-01T00:00:00Z", 422, "?to"),
        ("limit=0", 422, "?limit"),
        ("limit=501", 422, "?limit"),
        ("limit=all", 400, "?limit"),
        ("cursor=x", 400, "?cursor"),
        ("page=2", 400, "?page"),
    ];
    for (query, status, pointer) in cases {
        service.get(&format!("{path}?{query}")).await.expect_problem(status, &[pointer]);
    }
}

#[tokio::test]
async fn a_new_actuator_has_no_forecast_and_is_told_why() {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    let answer = service.get(&format!("/v1/actuators/{actuator}/remaining-life")).await.expect(StatusCode::OK);
    assert_eq!(answer.value("/forecast"), Value::Null);
    assert!(!answer.value("/reasons").as_array().unwrap().is_empty());
}

#[tokio::test]
async fn the_fleet_has_a_row_for_every_actuator_and_its_ranks_go_on_from_page_to_page() {
    let service = Service::new().await;
    let mut actuators = Vec::new();
    for number in 0..3 {
        actuators.push(service.registered(&format!("EHA-{number}")).await);
    }
    recorded(&service, &actuators[1], 1).await;
    let first = service.get("/v1/fleet/health?sort=risk&limit=2").await.expect(StatusCode::OK).json();
    let rest = format!("/v1/fleet/health?limit=2&cursor={}", first["next_cursor"].as_str().unwrap());
    let rest = service.get(&rest).await.expect(StatusCode::OK).json();
    let mut rows = first["items"].as_array().unwrap().clone();
    rows.extend(rest["items"].as_array().unwrap().iter().cloned());
    assert_eq!(rows.iter().map(|row| row["risk_rank"].as_u64().unwrap()).collect::<Vec<_>>(), [1, 2, 3]);
    let row = rows.iter().find(|row| row["actuator_id"] == json!(actuators[1])).unwrap();
    assert_eq!((&row["newest"]["usage"], &row["newest"]["verdict"]), (&json!(1.0), &json!("inconclusive")));
    assert_eq!((&row["risk"], &row["remaining_life"]), (&Value::Null, &Value::Null));
    assert!(rows.iter().all(|row| !row["reasons"].as_array().unwrap().is_empty()), "{rows:#?}");
}

#[tokio::test]
async fn the_fleet_of_one_aircraft_is_its_own() {
    let service = Service::new().await;
    service.registered("EHA-1").await;
    let other = json!({"serial_number": "EHA-2", "tail_number": "I-OTHR", "location": "left aileron"});
    service.post_json("/v1/actuators", &other).await.expect(StatusCode::CREATED);
    let fleet = service.get("/v1/fleet/health?tail_number=I-OTHR").await.expect(StatusCode::OK);
    assert_eq!(fleet.value("/items").as_array().unwrap().len(), 1);
    assert_eq!(fleet.text("/items/0/serial_number"), "EHA-2");
}

#[tokio::test]
async fn the_fleet_has_one_order_and_its_own_cursors() {
    let service = Service::new().await;
    service.get("/v1/fleet/health?sort=name").await.expect_problem(400, &["?sort"]);
    for cursor in ["x", "2_x", "1_x", "99999999999_x", ""] {
        service.get(&format!("/v1/fleet/health?cursor={cursor}")).await.expect_problem(400, &["?cursor"]);
    }
}
