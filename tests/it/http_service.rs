//! The service itself: paths and methods, headers, health, metrics, the specification and the dashboard.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode};
use serde_json::{Value, json};

use super::http_support::{Service, request};

#[tokio::test]
async fn unknown_paths_are_problems() {
    let service = Service::new().await;
    for path in ["/v1", "/v1/", "/v2/actuators", "/v1/actuators/", "/favicon.ico", "/assets/none.js", "/docs"] {
        service.get(path).await.expect_problem(404, &[]);
    }
}

#[tokio::test]
async fn another_method_is_told_the_allowed_ones() {
    let service = Service::new().await;
    let answer = service.delete("/v1/actuators").await.expect_problem(405, &[]);
    let mut allowed: Vec<_> = answer.header("allow").split(',').collect();
    allowed.sort_unstable();
    assert_eq!(allowed, ["GET", "HEAD", "POST"]);
    service.post("/healthz", None, "x").await.expect_problem(405, &[]);
}

#[tokio::test]
async fn the_clients_request_id_is_kept_and_another_one_is_made() {
    let service = Service::new().await;
    let own = Request::get("/none").header("x-request-id", "flight-7").body(Body::empty()).unwrap();
    assert_eq!(service.send(own).await.expect_problem(404, &[]).text("/request_id"), "flight-7");
    let made = service.get("/healthz").await;
    assert_ne!(made.header("x-request-id"), service.get("/healthz").await.header("x-request-id"));
}

#[tokio::test]
async fn a_request_id_that_is_none_is_replaced() {
    let service = Service::new().await;
    let long = "x".repeat(129);
    for ids in [&[""][..], &["a b"], &["a\tb"], &["\u{e9}"], &[&long], &["a", "b"]] {
        let builder = ids.iter().fold(Request::get("/healthz"), |builder, id| builder.header("x-request-id", *id));
        let answer = service.send(builder.body(Body::empty()).unwrap()).await.expect(StatusCode::OK);
        assert_eq!(answer.header("x-request-id").len(), 36, "{ids:?}");
        assert_eq!(answer.headers.get_all("x-request-id").iter().count(), 1);
    }
    let own = Request::get("/healthz").header("x-request-id", &long[..128]).body(Body::empty()).unwrap();
    assert_eq!(service.send(own).await.header("x-request-id"), &long[..128]);
}

#[tokio::test]
async fn the_probes_answer() {
    let service = Service::new().await;
    for path in ["/healthz", "/readyz"] {
        assert_eq!(service.get(path).await.expect(StatusCode::OK).text("/status"), "ok");
    }
}

#[tokio::test]
async fn a_service_that_cannot_read_its_records_is_alive_and_not_ready() {
    let service = Service::new().await;
    sqlx::query("ALTER TABLE actuators RENAME TO gone").execute(&service.database().await).await.unwrap();
    let answer = service.get("/readyz").await.expect_problem(503, &[]);
    assert!(!answer.text("/detail").contains("actuators"), "the cause is logged and not told");
    service.get("/healthz").await.expect(StatusCode::OK);
}

#[tokio::test]
async fn a_request_for_another_host_is_refused_before_it_reads_or_writes_anything() {
    let service = Service::new().await;
    let to = |host: &str, path: &str| Request::get(path).header("host", host).body(Body::empty()).unwrap();
    for path in ["/", "/v1/actuators", "/none"] {
        let answer = service.send(to("rebound.example:8080", path)).await.expect_problem(421, &[]);
        assert!(answer.text("/detail").contains("rebound.example:8080"));
    }
    for host in ["localhost:8080", "127.0.0.1:8080", "[::1]:8080"] {
        service.send(to(host, "/v1/actuators")).await.expect(StatusCode::OK);
    }
    service.send(to("localhost", "http://rebound.example/v1/actuators")).await.expect_problem(421, &[]);
}

