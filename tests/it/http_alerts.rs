//! Alerts over HTTP, from the estimate that raises one to the maintenance that clears it.

use std::time::Instant;

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{PATIENCE, PAUSE, Service, still_csv};

/// An actuator whose KGM was estimated once a day of March 2026 with these values. The traces say nothing; what was estimated
/// from them is written beside the service.
pub async fn worn(service: &Service, serial_number: &str, kgm: &[f64]) -> String {
    let actuator = service.registered(serial_number).await;
    estimated(service, &actuator, 1, kgm).await;
    actuator
}

/// Estimates of KGM on the days from `day` on, and the forecast that follows.
pub async fn estimated(service: &Service, actuator: &str, day: usize, kgm: &[f64]) {
    let mut traces = Vec::new();
    for (day, _) in (day..).zip(kgm) {
        let usage = 100 * day;
        let path = format!("/v1/actuators/{actuator}/traces?recorded_at=2026-03-{day:02}T12:00:00Z&usage={usage}");
        let answer = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
        traces.push(answer.text("/trace/id"));
    }
    service.work().await;
    let database = service.database().await;
    for (trace, kgm) in traces.iter().zip(kgm) {
        let query =
            sqlx::query("UPDATE health SET kgm = ?1, kgm_std = 0.01, verdict = 'conclusive' WHERE trace_id = ?2");
        query.bind(kgm).bind(trace).execute(&database).await.unwrap();
    }
    let query = sqlx::query("UPDATE actuators SET revision = revision + 1 WHERE id = ?1").bind(actuator);
    query.execute(&database).await.unwrap();
    service.get(&format!("/v1/actuators/{actuator}/remaining-life")).await.expect(StatusCode::OK);
}

/// Values that grow evenly from healthy to half as much again as the threshold of 0.4.
pub fn growing() -> Vec<f64> {
    (1..=12).map(|i| 0.05 * f64::from(i)).collect()
}

pub async fn items(service: &Service, path: &str) -> Vec<Value> {
    service.get(path).await.expect(StatusCode::OK).value("/items").as_array().unwrap().clone()
}

/// The one alert of a kind.
pub async fn alert(service: &Service, kind: &str) -> Value {
    let alerts = items(service, "/v1/alerts").await;
    let mut found = alerts.into_iter().filter(|alert| alert["kind"] == kind);
    let alert = found.next().unwrap();
    assert!(found.next().is_none());
    alert
}

#[tokio::test]
async fn a_lowered_threshold_and_an_excluded_trace_change_alerts_without_a_reader() {
    let service = Service::new().await;
    let actuator = worn(&service, "EHA-1", &growing()[..6]).await;
    assert!(items(&service, "/v1/alerts").await.iter().all(|alert| alert["kind"] != "threshold"));
    let expected = async |state: &str| {
        let started = Instant::now();
        let found = async || items(&service, "/v1/alerts").await.into_iter().find(|alert| alert["kind"] == "threshold");
        while found().await.is_none_or(|alert| alert["state"] != state) {
            assert!(started.elapsed() < PATIENCE, "no alert became {state}");
            tokio::time::sleep(PAUSE).await;
        }
    };
    let lower = json!({"thresholds": {"kgm": 0.2}});
    service.patch_json(&format!("/v1/actuators/{actuator}"), &lower).await.expect(StatusCode::OK);
    expected("open").await;
    let records = items(&service, &format!("/v1/actuators/{actuator}/health")).await;
    for record in &records[2..] {
        let path = format!("/v1/traces/{}", record["trace_id"].as_str().unwrap());
        let excluded = json!({"excluded": true, "reason": "another part"});
        service.patch_json(&path, &excluded).await.expect(StatusCode::OK);
    }
    expected("cleared").await;
}

