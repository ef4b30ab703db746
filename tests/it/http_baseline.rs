//! Baselines and the growth since, over HTTP.

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{Answer, Service, still_csv};

/// A service whose baselines are made of two traces, and an actuator.
async fn of_two() -> (Service, String) {
    let service = Service::with(|config| config.prognostics.baseline_traces = 2).await;
    let actuator = service.registered("EHA-1").await;
    (service, actuator)
}

/// Uploads a trace recorded on a day of March 2026 and gives its estimate these figures, KGM give or take 0.01 and FDJ
/// 4 N; the trace's id.
async fn estimated(service: &Service, actuator: &str, day: u32, kgm: f64, fdj_n: f64) -> String {
    let path = format!("/v1/actuators/{actuator}/traces?recorded_at=2026-03-{day:02}T12:00:00Z&usage={day}");
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let trace = accepted.text("/trace/id");
    let update = "UPDATE health SET kgm = ?2, kgm_std = 0.01, fdj_n = ?3, fdj_n_std = 4.0, verdict = 'conclusive' WHERE trace_id = ?1";
    let update = sqlx::query(update).bind(&trace).bind(kgm).bind(fdj_n);
    update.execute(&service.database().await).await.unwrap();
    trace
}

async fn baseline(service: &Service, actuator: &str) -> Answer {
    service.get(&format!("/v1/actuators/{actuator}/baseline")).await.expect(StatusCode::OK)
}

async fn maintained(service: &Service, actuator: &str, kind: &str, day: u32) {
    let body = json!({"kind": kind, "at": format!("2026-03-{day:02}T00:00:00Z"), "usage": day});
    let path = format!("/v1/actuators/{actuator}/maintenance");
    service.post_json(&path, &body).await.expect(StatusCode::CREATED);
}

/// The growth of KGM and FDJ with their standard deviations, record by record.
async fn growth(service: &Service, actuator: &str) -> Vec<Option<[f64; 4]>> {
    let history = service.get(&format!("/v1/actuators/{actuator}/health")).await.expect(StatusCode::OK);
    let of = |item: &Value| {
        let names = ["kgm_growth", "kgm_growth_std", "fdj_n_growth", "fdj_n_growth_std"];
        let found = names.map(|name| item[name].as_f64());
        assert!(found.iter().all(Option::is_some) || found.iter().all(Option::is_none), "{item:#}");
        found[0].map(|_| found.map(Option::unwrap))
    };
    history.value("/items").as_array().unwrap().iter().map(of).collect()
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
}

#[tokio::test]
async fn the_first_healthy_traces_make_the_baseline_and_later_estimates_say_the_growth_since() {
    let (service, actuator) = of_two().await;
    let first = estimated(&service, &actuator, 1, 0.02, 210.0).await;
    let gathering = baseline(&service, &actuator).await;
    assert_eq!((gathering.value("/complete"), gathering.value("/traces_wanted")), (json!(false), json!(2)));
    assert_eq!(
        [gathering.value("/kgm"), gathering.value("/gain"), gathering.value("/fdj_n")],
        [(); 3].map(|()| Value::Null)
    );
    assert!(gathering.text("/reasons/0").starts_with("1 of 2 healthy traces"), "{:#}", gathering.json());
    assert_eq!(growth(&service, &actuator).await, [None]);

    let second = estimated(&service, &actuator, 2, 0.03, 218.0).await;
    estimated(&service, &actuator, 3, 0.085, 334.0).await;
    let complete = baseline(&service, &actuator).await;
    assert_eq!((complete.value("/complete"), complete.value("/reasons")), (json!(true), json!([])));
    assert_eq!((complete.text("/traces/0/trace_id"), complete.text("/traces/1/trace_id")), (first, second));
    let figure = |name: &str| ["value", "std"].map(|part| complete.value(&format!("/{name}/{part}")).as_f64().unwrap());
    // Of equal weights: the standard deviation is 0.01 / sqrt(2), more than the scatter's 0.005; the scatter's 4 N is more
    // than 4 / sqrt(2).
    for (name, value, std) in
        [("kgm", 0.025, 0.01 / 2f64.sqrt()), ("gain", 0.975, 0.01 / 2f64.sqrt()), ("fdj_n", 214.0, 4.0)]
    {
        near(figure(name)[0], value);
        near(figure(name)[1], std);
    }
    assert_eq!(complete.value("/current_offset_a"), Value::Null);
    let growth = growth(&service, &actuator).await;
    assert_eq!(&growth[..2], [None, None], "the baseline's own traces");
    let expected = [0.06, 0.01 * 1.5f64.sqrt(), 120.0, 32f64.sqrt()];
    growth[2].unwrap().into_iter().zip(expected).for_each(|(found, expected)| near(found, expected));
}

