//! Parameter sets over HTTP: kept, listed, read, and named by actuators and simulations.

use axum::body::Body;
use axum::http::header::ACCEPT;
use axum::http::{Method, StatusCode};
use elevon::models::parameters::ParameterSet;
use serde_json::{Value, json};

use super::http_support::{Answer, RECORDED, Service, request, still_csv};

const PATH: &str = "/v1/parameter-sets";

/// A good body: the built-in set's values under another name, with a jack of this mass.
fn body(name: &str, jack_mass_kg: f64) -> Value {
    let mut parameters = ParameterSet::reference().to_json();
    parameters["jack"]["mass_kg"] = json!(jack_mass_kg);
    json!({"name": name, "parameters": parameters})
}

/// A file of the same.
fn file(name: &str, jack_mass_kg: f64) -> String {
    ParameterSet::from_json(name, &body(name, jack_mass_kg)["parameters"]).unwrap().to_toml()
}

/// Keeps a set; its hash.
async fn kept(service: &Service, name: &str, jack_mass_kg: f64) -> String {
    service.post_json(PATH, &body(name, jack_mass_kg)).await.expect(StatusCode::CREATED).text("/hash")
}

async fn registered(service: &Service, serial_number: &str, parameter_set: &str) -> Answer {
    let body = json!({"serial_number": serial_number, "tail_number": "I-ELVN", "location": "left aileron",
        "parameter_set": parameter_set});
    service.post_json("/v1/actuators", &body).await
}

fn simulation(parameter_set: Value) -> Value {
    json!({"model": "monitoring", "parameter_set": parameter_set, "command": "step:0.1", "duration_s": 0.1,
        "sample_rate_hz": 1000.0})
}

async fn as_toml(service: &Service, path: &str) -> Answer {
    let mut request = request(Method::GET, path, None, Body::empty());
    request.headers_mut().insert(ACCEPT, "application/toml".parse().unwrap());
    service.send(request).await
}

#[tokio::test]
async fn the_built_in_set_is_there_from_the_start() {
    let service = Service::new().await;
    let list = service.get(PATH).await.expect(StatusCode::OK);
    assert_eq!(list.value("/items").as_array().unwrap().len(), 1);
    let reference = ParameterSet::reference();
    assert_eq!(list.text("/items/0/name"), "reference");
    assert_eq!(list.text("/items/0/hash"), reference.hash());
    assert_eq!(list.value("/items/0/built_in"), true);
    assert!(!list.text("/items/0/id").is_empty() && !list.text("/items/0/created_at").is_empty());
    let found = service.get("/v1/parameter-sets/reference").await.expect(StatusCode::OK);
    assert_eq!(found.text("/id"), list.text("/items/0/id"));
    assert_eq!(found.value("/parameters"), reference.to_json());
    assert_eq!(found.value("/errors"), json!([]));
}

#[tokio::test]
async fn a_set_is_kept_and_found_at_its_location_with_every_parameter_and_range() {
    let service = Service::new().await;
    let body = body("mine", 9.5);
    let answer = service.post_json(PATH, &body).await.expect(StatusCode::CREATED);
    assert_eq!((answer.text("/name"), answer.value("/built_in")), ("mine".into(), json!(false)));
    let found = service.get(answer.header("location")).await.expect(StatusCode::OK);
    assert_eq!((found.text("/id"), found.text("/hash")), (answer.text("/id"), answer.text("/hash")));
    assert_eq!(found.value("/parameters"), body["parameters"]);
    let limits = found.value("/limits");
    let mass =
        json!({"pointer": "/parameters/jack/mass_kg", "min": 0.01, "max": 10000.0, "unit": "kg", "models": "both"});
    assert!(limits.as_array().unwrap().contains(&mass), "{limits:#}");
    for limit in limits.as_array().unwrap() {
        let value = found.value(limit["pointer"].as_str().unwrap()).as_f64().unwrap();
        let (min, max) = (limit["min"].as_f64().unwrap(), limit["max"].as_f64().unwrap());
        assert!((min..=max).contains(&value), "{limit}");
    }
}