#[tokio::test]
async fn an_alert_has_exactly_the_promised_fields_and_a_sentence() {
    let service = Service::new().await;
    let actuator = worn(&service, "EHA-1", &growing()).await;
    let threshold = alert(&service, "threshold").await;
    let names: Vec<_> = threshold.as_object().unwrap().keys().collect();
    let promised = [
        "acknowledged_at",
        "actuator_id",
        "cleared_at",
        "cleared_because",
        "fault",
        "id",
        "kind",
        "limit",
        "message",
        "note",
        "raised_at",
        "risk",
        "serial_number",
        "state",
        "tail_number",
        "threshold",
        "trace_id",
        "usage",
        "usage_unit",
        "value",
        "value_std",
        "within",
    ];
    assert_eq!(names, promised);
    let newest = service.get(&format!("/v1/actuators/{actuator}/health")).await.value("/items/11/trace_id");
    let figures = json!({
        "actuator_id": actuator, "serial_number": "EHA-1", "tail_number": "I-ELVN", "fault": "kgm", "state": "open",
        "usage": 1200.0, "usage_unit": "flight_hours", "value": 0.05 * 12.0, "value_std": 0.01, "threshold": 0.4,
        "risk": null, "limit": null, "within": null, "trace_id": newest, "note": "", "cleared_at": null
    });
    for (name, value) in figures.as_object().unwrap() {
        assert_eq!(&threshold[name], value, "{name}");
    }
    let message = threshold["message"].as_str().unwrap();
    for part in ["EHA-1", "left aileron", "I-ELVN", "KGM", "0.4", "0.6 ± 0.01", "1200 flight hours"] {
        assert!(message.contains(part), "{message}");
    }
    let risk = alert(&service, "risk").await;
    assert_eq!((&risk["fault"], &risk["value"], &risk["limit"]), (&Value::Null, &Value::Null, &json!(0.1)));
    assert!(risk["risk"].as_f64().unwrap() >= 0.1 && risk["within"] == 100.0, "{risk}");
    assert!(risk["message"].as_str().unwrap().contains("next 100 flight hours"), "{risk}");
    let id = risk["id"].as_str().unwrap();
    assert_eq!(service.get(&format!("/v1/alerts/{id}")).await.json(), risk);
}

#[tokio::test]
async fn a_healthy_actuator_has_no_alert_and_the_fleet_counts_those_of_the_others() {
    let service = Service::new().await;
    let healthy = worn(&service, "EHA-1", &[0.001, 0.002, 0.001, 0.002]).await;
    let worn = worn(&service, "EHA-2", &growing()).await;
    assert_eq!(items(&service, &format!("/v1/actuators/{healthy}/alerts")).await, [] as [Value; 0]);
    assert_eq!(items(&service, &format!("/v1/actuators/{worn}/alerts?state=open")).await.len(), 2);
    assert_eq!(items(&service, &format!("/v1/alerts?actuator_id={worn}")).await.len(), 2);
    assert_eq!(items(&service, &format!("/v1/alerts?actuator_id={healthy}")).await.len(), 0);
    let rows = items(&service, "/v1/fleet/health").await;
    let count = |id: &str| rows.iter().find(|row| row["actuator_id"] == id).unwrap()["alerts_open"].clone();
    assert_eq!((count(&worn), count(&healthy)), (json!(2), json!(0)));
}

#[tokio::test]
async fn an_alert_is_acknowledged_with_a_note_that_stays() {
    let service = Service::new().await;
    worn(&service, "EHA-1", &growing()).await;
    let path = format!("/v1/alerts/{}", alert(&service, "threshold").await["id"].as_str().unwrap());
    let body = json!({"state": "acknowledged", "note": "  part ordered "});
    let acknowledged = service.patch_json(&path, &body).await.expect(StatusCode::OK);
    assert_eq!(acknowledged.text("/state"), "acknowledged");
    assert_eq!(acknowledged.text("/note"), "part ordered");
    assert!(acknowledged.text("/acknowledged_at") >= acknowledged.text("/raised_at"));
    let again = service.patch_json(&path, &body).await.expect(StatusCode::OK);
    assert_eq!(again.json(), acknowledged.json(), "the same again changes nothing");
    let other = json!({"state": "acknowledged", "note": "another"});
    service.patch_json(&path, &other).await.expect_problem(409, &[]);
    assert_eq!(items(&service, "/v1/alerts?state=acknowledged").await, [acknowledged.json()]);
    assert_eq!(items(&service, "/v1/alerts?state=open").await.len(), 1);
}