#[tokio::test]
async fn a_trace_beyond_half_of_the_way_to_a_threshold_is_passed_over_and_named() {
    let (service, actuator) = of_two().await;
    let beyond = estimated(&service, &actuator, 1, 0.2, 210.0).await;
    estimated(&service, &actuator, 2, 0.02, 210.0).await;
    let both = estimated(&service, &actuator, 3, 0.3, 600.0).await;
    estimated(&service, &actuator, 4, 0.02, 599.0).await;
    let found = baseline(&service, &actuator).await;
    assert_eq!(found.value("/complete"), json!(true));
    assert_eq!(found.value("/healthy_below"), json!({"kgm": 0.2, "fdj_n": 600.0}));
    assert_eq!(found.value("/traces").as_array().unwrap().len(), 2);
    let passed_over = found.value("/passed_over");
    assert_eq!((&passed_over[0]["trace_id"], &passed_over[1]["trace_id"]), (&json!(beyond), &json!(both)));
    assert_eq!(passed_over[0]["reason"], "kgm: found 0.2, expected below 0.2");
    assert_eq!(passed_over[1]["reason"], "kgm: found 0.3, expected below 0.2; fdj_n: found 600, expected below 600");
    assert_eq!(found.value("/reasons"), json!(["2 conclusive traces were not taken"]));
    assert_eq!(growth(&service, &actuator).await, [None; 4], "nothing was recorded after the baseline");
}

#[tokio::test]
async fn a_late_upload_and_an_exclusion_change_the_baseline() {
    let (service, actuator) = of_two().await;
    estimated(&service, &actuator, 2, 0.02, 210.0).await;
    let third = estimated(&service, &actuator, 3, 0.04, 210.0).await;
    estimated(&service, &actuator, 4, 0.1, 300.0).await;
    let kgm = async || baseline(&service, &actuator).await.value("/kgm/value").as_f64().unwrap();
    near(kgm().await, 0.03);
    let late = estimated(&service, &actuator, 1, 0.01, 210.0).await;
    near(kgm().await, 0.015);
    let found = growth(&service, &actuator).await;
    near(found[2].unwrap()[0], 0.025);
    near(found[3].unwrap()[0], 0.085);
    let exclude = async |trace: &str, excluded: bool| {
        service.patch_json(&format!("/v1/traces/{trace}"), &json!({"excluded": excluded})).await.expect(StatusCode::OK)
    };
    exclude(&late, true).await;
    near(kgm().await, 0.03);
    exclude(&third, true).await;
    near(kgm().await, 0.06);
    assert_eq!(growth(&service, &actuator).await, [None; 2]);
    exclude(&late, false).await;
    near(kgm().await, 0.015);
}

#[tokio::test]
async fn a_replacement_starts_a_new_baseline_and_an_inspection_does_not() {
    let (service, actuator) = of_two().await;
    for (day, kgm) in [(1, 0.02), (2, 0.02), (3, 0.1), (10, 0.01), (11, 0.03), (12, 0.05)] {
        estimated(&service, &actuator, day, kgm, 210.0).await;
    }
    let kgm = async || growth(&service, &actuator).await.into_iter().map(|found| found.map(|found| found[0]));
    let told = kgm().await.collect::<Vec<_>>();
    assert_eq!(told.iter().filter(|found| found.is_some()).count(), 4);
    maintained(&service, &actuator, "inspected", 8).await;
    assert_eq!(kgm().await.collect::<Vec<_>>(), told);
    maintained(&service, &actuator, "replaced", 9).await;
    let found = baseline(&service, &actuator).await;
    assert_eq!(
        (found.text("/life_start"), found.value("/life_start_usage")),
        ("2026-03-09T00:00:00Z".into(), json!(9.0))
    );
    near(found.value("/kgm/value").as_f64().unwrap(), 0.02);
    let expected = [None, None, Some(0.08), None, None, Some(0.03)];
    for (found, expected) in kgm().await.zip(expected) {
        assert_eq!(found.is_some(), expected.is_some());
        near(found.unwrap_or(0.0), expected.unwrap_or(0.0));
    }
    let span = format!("/v1/actuators/{actuator}/health?from=2026-03-03T00:00:00Z&to=2026-03-04T00:00:00Z");
    near(service.get(&span).await.value("/items/0/kgm_growth").as_f64().unwrap(), 0.08);
    maintained(&service, &actuator, "overhauled", 20).await;
    let found = baseline(&service, &actuator).await;
    assert_eq!(
        (found.value("/complete"), found.value("/traces"), found.value("/kgm")),
        (json!(false), json!([]), Value::Null)
    );
}