#[tokio::test]
async fn a_file_is_the_same_set_and_comes_back_as_a_file() {
    let service = Service::new().await;
    let hash = kept(&service, "mine", 9.5).await;
    let again = service.post(PATH, Some("application/toml"), file("mine", 9.5)).await.expect(StatusCode::OK);
    assert_eq!(again.text("/hash"), hash);
    let new = service.post(PATH, Some("application/toml"), file("other", 9.5)).await.expect(StatusCode::CREATED);
    let answer = as_toml(&service, new.header("location")).await.expect(StatusCode::OK);
    assert_eq!(answer.header("content-type"), "application/toml");
    let read = ParameterSet::parse(std::str::from_utf8(&answer.body).unwrap()).unwrap();
    assert_eq!((read.name(), read.hash()), ("other", new.text("/hash").as_str()));
    let reference = as_toml(&service, "/v1/parameter-sets/reference").await.expect(StatusCode::OK);
    assert_eq!(reference.body, include_str!("../../config/actuators/reference.toml").as_bytes());
}

#[tokio::test]
async fn the_same_set_again_is_the_same_record_and_other_values_are_a_new_version() {
    let service = Service::new().await;
    let first = service.post_json(PATH, &body("mine", 9.5)).await.expect(StatusCode::CREATED);
    let second = service.post_json(PATH, &body("mine", 9.6)).await.expect(StatusCode::CREATED);
    let again = service.post_json(PATH, &body("mine", 9.5)).await.expect(StatusCode::OK);
    assert_eq!((again.json(), again.header("location")), (first.json(), first.header("location")));
    assert_eq!(service.get("/v1/parameter-sets/mine").await.text("/hash"), second.text("/hash"));
    let (older, newer) = (first.text("/hash"), second.text("/hash"));
    for (hash, mass_kg) in [(&older, 9.5), (&newer, 9.6)] {
        for path in [format!("mine?hash={hash}"), format!("mine?hash={}", &hash[..8]), format!("mine@{}", &hash[..8])] {
            let found = service.get(&format!("{PATH}/{path}")).await.expect(StatusCode::OK);
            assert_eq!(found.value("/parameters/jack/mass_kg"), mass_kg, "{path}");
        }
    }
    let names = async |path: &str| service.get(path).await.expect(StatusCode::OK);
    let page = names(&format!("{PATH}?limit=2")).await;
    assert_eq!([page.text("/items/0/name"), page.text("/items/1/hash")], ["reference".to_owned(), older]);
    let rest = names(&format!("{PATH}?limit=2&cursor={}", page.text("/next_cursor"))).await;
    assert_eq!((rest.text("/items/0/hash"), rest.value("/next_cursor")), (newer, Value::Null));
}

#[tokio::test]
async fn every_value_out_of_range_is_told_at_once_by_its_pointer() {
    let service = Service::new().await;
    let mut bad = body("a b", -1.0);
    bad["parameters"]["jack"]["area_m2"] = json!(0);
    bad["parameters"]["monitoring"]["bias"]["current_ratio"] = json!(1e9);
    let pointers =
        ["/name", "/parameters/jack/area_m2", "/parameters/jack/mass_kg", "/parameters/monitoring/bias/current_ratio"];
    let answer = service.post_json(PATH, &bad).await.expect_problem(422, &pointers);
    assert_eq!(answer.text("/errors/1/detail"), "found 0, expected 1e-6 to 1 m2");
    let text = file("mine", 9.5).replace("mass_kg = 9.5", "mass_kg = nan").replace("\"mine\"", "\"m/ne\"");
    let answer = service.post(PATH, Some("application/toml"), text).await;
    answer.expect_problem(422, &["/name", "/jack/mass_kg"]);
    assert_eq!(service.get(PATH).await.value("/items").as_array().unwrap().len(), 1, "nothing is kept");
}

