//! Uploads that are refused: each with its status, its place, and nothing stored.

use axum::body::Body;
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE};
use axum::http::{Request, StatusCode};
use serde_json::{Value, json};

use super::http_support::{RECORDED, Service, csv_with_line, still_csv};

/// Uploads one file to a new service, expects a refusal, and that nothing was stored.
async fn refused(media_type: Option<&str>, body: impl Into<Body>, status: u16, pointers: &[&str]) -> Value {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let answer = service.post(&path, media_type, body).await.expect_problem(status, pointers);
    service.assert_nothing_is_stored().await;
    answer.json()
}

async fn refused_csv(csv: String, pointers: &[&str]) -> Value {
    refused(Some("text/csv"), csv, 422, pointers).await
}

/// Uploads a good file with another query, and expects a refusal.
async fn refused_query(query: &str, status: u16, pointers: &[&str]) {
    let service = Service::new().await;
    let path = format!("/v1/actuators/{}/traces?{query}", service.registered("EHA-1").await);
    service.post(&path, Some("text/csv"), still_csv()).await.expect_problem(status, pointers);
    service.assert_nothing_is_stored().await;
}

#[tokio::test]
async fn an_empty_body_is_malformed() {
    refused(Some("text/csv"), "", 400, &[]).await;
}

#[tokio::test]
async fn a_file_without_a_needed_column_is_invalid() {
    let csv = still_csv().replace("position_command_m", "something_else");
    let problem = refused_csv(csv, &["line 1"]).await;
    assert!(problem.to_string().contains("position_command_m"), "{problem:#}");
}

#[tokio::test]
async fn a_value_that_is_no_number_is_told_by_line_and_column() {
    refused_csv(csv_with_line(5, "0.003,0,zero,0"), &["line 5, column servovalve_current_a"]).await;
}

#[tokio::test]
async fn a_number_that_is_not_finite_is_told_by_line_and_column() {
    refused_csv(csv_with_line(5, "0.003,0,0,inf"), &["line 5, column load_pressure_pa"]).await;
    refused_csv(csv_with_line(6, "0.004,NaN,0,0"), &["line 6, column position_command_m"]).await;
}

#[tokio::test]
async fn a_line_of_another_length_is_told() {
    refused_csv(csv_with_line(5, "0.003,0,0"), &["line 5, column load_pressure_pa"]).await;
}

#[tokio::test]
async fn falling_and_duplicate_times_are_told_by_line() {
    refused_csv(csv_with_line(8, "0.001,0,0,0"), &["line 8, column time_s"]).await;
    refused_csv(csv_with_line(8, "0.005,0,0,0"), &["line 8, column time_s"]).await;
}

#[tokio::test]
async fn a_gap_is_told_by_line() {
    let mut lines: Vec<_> = still_csv().lines().map(str::to_owned).collect();
    lines.truncate(15);
    lines.push("5.0,0,0,0".into());
    refused_csv(lines.join("\n"), &["line 16, column time_s"]).await;
}

#[tokio::test]
async fn a_trace_that_is_too_short_is_invalid() {
    let short: Vec<_> = still_csv().lines().take(6).map(str::to_owned).collect();
    refused_csv(short.join("\n"), &["file"]).await;
}

#[tokio::test]
async fn bytes_that_are_no_text_are_invalid() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let answer = service.post(&path, Some("text/csv"), vec![0xff, 0xfe, 0x00, 0x01]).await;
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    service.assert_nothing_is_stored().await;
}

#[tokio::test]
async fn json_that_is_broken_or_no_trace_is_told_by_its_pointer() {
    for text in ["{", "7", r#"{"columns": 7}"#] {
        let service = Service::new().await;
        let path = service.upload_path().await;
        let answer = service.post(&path, Some("application/json"), text).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{text}");
        service.assert_nothing_is_stored().await;
    }
    let mut columns = json!({"time_s": (0..20).collect::<Vec<_>>(), "position_command_m": vec![0; 20],
        "load_pressure_pa": vec![0; 20]});
    columns["load_pressure_pa"][3] = json!("high");
    let body = json!({"columns": columns}).to_string();
    refused(Some("application/json"), body, 422, &["/columns/load_pressure_pa/3"]).await;
}

/// A trace of 20 samples in JSON with one column changed, as text.
fn json_with(column: &str, change: impl FnOnce(&mut Vec<Value>)) -> String {
    let mut columns = json!({"time_s": (0..20).collect::<Vec<_>>(), "position_command_m": vec![0; 20],
        "load_pressure_pa": vec![0; 20]});
    change(columns[column].as_array_mut().unwrap());
    json!({"columns": columns}).to_string()
}

async fn refused_json(body: String, pointer: &str) -> String {
    refused(Some("application/json"), body, 422, &[pointer]).await["detail"].as_str().unwrap().to_owned()
}

#[tokio::test]
async fn falling_and_repeated_times_in_json_are_told_by_their_pointer() {
    for time in [1, 5] {
        refused_json(json_with("time_s", |times| times[6] = json!(time)), "/columns/time_s/6").await;
    }
}

#[tokio::test]
async fn a_gap_in_json_is_told_by_its_pointer() {
    refused_json(json_with("time_s", |times| times[19] = json!(1000)), "/columns/time_s/19").await;
}

#[tokio::test]
async fn a_number_too_large_to_be_finite_is_told_by_its_pointer() {
    let body = json_with("load_pressure_pa", |values| values[3] = json!("?")).replace("\"?\"", "1e999");
    refused_json(body, "/columns/load_pressure_pa/3").await;
}

