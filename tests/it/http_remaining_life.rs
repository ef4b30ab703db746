//! The remaining life over HTTP: risks asked about, dates, the trend, thresholds.

use axum::http::StatusCode;
use serde_json::{Value, json};

use super::http_support::{Answer, Service, still_csv};

/// A service with an actuator, and the path of its remaining life.
async fn one_actuator() -> (Service, String, String) {
    let service = Service::new().await;
    let actuator = service.registered("EHA-1").await;
    let path = format!("/v1/actuators/{actuator}/remaining-life");
    (service, actuator, path)
}

/// Uploads a trace recorded on a day of March 2026, with 10 of usage for each day, and gives its estimate this KGM; the
/// forecast is made with it. The trace's id.
async fn estimated(service: &Service, actuator: &str, day: u32, kgm: f64) -> String {
    let usage = 10 * day;
    let path = format!("/v1/actuators/{actuator}/traces?recorded_at=2026-03-{day:02}T12:00:00Z&usage={usage}");
    let accepted = service.post(&path, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    let trace = accepted.text("/trace/id");
    let database = service.database().await;
    let update = "UPDATE health SET kgm = ?2, kgm_std = 0.01, fdj_n = 210.0, fdj_n_std = 4.0, verdict = 'conclusive' WHERE trace_id = ?1";
    sqlx::query(update).bind(&trace).bind(kgm).execute(&database).await.unwrap();
    let grow = "UPDATE actuators SET revision = revision + 1 WHERE id = ?1";
    sqlx::query(grow).bind(actuator).execute(&database).await.unwrap();
    life(service, &format!("/v1/actuators/{actuator}/remaining-life")).await;
    trace
}

async fn life(service: &Service, path: &str) -> Answer {
    service.get(path).await.expect(StatusCode::OK)
}

fn number(answer: &Answer, pointer: &str) -> f64 {
    answer.value(pointer).as_f64().unwrap_or_else(|| panic!("no number at {pointer}: {:#}", answer.json()))
}

/// An actuator whose KGM grew by 0.03 a day for ten days.
async fn worn() -> (Service, String, String) {
    let (service, actuator, path) = one_actuator().await;
    for day in 1..=10 {
        estimated(&service, &actuator, day, 0.03 * f64::from(day)).await;
    }
    (service, actuator, path)
}

#[tokio::test]
async fn the_service_s_own_risks_are_answered_without_a_query_and_others_with_one() {
    let (service, _, path) = worn().await;
    let own = life(&service, &path).await;
    assert_eq!((own.value("/risk/within"), own.value("/act_by/risk")), (json!(100.0), json!(0.05)));
    assert_eq!(own.value("/act_by/remaining"), own.value("/forecast/quantiles/0.05"));
    assert_eq!(life(&service, &format!("{path}?within=100&risk=0.05")).await.json(), own.json(), "the stored one");
    let asked = life(&service, &format!("{path}?within=20&risk=0.4")).await;
    for (part, at) in [("", 100.0), ("/faults/kgm", 100.0), ("/faults/fdj_n", 100.0)] {
        assert_eq!(asked.value(&format!("{part}/risk/within")), 20.0);
        let probability = |answer: &Answer| number(answer, &format!("{part}/risk/probability"));
        assert!(probability(&asked) <= probability(&own), "{part}: {:#}", asked.json());
        assert_eq!(asked.value(&format!("{part}/act_by/risk")), 0.4);
        assert_eq!(
            asked.value(&format!("{part}/forecast/quantiles")),
            own.value(&format!("{part}/forecast/quantiles"))
        );
        if let Some(remaining) = asked.value(&format!("{part}/act_by/remaining")).as_f64() {
            assert_eq!(number(&asked, &format!("{part}/act_by/usage")), at + remaining);
        }
    }
    let remaining = number(&asked, "/act_by/remaining");
    let [low, high] = ["0.25", "0.5"].map(|p| number(&own, &format!("/forecast/quantiles/{p}")));
    assert!(low < remaining && remaining < high, "{low} {remaining} {high}");
    let back = life(&service, &format!("{path}?within={remaining}")).await;
    assert!((number(&back, "/risk/probability") - 0.4).abs() < 1e-3, "{:#}", back.json());
    assert_eq!(life(&service, &path).await.json(), own.json(), "what was asked is not stored");
}

#[tokio::test]
async fn risks_that_are_none_are_refused_by_their_names() {
    let (service, _, path) = one_actuator().await;
    let cases = [
        ("within=0", 422, "?within"),
        ("within=-1", 422, "?within"),
        ("within=1000000.1", 422, "?within"),
        ("within=NaN", 422, "?within"),
        ("within=inf", 422, "?within"),
        ("within=soon", 400, "?within"),
        ("within=", 400, "?within"),
        ("within=1&within=2", 400, "?within"),
        ("risk=0", 422, "?risk"),
        ("risk=1", 422, "?risk"),
        ("risk=1.5", 422, "?risk"),
        ("risk=-0.1", 422, "?risk"),
        ("risk=NaN", 422, "?risk"),
        ("risk=high", 400, "?risk"),
        ("Risk=0.1", 400, "?Risk"),
        ("window=1", 400, "?window"),
    ];
    for (query, status, pointer) in cases {
        service.get(&format!("{path}?{query}")).await.expect_problem(status, &[pointer]);
    }
    service.get(&format!("{path}?within=0&risk=NaN")).await.expect_problem(422, &["?within", "?risk"]);
    for query in ["within=1000000&risk=1e-300", "within=1e-300&risk=0.999999"] {
        let answer = life(&service, &format!("{path}?{query}")).await;
        assert_eq!((answer.value("/risk"), answer.value("/act_by")), (Value::Null, Value::Null), "no trace yet");
    }
}

#[tokio::test]
async fn the_most_extreme_risks_have_finite_answers_or_a_reason() {
    let (service, _, path) = worn().await;
    for (within, risk) in [("1e-300", "1e-300"), ("1000000", "0.9999999999999999"), ("0.001", "0.5")] {
        let answer = life(&service, &format!("{path}?within={within}&risk={risk}")).await;
        assert!((0.0..=1.0).contains(&number(&answer, "/risk/probability")), "{:#}", answer.json());
        for part in ["", "/faults/kgm", "/faults/fdj_n"] {
            let act_by = answer.value(&format!("{part}/act_by"));
            let told = act_by["usage"].as_f64().is_some_and(f64::is_finite) && act_by["date"].is_string();
            assert!(told == act_by["reason"].is_null(), "{act_by:#}");
        }
    }
}

#[tokio::test]
async fn dates_follow_the_recent_rate_of_use() {
    let (service, _, path) = worn().await;
    let answer = life(&service, &path).await;
    assert_eq!((answer.value("/use_rate/per_day"), answer.value("/use_rate/traces")), (json!(10.0), json!(10)));
    assert_eq!(answer.text("/use_rate/from"), "2026-03-01T12:00:00Z");
    assert_eq!(answer.text("/use_rate/to"), answer.text("/as_of"));
    assert_eq!(answer.value("/use_rate/reason"), Value::Null);
    for (quantile, date) in ["/forecast", "/faults/kgm/forecast"].into_iter().flat_map(|part| {
        ["0.05", "0.1", "0.25", "0.5", "0.75", "0.9", "0.95"]
            .map(|p| (format!("{part}/quantiles/{p}"), format!("{part}/dates/{p}")))
    }) {
        let remaining_s = number(&answer, &quantile) / 10.0 * 86_400.0;
        let newest: jiff::Timestamp = answer.text("/as_of").parse().unwrap();
        let date: jiff::Timestamp = answer.text(&date).parse().unwrap();
        let found_s = date.as_second() - newest.as_second();
        assert!((found_s as f64 - remaining_s).abs() <= 1.0, "{quantile}: {found_s} {remaining_s}");
    }
    assert_eq!(answer.value("/act_by/date"), answer.value("/forecast/dates/0.05"));
}

#[tokio::test]
async fn one_trace_tells_no_rate_of_use_and_why() {
    let (service, actuator, path) = one_actuator().await;
    let none = life(&service, &path).await;
    assert_eq!(none.text("/use_rate/reason"), "no trace of this life");
    estimated(&service, &actuator, 1, 0.1).await;
    let one = life(&service, &path).await;
    assert_eq!((one.value("/use_rate/per_day"), one.value("/use_rate/traces")), (Value::Null, json!(1)));
    assert_eq!(one.text("/use_rate/reason"), "one trace alone tells no rate of use");
    assert!(one.value("/forecast/dates").as_object().unwrap().values().all(Value::is_null));
    assert!(!one.text("/act_by/reason").is_empty());
}

#[tokio::test]
async fn the_trend_has_a_row_for_every_estimate_with_exactly_the_promised_fields() {
    let (service, actuator, path) = one_actuator().await;
    let mut traces = Vec::new();
    for day in 1..=4 {
        traces.push(estimated(&service, &actuator, day, 0.03 * f64::from(day)).await);
    }
    let trend = service.get(&format!("{path}/trend")).await.expect(StatusCode::OK);
    let items = trend.value("/items");
    let column = |name: &str| items.as_array().unwrap().iter().map(|item| item[name].clone()).collect::<Vec<_>>();
    assert_eq!((json!(column("trace_id")), json!(column("usage"))), (json!(traces), json!([10.0, 20.0, 30.0, 40.0])));
    assert_eq!(trend.value("/next_cursor"), Value::Null);
    let row = &items[3];
    let names: Vec<_> = row.as_object().unwrap().keys().collect();
    let promised = [
        "as_of",
        "end_of_life",
        "faults",
        "forecast",
        "life_start_usage",
        "life_started_at",
        "made_at",
        "risk",
        "trace_id",
        "usage",
        "version",
    ];
    assert_eq!(names, promised);
    assert_eq!((&row["as_of"], &row["life_started_at"]), (&json!("2026-03-04T12:00:00Z"), &Value::Null));
    assert_eq!(row["version"], elevon::VERSION);
    let newest = life(&service, &path).await;
    for (part, of) in [
        (row.clone(), ""),
        (row["faults"]["kgm"].clone(), "/faults/kgm"),
        (row["faults"]["fdj_n"].clone(), "/faults/fdj_n"),
    ] {
        assert_eq!(part["risk"], newest.value(&format!("{of}/risk")));
        for field in ["mean", "reached"] {
            assert_eq!(part["forecast"][field], newest.value(&format!("{of}/forecast/{field}")), "{of}");
        }
        for p in ["0.05", "0.5", "0.95"] {
            let quantile = newest.value(&format!("{of}/forecast/quantiles/{p}"));
            assert_eq!(part["forecast"]["quantiles"][p], quantile, "{of} {p}");
            assert_eq!(part["end_of_life"][p].as_f64(), quantile.as_f64().map(|quantile| 40.0 + quantile), "{of} {p}");
        }
    }
    assert!(items[0]["forecast"].is_object(), "the first estimate has its own: {items:#}");
}

#[tokio::test]
async fn the_trend_is_read_page_by_page_and_cut_by_from_and_to() {
    let (service, actuator, path) = one_actuator().await;
    for day in [1, 2, 3, 5] {
        estimated(&service, &actuator, day, 0.03).await;
    }
    let path = format!("{path}/trend");
    let usages = async |query: &str| {
        let page = service.get(&format!("{path}?{query}")).await.expect(StatusCode::OK).json();
        let usages = page["items"].as_array().unwrap().iter().map(|item| item["usage"].as_f64().unwrap());
        (usages.collect::<Vec<_>>(), page["next_cursor"].as_str().map(str::to_owned))
    };
    let (first, cursor) = usages("limit=3").await;
    let (rest, end) = usages(&format!("limit=3&cursor={}", cursor.unwrap())).await;
    assert_eq!((first, rest, end), (vec![10.0, 20.0, 30.0], vec![50.0], None));
    assert_eq!(usages("from=2026-03-02T12:00:00Z&to=2026-03-05T12:00:00Z").await.0, [20.0, 30.0]);
    estimated(&service, &actuator, 4, 0.2).await;
    assert_eq!(usages("").await.0, [10.0, 20.0, 30.0, 40.0, 50.0], "a late upload has its own row");
    let overhauled = json!({"kind": "overhauled", "at": "2026-03-06T00:00:00Z", "usage": 55.0});
    let maintenance = format!("/v1/actuators/{actuator}/maintenance");
    service.post_json(&maintenance, &overhauled).await.expect(StatusCode::CREATED);
    estimated(&service, &actuator, 7, 0.0).await;
    let renewed = service.get(&format!("{path}?from=2026-03-06T00:00:00Z")).await;
    assert_eq!(renewed.text("/items/0/life_started_at"), "2026-03-06T00:00:00Z");
    assert_eq!(renewed.value("/items/0/life_start_usage"), 55.0);
    assert_eq!(usages("").await.0, [10.0, 20.0, 30.0, 40.0, 50.0, 70.0]);
}

#[tokio::test]
async fn a_trend_that_cannot_be_had_is_refused_by_the_name_that_is_wrong() {
    let (service, _, path) = one_actuator().await;
    let cases = [
        ("from=yesterday", 400, "?from"),
        ("from=2026-03-02T00:00:00Z&to=2026-03-01T00:00:00Z", 422, "?to"),
        ("limit=0", 422, "?limit"),
        ("limit=NaN", 400, "?limit"),
        ("cursor=x", 400, "?cursor"),
        ("within=10", 400, "?within"),
    ];
    for (query, status, pointer) in cases {
        service.get(&format!("{path}/trend?{query}")).await.expect_problem(status, &[pointer]);
    }
    assert_eq!(service.get(&format!("{path}/trend")).await.expect(StatusCode::OK).value("/items"), json!([]));
    service.get("/v1/actuators/7/remaining-life/trend").await.expect_problem(404, &[]);
}

#[tokio::test]
async fn the_trend_and_the_forecast_are_there_after_a_restart() {
    let (service, actuator, path) = one_actuator().await;
    for day in 1..=3 {
        estimated(&service, &actuator, day, 0.05 * f64::from(day)).await;
    }
    let (before, trend) = (life(&service, &path).await.json(), service.get(&format!("{path}/trend")).await.json());
    let service = service.restarted().await;
    assert_eq!(life(&service, &path).await.json(), before);
    assert_eq!(service.get(&format!("{path}/trend")).await.json(), trend);
}

#[tokio::test]
async fn the_fleet_shows_when_to_act_and_the_dates() {
    let (service, _, path) = worn().await;
    let answer = life(&service, &path).await;
    let fleet = service.get("/v1/fleet/health").await.expect(StatusCode::OK);
    assert_eq!(fleet.value("/items/0/act_by"), answer.value("/act_by"));
    assert_eq!(fleet.value("/items/0/remaining_life/dates"), answer.value("/forecast/dates"));
    assert!(fleet.value("/items/0/act_by/date").is_string());
}

#[tokio::test]
async fn thresholds_come_from_the_settings_where_a_registration_has_none() {
    let service = Service::with(|config| {
        config.prognostics.thresholds.kgm = 0.25;
        config.prognostics.thresholds.fdj_n = 650.0;
    })
    .await;
    let path = format!("/v1/actuators/{}", service.registered("EHA-1").await);
    assert_eq!(service.get(&path).await.value("/thresholds"), json!({"kgm": 0.25, "fdj_n": 650.0}));
    let body = json!({"serial_number": "EHA-2", "tail_number": "I-ELVN", "location": "x", "thresholds": {"kgm": 0.5}});
    let other = service.post_json("/v1/actuators", &body).await.expect(StatusCode::CREATED);
    assert_eq!(other.value("/thresholds"), json!({"kgm": 0.5, "fdj_n": 650.0}));
}

#[tokio::test]
async fn a_changed_threshold_changes_the_forecast_at_once_and_the_newest_row_of_the_trend() {
    let (service, actuator, path) = worn().await;
    let before = life(&service, &path).await;
    let actuator = format!("/v1/actuators/{actuator}");
    let changed = service.patch_json(&actuator, &json!({"thresholds": {"kgm": 0.35}})).await.expect(StatusCode::OK);
    assert_eq!(changed.value("/thresholds"), json!({"kgm": 0.35, "fdj_n": 1000.0}));
    assert_eq!(service.get(&actuator).await.json(), changed.json());
    let after = life(&service, &path).await;
    assert_eq!(after.value("/faults/kgm/threshold"), 0.35);
    let median = |answer: &Answer| number(answer, "/faults/kgm/forecast/quantiles/0.5");
    assert!(median(&after) < median(&before));
    assert_eq!(after.value("/faults/fdj_n/forecast/quantiles"), before.value("/faults/fdj_n/forecast/quantiles"));
    let trend = service.get(&format!("{path}/trend")).await;
    assert_eq!(trend.value("/items").as_array().unwrap().len(), 10);
    assert_eq!(number(&trend, "/items/9/faults/kgm/forecast/quantiles/0.5"), median(&after));
    let both = json!({"parameter_set": "reference", "thresholds": {"kgm": 0.4, "fdj_n": 900.0}});
    let both = service.patch_json(&actuator, &both).await.expect(StatusCode::OK);
    assert_eq!(both.value("/thresholds"), json!({"kgm": 0.4, "fdj_n": 900.0}));
}

#[tokio::test]
async fn a_change_of_thresholds_that_cannot_be_made_is_refused_and_changes_nothing() {
    let (service, actuator, _) = one_actuator().await;
    let path = format!("/v1/actuators/{actuator}");
    let before = service.get(&path).await.json();
    let cases = [
        (json!({"thresholds": {"kgm": 0.009, "fdj_n": 2001.0}}), 422, &["/thresholds/kgm", "/thresholds/fdj_n"][..]),
        (json!({"parameter_set": "none", "thresholds": {"kgm": 2.0}}), 422, &["/parameter_set", "/thresholds/kgm"]),
        (json!({"thresholds": {"fdj_n": 209.9}, "parameter_set": "reference"}), 422, &["/thresholds/fdj_n"]),
        (json!({"thresholds": {"KGM": 0.3}}), 400, &["/thresholds/KGM"]),
        (json!({"thresholds": {"kgm": "0.3"}}), 400, &["/thresholds/kgm"]),
        (json!({"thresholds": 0.3}), 400, &["/thresholds"]),
        (json!({"thresholds": {}}), 400, &[""]),
        (json!({"thresholds": null, "parameter_set": null}), 400, &[""]),
        (json!({}), 400, &[""]),
    ];
    for (body, status, pointers) in cases {
        service.patch_json(&path, &body).await.expect_problem(status, pointers);
    }
    assert_eq!(service.get(&path).await.json(), before);
}