#[tokio::test]
async fn what_cannot_be_read_is_malformed_with_everything_else_that_is_wrong() {
    let service = Service::new().await;
    let mut bad = body("mine", -1.0);
    bad["colour"] = json!("red");
    bad["name"] = json!(7);
    bad["parameters"]["jack"]["area_m2"] = json!([8e-4]);
    bad["parameters"]["jack"]["a/b"] = json!(1);
    bad["parameters"]["reference"]["oil"].as_object_mut().unwrap().remove("temperature_k").unwrap();
    let pointers = [
        "/colour",
        "/name",
        "/parameters/jack/a~1b",
        "/parameters/jack/area_m2",
        "/parameters/jack/mass_kg",
        "/parameters/reference/oil/temperature_k",
    ];
    let mut answer = service.post_json(PATH, &bad).await;
    let mut problem = answer.json();
    // The two fields beside the parameters come in the order of the body.
    problem["errors"].as_array_mut().unwrap()[..2].sort_by_key(|error| error["pointer"].to_string());
    answer.body = problem.to_string().into();
    answer.expect_problem(400, &pointers);
    let missing = service.post_json(PATH, &json!({})).await.expect_problem(400, &["/name", "/parameters"]);
    assert!(missing.text("/errors/0/detail").starts_with("missing"));
    service.post_json(PATH, &json!([])).await.expect_problem(400, &[""]);
    service.post_json(PATH, &json!({"name": "mine", "parameters": []})).await.expect_problem(400, &["/parameters"]);
    let named = json!({"name": "mine", "parameters": {"name": "mine"}});
    service.post_json(PATH, &named).await.expect_problem(400, &["/parameters/name"]);
    service.post(PATH, Some("application/json"), "{\"name\": ").await.expect_problem(400, &["/name"]);
    service
        .post(PATH, Some("application/toml"), "name = \"x\"\n[jack\n")
        .await
        .expect_problem(400, &["line 2, column 6"]);
    service.post(PATH, Some("application/toml"), &b"name = \"\xff\""[..]).await.expect_problem(400, &[""]);
    service.post(PATH, Some("text/csv"), "x").await.expect_problem(415, &[]);
    service.post(PATH, Some("application/toml"), "#".repeat(1_000_001)).await.expect_problem(413, &[]);
    service.post_json(&format!("{PATH}?name=mine"), &body("mine", 9.5)).await.expect_problem(400, &["?name"]);
}

#[tokio::test]
async fn the_built_in_set_s_name_is_reserved() {
    let service = Service::new().await;
    service.post_json(PATH, &body("reference", 9.5)).await.expect_problem(409, &["/name"]);
    service.post_json(PATH, &body("reference", 10.0)).await.expect_problem(409, &["/name"]);
    kept(&service, "Reference", 10.0).await;
}

#[tokio::test]
async fn a_set_that_is_not_there_is_not_found_and_a_bad_hash_is_named() {
    let service = Service::new().await;
    let hash = kept(&service, "mine", 9.5).await;
    for path in ["none", "MINE", "mine?hash=0000000000", &format!("reference?hash={hash}"), "a%20b", "mine@xyz", "%FF"]
    {
        let refused = service.get(&format!("{PATH}/{path}")).await.expect_problem(404, &[]);
        let detail = refused.text("/detail");
        assert!(path == "%FF" || detail.starts_with("no parameter set is named "), "{detail}");
    }
    for hash in ["", "0123456", "ABCDEF01", &"0".repeat(65)] {
        service.get(&format!("{PATH}/mine?hash={hash}")).await.expect_problem(400, &["?hash"]);
    }
    service.get(&format!("{PATH}/mine?version=1")).await.expect_problem(400, &["?version"]);
}

#[tokio::test]
async fn a_hash_that_means_two_versions_is_refused_where_it_stands() {
    let service = Service::new().await;
    let digits = |end: &str| format!("{}{end}", "0".repeat(63));
    for end in ["1", "2"] {
        let kept = "INSERT INTO parameter_sets VALUES (?1, 'twin', ?2, '{}', 0)";
        let id = format!("00000000-0000-7000-8000-00000000000{end}");
        sqlx::query(kept).bind(id).bind(digits(end)).execute(&service.database().await).await.unwrap();
    }
    service.get(&format!("{PATH}/twin?hash=00000000")).await.expect_problem(422, &["?hash"]);
    registered(&service, "A", "twin@00000000").await.expect_problem(422, &["/parameter_set"]);
    service.get(&format!("{PATH}/twin?hash={}", digits("2"))).await.expect(StatusCode::OK);
}