#[tokio::test]
async fn json_without_a_needed_column_is_told_which() {
    let body = json_with("time_s", |_| ()).replace("position_command_m", "something_else");
    let detail = refused_json(body, "/columns").await;
    assert!(detail.contains("position_command_m"), "{detail}");
}

#[tokio::test]
async fn a_media_type_that_is_absent_or_unknown_names_the_accepted_ones() {
    for media_type in [None, Some("text/plain"), Some("application/x-www-form-urlencoded"), Some("")] {
        let problem = refused(media_type, still_csv(), 415, &[]).await;
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("text/csv") && detail.contains("application/json"), "{detail}");
    }
}

#[tokio::test]
async fn parameters_of_a_media_type_are_accepted() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    service.post(&path, Some("text/csv; charset=utf-8"), still_csv()).await.expect(StatusCode::ACCEPTED);
}

#[tokio::test]
async fn an_encoded_body_is_refused_and_identity_is_none() {
    let service = Service::new().await;
    let path = service.upload_path().await;
    let encoded = |encoding: &str| {
        let request = Request::post(&path).header(CONTENT_TYPE, "text/csv").header(CONTENT_ENCODING, encoding);
        request.body(Body::from(still_csv())).unwrap()
    };
    let answer = service.send(encoded("gzip")).await.expect_problem(415, &[]);
    assert!(answer.text("/detail").contains("gzip"));
    service.assert_nothing_is_stored().await;
    service.send(encoded("identity")).await.expect(StatusCode::ACCEPTED);
}

#[tokio::test]
async fn a_body_over_the_limit_is_refused_and_told_the_limit() {
    let service = Service::with(|config| config.http.body_limit_bytes = 1024).await;
    let path = service.upload_path().await;
    let answer = service.post(&path, Some("text/csv"), "x".repeat(1025)).await.expect_problem(413, &[]);
    assert!(answer.text("/detail").contains("1024 bytes"));
    service.assert_nothing_is_stored().await;
}

#[tokio::test]
async fn a_missing_time_or_usage_is_malformed() {
    refused_query("", 400, &["?recorded_at", "?usage"]).await;
    refused_query("usage=1", 400, &["?recorded_at"]).await;
    refused_query("recorded_at=2026-03-01T12:00:00Z", 400, &["?usage"]).await;
}

#[tokio::test]
async fn a_time_without_an_offset_is_malformed() {
    refused_query("usage=1&recorded_at=2026-03-01T12:00:00", 400, &["?recorded_at"]).await;
    refused_query("usage=1&recorded_at=2026-03-01", 400, &["?recorded_at"]).await;
}

#[tokio::test]
async fn a_usage_out_of_range_is_invalid_and_no_number_malformed() {
    for usage in ["-1", "inf", "nan", "1e999", "10000001"] {
        refused_query(&format!("recorded_at=2026-03-01T12:00:00Z&usage={usage}"), 422, &["?usage"]).await;
    }
    refused_query("recorded_at=2026-03-01T12:00:00Z&usage=ten", 400, &["?usage"]).await;
}

#[tokio::test]
async fn unknown_repeated_and_differently_cased_names_are_malformed() {
    refused_query(&format!("{RECORDED}&colour=red"), 400, &["?colour"]).await;
    refused_query(&format!("{RECORDED}&usage=2"), 400, &["?usage"]).await;
    refused_query(&format!("{RECORDED}&Seed=2"), 400, &["?Seed"]).await;
}

#[tokio::test]
async fn settings_of_the_search_out_of_range_are_told_at_once() {
    let query = format!("{RECORDED}&population=3&generations=1001&sample_rate_hz=0");
    refused_query(&query, 422, &["?population", "?generations", "?sample_rate_hz"]).await;
    refused_query(&format!("{RECORDED}&seed=-1"), 400, &["?seed"]).await;
    refused_query(&format!("{RECORDED}&population=4.5"), 400, &["?population"]).await;
    refused_query(&format!("{RECORDED}&method=luck&ga=scaling%3Dtop"), 400, &["?method", "?ga"]).await;
}

#[tokio::test]
async fn a_column_map_that_is_none_is_malformed() {
    refused_query(&format!("{RECORDED}&columns=Cor"), 400, &["?columns"]).await;
}

#[tokio::test]
async fn an_upload_to_an_unknown_actuator_is_not_found() {
    let service = Service::new().await;
    let path = format!("/v1/actuators/01890a5d-ac96-774b-bcce-b302099a8057/traces?{RECORDED}");
    service.post(&path, Some("text/csv"), still_csv()).await.expect_problem(404, &[]);
    service.assert_nothing_is_stored().await;
}

#[tokio::test]
async fn a_full_queue_asks_to_try_again_and_keeps_nothing_of_the_upload() {
    let service = Service::with(|config| config.jobs.queue_limit = 1).await;
    let path = service.upload_path().await;
    let kept = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    let answer = service.post(&path, Some("text/csv"), still_csv()).await.expect_problem(503, &[]);
    assert_eq!(answer.header("retry-after"), "5");
    let jobs = service.get("/v1/jobs").await.value("/items");
    assert_eq!(jobs.as_array().unwrap().len(), 1);
    assert_eq!(jobs[0]["id"], kept.value("/job/id"));
    service.work().await;
    service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
}