#[tokio::test]
async fn the_currents_offset_is_of_those_traces_that_determine_it() {
    let (service, actuator) = of_two().await;
    estimated(&service, &actuator, 1, 0.02, 210.0).await;
    let second = estimated(&service, &actuator, 2, 0.02, 210.0).await;
    let faults = json!({"current_offset_a": -2e-4, "current_offset_a_std": 1e-5}).to_string();
    let update = sqlx::query("UPDATE health SET faults = ?2 WHERE trace_id = ?1").bind(second).bind(faults);
    update.execute(&service.database().await).await.unwrap();
    let offset = baseline(&service, &actuator).await.value("/current_offset_a");
    assert_eq!(offset, json!({"value": -2e-4, "std": 1e-5, "traces": 1}));
}

#[tokio::test]
async fn an_actuator_that_was_never_seen_healthy_has_no_baseline_and_is_told_why() {
    let (service, actuator) = of_two().await;
    let first = estimated(&service, &actuator, 1, 0.3, 210.0).await;
    // The same estimate 600 times, a second apart; then two that are healthy.
    let copies = [
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 600) INSERT INTO traces (id, actuator_id,
        recorded_at, usage, media_type, columns, size_bytes, sha256, samples, duration_s, created_at) SELECT
        printf('00000000-0000-7000-8000-%012d', i), actuator_id, recorded_at + 1000000 * i, usage, media_type, columns,
        size_bytes, sha256, samples, duration_s, created_at FROM traces, n WHERE id = ?1",
        "INSERT INTO health (actuator_id, recorded_at, trace_id, job_id, usage, kgm, kgm_std, fdj_n, fdj_n_std, verdict) SELECT
        t.actuator_id, t.recorded_at, t.id, h.job_id, h.usage, h.kgm, h.kgm_std, h.fdj_n, h.fdj_n_std, h.verdict FROM traces t,
        health h WHERE h.trace_id = ?1 AND t.id <> ?1",
    ];
    for sql in copies {
        sqlx::query(sql).bind(&first).execute(&service.database().await).await.unwrap();
    }
    for day in [2, 3] {
        estimated(&service, &actuator, day, 0.02, 210.0).await;
    }
    let found = baseline(&service, &actuator).await;
    assert_eq!((found.value("/complete"), found.value("/kgm")), (json!(false), Value::Null));
    assert!(found.text("/reasons/0").starts_with("only 0 of the first 500 traces"), "{:#}", found.value("/reasons"));
    assert_eq!(found.text("/reasons/1"), "500 conclusive traces were not taken");
}

#[tokio::test]
async fn recovers_the_growth_of_a_simulated_actuator_with_a_bias_of_its_own() {
    let (service, actuator) = of_two().await;
    for (day, kgm, fdj_n) in [(1, 0.05, 250.0), (2, 0.05, 250.0), (3, 0.15, 400.0)] {
        let body = json!({"model": "reference", "command": "diagnostic", "faults": {"kgm": kgm, "fdj_n": fdj_n},
            "noise_power": 5e-7, "seed": day, "duration_s": 6.0, "sample_rate_hz": 1000.0});
        let queued = service.post_json("/v1/simulations", &body).await.expect(StatusCode::ACCEPTED);
        service.work().await;
        let trace = service.get(queued.header("location")).await.text("/result/trace_id");
        let csv = service.get(&format!("/v1/traces/{trace}/data")).await.expect(StatusCode::OK).body;
        let path =
            format!("/v1/actuators/{actuator}/traces?recorded_at=2026-03-{day:02}T12:00:00Z&usage={day}&population=20");
        service.post(&path, Some("text/csv"), csv).await.expect(StatusCode::ACCEPTED);
        service.work().await;
    }
    let growth = growth(&service, &actuator).await;
    assert_eq!(&growth[..2], [None, None]);
    let [kgm, kgm_std, fdj_n, fdj_n_std] = growth[2].unwrap();
    assert!((kgm - 0.1).abs() < 0.03 && (0.0..0.03).contains(&kgm_std), "{growth:?}");
    assert!((fdj_n - 150.0).abs() < 40.0 && (0.0..60.0).contains(&fdj_n_std), "{growth:?}");
}

#[tokio::test]
async fn a_baseline_of_what_is_no_actuator_is_not_found() {
    Service::new().await.get("/v1/actuators/7/baseline").await.expect_problem(404, &[]);
}