#[tokio::test]
async fn an_actuator_is_pinned_to_the_version_that_it_was_registered_with() {
    let service = Service::new().await;
    let older = kept(&service, "mine", 9.5).await;
    let before = registered(&service, "A", "mine").await.expect(StatusCode::CREATED);
    let newer = kept(&service, "mine", 9.6).await;
    let after = registered(&service, "B", " mine ").await.expect(StatusCode::CREATED);
    let chosen = registered(&service, "C", &format!("mine@{}", &older[..8])).await.expect(StatusCode::CREATED);
    let default = service.registered("D").await;
    for (answer, hash) in [(before, &older), (after, &newer), (chosen, &older)] {
        let found = service.get(answer.header("location")).await;
        assert_eq!(found.json(), answer.json());
        assert_eq!((found.text("/parameter_set"), &found.text("/parameter_set_hash")), ("mine".into(), hash));
        let uploads = format!("{}/traces?{RECORDED}", answer.header("location"));
        let job =
            service.post(&uploads, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED).text("/job/id");
        service.work().await;
        let done = service.get(&format!("/v1/jobs/{job}")).await;
        assert_eq!(&done.text("/result/parameter_set_hash"), hash);
    }
    let default = service.get(&format!("/v1/actuators/{default}")).await;
    assert_eq!(default.text("/parameter_set_hash"), ParameterSet::reference().hash());
}

#[tokio::test]
async fn an_actuator_or_a_simulation_of_an_unknown_or_unusable_set_is_refused_with_its_other_errors() {
    let service = Service::new().await;
    let old =
        "INSERT INTO parameter_sets VALUES ('00000000-0000-7000-8000-000000000001', 'old', ?1, '{\"jack\": {}}', 0)";
    sqlx::query(old).bind("a".repeat(64)).execute(&service.database().await).await.unwrap();
    for (name, says) in [
        ("none", "found \"none\", expected reference or a set that the service keeps"),
        ("a b", "expected NAME or NAME@HASH"),
        ("reference@123", "expected NAME or NAME@HASH"),
        ("reference@00000000", "expected a set and the hash of a version of it that the service keeps"),
        ("old", "jack.area_m2: missing"),
    ] {
        let refused =
            registered(&service, "\u{7}", name).await.expect_problem(422, &["/serial_number", "/parameter_set"]);
        assert!(refused.text("/errors/1/detail").contains(says), "{}", refused.text("/errors/1/detail"));
        let mut simulation = simulation(json!(name));
        simulation["duration_s"] = json!(-1);
        let refused = service.post_json("/v1/simulations", &simulation).await;
        let errors = refused.json()["errors"].as_array().unwrap().clone();
        assert!(errors.iter().any(|error| error["pointer"] == "/duration_s"), "{errors:?}");
        let of_set = errors.iter().find(|error| error["pointer"] == "/parameter_set").unwrap();
        assert!(of_set["detail"].as_str().unwrap().contains(says), "{of_set}");
    }
    registered(&service, "A", "reference@").await.expect_problem(422, &["/parameter_set"]);
    let old = service.get(&format!("{PATH}/old")).await.expect(StatusCode::OK);
    assert_eq!(old.value("/parameters"), json!({"jack": {}}));
    let errors = old.value("/errors").as_array().unwrap().clone();
    assert!(errors.iter().any(|error| error["pointer"] == "/parameters/jack/area_m2"), "{errors:?}");
    as_toml(&service, &format!("{PATH}/old")).await.expect_problem(406, &[]);
}

#[tokio::test]
async fn an_earlier_built_in_set_is_known_by_its_hash_and_no_actuator_s() {
    let service = Service::new().await;
    let earlier = ParameterSet::from_json("reference", &body("reference", 9.5)["parameters"]).unwrap();
    let keep = "INSERT INTO parameter_sets VALUES ('00000000-0000-7000-8000-000000000001', 'reference', ?1, ?2, 0)";
    sqlx::query(keep)
        .bind(earlier.hash())
        .bind(earlier.to_json().to_string())
        .execute(&service.database().await)
        .await
        .unwrap();
    let named = format!("reference@{}", earlier.hash());
    assert_eq!(service.get(&format!("{PATH}/reference")).await.text("/hash"), ParameterSet::reference().hash());
    assert_eq!(service.get(&format!("{PATH}/{named}")).await.value("/parameters/jack/mass_kg"), 9.5);
    service.post_json("/v1/simulations", &simulation(json!(named))).await.expect(StatusCode::ACCEPTED);
    let refused = registered(&service, "A", &named).await.expect_problem(422, &["/parameter_set"]);
    assert!(refused.text("/errors/0/detail").ends_with("expected reference alone"));
    let same = format!("reference@{}", &ParameterSet::reference().hash()[..8]);
    registered(&service, "A", &same).await.expect(StatusCode::CREATED);
}