#[tokio::test]
async fn metrics_count_and_time_jobs_by_kind_and_end() {
    let service = Service::new().await;
    let simulation =
        json!({"model": "monitoring", "command": "diagnostic", "duration_s": 0.1, "sample_rate_hz": 1000.0});
    service.post_json("/v1/simulations", &simulation).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let text = String::from_utf8(service.get("/metrics").await.expect(StatusCode::OK).body.to_vec()).unwrap();
    assert!(text.contains(r#"elevon_jobs_finished_total{kind="simulation",state="succeeded"}"#), "{text}");
    assert!(text.contains(r#"elevon_job_duration_seconds_bucket{kind="simulation",le="#), "{text}");
    let own = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    assert!(own.clone().count() > 0 && own.clone().all(|line| line.starts_with("elevon_")), "{text}");
}

#[tokio::test]
async fn metrics_count_and_time_requests_by_route_method_and_status() {
    let service = Service::new().await;
    service.get("/v1/jobs/7").await.expect(StatusCode::NOT_FOUND);
    let metrics = service.get("/metrics").await.expect(StatusCode::OK);
    assert!(metrics.header("content-type").starts_with("text/plain"));
    let text = String::from_utf8(metrics.body.to_vec()).unwrap();
    let labels = r#"route="/v1/jobs/{id}",method="GET",status="404""#;
    assert!(text.contains(&format!("elevon_http_requests_total{{{labels}}}")), "{text}");
    assert!(text.contains(&format!("elevon_http_request_duration_seconds_bucket{{{labels},le=\"0.001\"}}")), "{text}");
    assert!(text.contains("elevon_jobs{state=\"queued\"}"), "{text}");
    assert!(!text.contains("/v1/jobs/7"), "{text}");
}

#[tokio::test]
async fn the_dashboard_comes_with_a_strict_policy_and_the_right_types() {
    let service = Service::new().await;
    let files = [("/", "text/html"), ("/assets/style.css", "text/css"), ("/assets/dashboard.js", "text/javascript")];
    for (path, media_type) in files {
        let answer = service.get(path).await.expect(StatusCode::OK);
        assert!(answer.header("content-type").starts_with(media_type), "{path}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        let policy = answer.header("content-security-policy");
        assert!(policy.starts_with("default-src 'none'; script-src 'self'; style-src 'self'"), "{policy}");
        assert!(!policy.contains("unsafe") && !policy.contains("http"), "{policy}");
    }
}

#[tokio::test]
async fn the_specification_is_served_in_both_forms() {
    let service = Service::new().await;
    let yaml = service.get("/openapi.yaml").await.expect(StatusCode::OK);
    assert_eq!(yaml.body, elevon::http::openapi::yaml().unwrap());
    let json = service.get("/openapi.json").await.expect(StatusCode::OK).json();
    assert_eq!(json["info"]["version"], elevon::VERSION);
}

/// Re-bless with `cargo run -- openapi > openapi.yaml`.
#[test]
fn openapi_yaml_is_what_the_code_says() {
    let written = include_str!("../../openapi.yaml");
    let generated = elevon::http::openapi::yaml().unwrap();
    assert!(written == generated, "openapi.yaml is out of date: cargo run -- openapi > openapi.yaml");
}

/// The path, the method and the operation of everything that the specification tells.
fn operations() -> Vec<(String, Method, Value)> {
    let document: Value = serde_json::from_str(&elevon::http::openapi::json().unwrap()).unwrap();
    let paths = document["paths"].as_object().unwrap().clone();
    let operations = paths.into_iter().flat_map(|(path, item)| {
        let methods = item.as_object().unwrap().clone();
        methods.into_iter().map(move |(method, operation)| {
            (path.clone(), Method::from_bytes(method.to_uppercase().as_bytes()).unwrap(), operation)
        })
    });
    operations.collect()
}

#[tokio::test]
async fn every_path_answers_the_documented_methods_and_no_others() {
    let service = Service::new().await;
    let operations = operations();
    for path in operations.iter().map(|(path, ..)| path) {
        let mut documented: Vec<_> =
            operations.iter().filter(|(other, ..)| other == path).map(|(_, method, _)| method.as_str()).collect();
        if documented.contains(&"GET") {
            documented.push("HEAD");
        }
        documented.sort_unstable();
        let answer = service.send(request(Method::TRACE, path, None, Body::empty())).await.expect_problem(405, &[]);
        let mut allowed: Vec<_> = answer.header("allow").split(',').collect();
        allowed.sort_unstable();
        assert_eq!(allowed, documented, "{path}");
    }
}

#[test]
fn every_operation_has_a_summary_and_says_what_its_problems_look_like() {
    for (path, method, operation) in operations() {
        assert!(operation["summary"].as_str().is_some_and(|text| text.ends_with('.')), "{method} {path}");
        for (status, response) in operation["responses"].as_object().unwrap() {
            let is_problem = response["content"].get("application/problem+json").is_some();
            assert_eq!(is_problem, status.starts_with(['4', '5']), "{method} {path} {status}");
        }
    }
}

/// Every `$ref` of a document.
fn references(value: &Value) -> Vec<&str> {
    match value {
        Value::Object(members) => members
            .iter()
            .flat_map(|(name, member)| match member.as_str() {
                Some(text) if name == "$ref" => vec![text],
                _ => references(member),
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(references).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn every_reference_in_the_specification_leads_somewhere() {
    let document: Value = serde_json::from_str(&elevon::http::openapi::json().unwrap()).unwrap();
    let references = references(&document);
    assert!(references.contains(&"#/components/schemas/FleetItem"));
    for reference in references {
        assert!(document.pointer(reference.trim_start_matches('#')).is_some(), "{reference}");
    }
}