#[tokio::test]
async fn maintenance_clears_alerts_for_good_and_an_inspection_does_not() {
    let service = Service::new().await;
    let actuator = worn(&service, "EHA-1", &growing()).await;
    let events = format!("/v1/actuators/{actuator}/maintenance");
    let event = |kind: &str| json!({"kind": kind, "at": "2026-03-20T12:00:00Z", "usage": 2000, "note": ""});
    service.post_json(&events, &event("inspected")).await.expect(StatusCode::CREATED);
    service.get(&format!("/v1/actuators/{actuator}/remaining-life")).await.expect(StatusCode::OK);
    assert_eq!(items(&service, "/v1/alerts?state=open").await.len(), 2);
    service.post_json(&events, &event("replaced")).await.expect(StatusCode::CREATED);
    let cleared = items(&service, "/v1/alerts").await;
    assert_eq!(cleared.len(), 2);
    for alert in &cleared {
        assert_eq!((&alert["state"], &alert["cleared_because"]), (&json!("cleared"), &json!("maintenance")));
        let path = format!("/v1/alerts/{}", alert["id"].as_str().unwrap());
        let late = service.patch_json(&path, &json!({"state": "acknowledged"})).await.expect_problem(409, &[]);
        assert!(late.text("/detail").contains("cleared"));
    }
    estimated(&service, &actuator, 21, &[0.001, 0.002]).await;
    assert_eq!(items(&service, "/v1/alerts").await, cleared, "the new life is healthy");
}

#[tokio::test]
async fn an_alert_outlasts_a_dip_and_a_restart_and_is_not_raised_again() {
    let service = Service::new().await;
    let actuator = worn(&service, "EHA-1", &growing()).await;
    let before = items(&service, "/v1/alerts").await;
    let service = service.restarted().await;
    estimated(&service, &actuator, 13, &[0.38]).await;
    assert_eq!(items(&service, "/v1/alerts").await, before);
}

#[tokio::test]
async fn what_cannot_be_read_is_refused_by_its_name() {
    let service = Service::new().await;
    let actuator = worn(&service, "EHA-1", &growing()).await;
    for (query, status, pointer) in [
        ("state=closed", 400, "?state"),
        ("state=Open", 400, "?state"),
        ("actuator_id=x", 400, "?actuator_id"),
        ("limit=0", 422, "?limit"),
        ("cursor=x", 400, "?cursor"),
        ("kind=risk", 400, "?kind"),
    ] {
        service.get(&format!("/v1/alerts?{query}")).await.expect_problem(status, &[pointer]);
    }
    service
        .get(&format!("/v1/actuators/{actuator}/alerts?actuator_id={actuator}"))
        .await
        .expect_problem(400, &["?actuator_id"]);
    let path = format!("/v1/alerts/{}", alert(&service, "risk").await["id"].as_str().unwrap());
    let long = json!({"state": "acknowledged", "note": "x".repeat(2001)}).to_string();
    for (body, status, pointer) in [
        (r#"{"state": "cleared"}"#, 400, "/state"),
        (r#"{"note": "x"}"#, 400, ""),
        (r#"{"state": "acknowledged", "by": "me"}"#, 400, "/by"),
        (r#"["acknowledged"]"#, 400, ""),
        (&long, 422, "/note"),
    ] {
        let body: Value = serde_json::from_str(body).unwrap();
        service.patch_json(&path, &body).await.expect_problem(status, &[pointer]);
    }
    let nowhere = format!("/v1/alerts/{actuator}");
    service.get(&nowhere).await.expect_problem(404, &[]);
    service.patch_json(&nowhere, &json!({"state": "acknowledged"})).await.expect_problem(404, &[]);
    service.get(&format!("/v1/actuators/{}/alerts", "x")).await.expect_problem(404, &[]);
}