#[tokio::test]
async fn a_simulation_is_pinned_to_its_version_when_it_is_accepted() {
    let service = Service::new().await;
    let older = kept(&service, "mine", 9.5).await;
    let mut jobs = Vec::new();
    for name in [json!("mine"), json!(null), json!("reference")] {
        let accepted = service.post_json("/v1/simulations", &simulation(name)).await.expect(StatusCode::ACCEPTED);
        jobs.push(accepted.text("/job/id"));
    }
    kept(&service, "mine", 9.6).await;
    service.work().await;
    let reference = ParameterSet::reference();
    for (job, (name, hash)) in
        jobs.iter().zip([("mine", older.as_str()), ("reference", reference.hash()), ("reference", reference.hash())])
    {
        let done = service.get(&format!("/v1/jobs/{job}")).await;
        assert_eq!(done.text("/result/parameter_set"), name);
        assert_eq!(done.text("/result/parameter_set_hash"), hash);
        service.get(&format!("/v1/traces/{}", done.text("/result/trace_id"))).await.expect(StatusCode::OK);
    }
}

#[tokio::test]
async fn sets_and_what_is_pinned_to_them_are_there_after_a_restart() {
    let service = Service::new().await;
    let older = kept(&service, "mine", 9.5).await;
    let actuator = registered(&service, "A", "mine").await.expect(StatusCode::CREATED);
    kept(&service, "mine", 9.6).await;
    let paths = [PATH, actuator.header("location"), &format!("{PATH}/mine"), &format!("{PATH}/mine@{older}")];
    let mut before = Vec::new();
    for path in paths {
        before.push(service.get(path).await.expect(StatusCode::OK).json());
    }
    let service = service.restarted().await;
    for (path, before) in paths.into_iter().zip(before) {
        assert_eq!(service.get(path).await.expect(StatusCode::OK).json(), before, "{path}");
    }
    let uploads = format!("{}/traces?{RECORDED}", actuator.header("location"));
    service.post(&uploads, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
    service.work().await;
    assert_eq!(service.get("/v1/jobs").await.text("/items/0/result/parameter_set_hash"), older);
}

#[tokio::test]
async fn an_actuator_is_moved_to_another_version_and_estimated_with_it_from_then_on() {
    let service = Service::new().await;
    let older = kept(&service, "mine", 9.5).await;
    let actuator = registered(&service, "A", "mine").await.expect(StatusCode::CREATED);
    let newer = kept(&service, "mine", 9.6).await;
    let path = actuator.header("location");
    let estimated = async || {
        let uploads = format!("{path}/traces?{RECORDED}");
        service.post(&uploads, Some("text/csv"), still_csv()).await.expect(StatusCode::ACCEPTED);
        service.work().await;
        service.get("/v1/jobs").await.text("/items/0/result/parameter_set_hash")
    };
    assert_eq!(estimated().await, older);
    let moved = service.patch_json(path, &json!({"parameter_set": "mine"})).await.expect(StatusCode::OK);
    let mut expected = actuator.json();
    expected["parameter_set_hash"] = json!(newer);
    assert_eq!((moved.json(), service.get(path).await.json()), (expected.clone(), expected));
    assert_eq!(estimated().await, newer);
    for (body, status, pointer) in [
        (json!({"parameter_set": "none"}), 422, "/parameter_set"),
        (json!({"parameter_set": 7}), 400, "/parameter_set"),
        (json!({"parameter_set": "mine", "serial_number": "B"}), 400, "/serial_number"),
        (json!({}), 400, ""),
    ] {
        service.patch_json(path, &body).await.expect_problem(status, &[pointer]);
    }
    service.patch_json("/v1/actuators/7", &json!({"parameter_set": "mine"})).await.expect_problem(404, &[]);
    assert_eq!(service.get(path).await.text("/parameter_set_hash"), newer);
}
