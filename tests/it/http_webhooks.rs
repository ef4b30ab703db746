//! Webhooks over HTTP: what is posted to a real receiver, how it is signed, and what happens when it is not taken.

use std::time::Duration;

use axum::http::StatusCode;
use elevon::config::Config;
use elevon::store::records::now;
use jiff::{SignedDuration, Timestamp};
use serde_json::{Value, json};
use tokio::time::timeout;

use super::http_alerts::{alert, growing, items, worn};
use super::http_support::{PATIENCE, PAUSE, Service};
use super::webhook_receiver::{Received, Receiver, from_base64};

const SECRET: &str = "0123456789abcdef";

/// Makes a webhook and returns its path.
async fn hook(service: &Service, receiver: &Receiver, kinds: &[&str]) -> String {
    let body = json!({"url": receiver.url, "secret": SECRET, "kinds": kinds});
    format!("/v1/webhooks/{}", service.post_json("/v1/webhooks", &body).await.expect(StatusCode::CREATED).text("/id"))
}

async fn deliveries(service: &Service, hook: &str) -> Vec<Value> {
    items(service, &format!("{hook}/deliveries")).await
}

async fn ping(service: &Service, hook: &str) -> Value {
    service.post(&format!("{hook}/test"), None, "").await.expect(StatusCode::ACCEPTED).value("/delivery")
}

/// Sends what is due now and returns how many were.
async fn send(service: &Service) -> usize {
    service.sender().send_due(now()).await
}

fn time(value: &Value) -> Timestamp {
    value.as_str().unwrap().parse().unwrap()
}

/// What a delivery's receiver is told, checked for its signature.
fn checked(received: &Received) -> Value {
    assert!(received.is_signed_with(SECRET.as_bytes()), "{received:?}");
    assert!(!received.is_signed_with(b"another secret.."));
    let sent_s: i64 = received.header("webhook-timestamp").parse().unwrap();
    assert!((now().as_second() - sent_s).abs() < 60);
    assert_eq!(received.header("content-type"), "application/json");
    assert!(received.header("user-agent").starts_with("elevon/"));
    let body = received.json();
    assert_eq!(body["delivery_id"], received.header("webhook-id"));
    body
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn every_change_of_an_alert_is_posted_signed_with_the_alert_as_it_was() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[]).await);
    let hook = hook(&service, &receiver, &["threshold"]).await;
    let actuator = worn(&service, "EHA-1", &growing()).await;
    let raised = alert(&service, "threshold").await;
    assert_eq!(send(&service).await, 1, "the risk's alert is not of its kinds");
    let path = format!("/v1/alerts/{}", raised["id"].as_str().unwrap());
    let acknowledgement = json!({"state": "acknowledged", "note": "seen"});
    let acknowledged = service.patch_json(&path, &acknowledgement).await.expect(StatusCode::OK).json();
    service.patch_json(&path, &acknowledgement).await.expect(StatusCode::OK);
    let event = json!({"kind": "overhauled", "at": "2026-03-20T12:00:00Z", "usage": 2000});
    service.post_json(&format!("/v1/actuators/{actuator}/maintenance"), &event).await.expect(StatusCode::CREATED);
    let cleared = service.get(&path).await.json();
    assert_eq!((send(&service).await, send(&service).await, send(&service).await), (1, 1, 0));
    let told: Vec<Value> = receiver.received().iter().map(checked).collect();
    let expected = [("alert.raised", raised), ("alert.acknowledged", acknowledged), ("alert.cleared", cleared)];
    assert_eq!(told.len(), 3);
    for (told, (event, alert)) in told.iter().zip(expected) {
        assert_eq!((&told["event"], &told["alert"]), (&json!(event), &alert));
        assert!(time(&told["created_at"]) <= now());
    }
    let kept = deliveries(&service, &hook).await;
    assert_eq!(kept.len(), 3);
    for (kept, told) in kept.iter().rev().zip(&told) {
        assert_eq!((&kept["id"], &kept["event"]), (&told["delivery_id"], &told["event"]));
        assert_eq!(
            (&kept["state"], &kept["attempts"], &kept["last_status"]),
            (&json!("delivered"), &json!(1), &json!(200))
        );
        assert_eq!((&kept["alert_id"], &kept["last_error"]), (&told["alert"]["id"], &Value::Null));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_receiver_that_fails_is_tried_again_after_growing_waits_with_the_same_body_and_id() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[500, 503, 204]).await);
    let hook = hook(&service, &receiver, &["risk"]).await;
    let id = ping(&service, &hook).await["id"].clone();
    let mut at = now();
    for (attempt, wait_s, status) in [(1, 5.0, 500), (2, 25.0, 503)] {
        let started = at;
        assert_eq!(service.sender().send_due(at).await, 1);
        let kept = deliveries(&service, &hook).await.remove(0);
        assert_eq!((&kept["state"], &kept["attempts"]), (&json!("pending"), &json!(attempt)));
        assert_eq!(
            (&kept["last_status"], kept["last_error"].as_str()),
            (&json!(status), Some(&*format!("the receiver answered {status}")))
        );
        let next = time(&kept["next_attempt_at"]);
        let waited = next.duration_since(started).as_secs_f64();
        assert!((0.75 * wait_s..wait_s + 30.0).contains(&waited), "{waited}");
        assert_eq!(service.sender().send_due(next - SignedDuration::from_millis(1)).await, 0);
        at = next;
    }
    assert_eq!(service.sender().send_due(at).await, 1);
    let kept = deliveries(&service, &hook).await.remove(0);
    assert_eq!(
        (&kept["state"], &kept["attempts"], &kept["last_status"]),
        (&json!("delivered"), &json!(3), &json!(204))
    );
    assert_eq!((&kept["next_attempt_at"], &kept["last_error"]), (&Value::Null, &Value::Null));
    let received = receiver.received();
    assert_eq!(received.len(), 3);
    for one in &received {
        let told = checked(one);
        assert_eq!((&told["delivery_id"], &told["event"], &told["alert"]), (&id, &json!("ping"), &Value::Null));
        assert_eq!(one.body, received[0].body);
    }
    assert_ne!(received[0].header("webhook-signature"), received[2].header("webhook-signature"), "the time is signed");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_receiver_that_does_not_answer_holds_up_neither_requests_nor_other_receivers() {
    let (service, slow, quick) = (Service::new().await, Receiver::slow(&[]).await, Receiver::answering(&[]).await);
    let (slow_hook, quick_hook) = (hook(&service, &slow, &["risk"]).await, hook(&service, &quick, &["risk"]).await);
    ping(&service, &slow_hook).await;
    ping(&service, &quick_hook).await;
    let sender = service.sender().clone();
    let sending = tokio::spawn(async move { sender.send_due(now()).await });
    slow.called().await;
    quick.called().await;
    let meanwhile = async {
        worn(&service, "EHA-1", &growing()).await;
        assert_eq!(items(&service, "/v1/alerts").await.len(), 2);
        while deliveries(&service, &quick_hook).await.iter().all(|delivery| delivery["state"] == "pending") {
            tokio::time::sleep(PAUSE).await;
        }
    };
    timeout(PATIENCE, meanwhile).await.unwrap();
    assert!(!sending.is_finished(), "the slow receiver has not answered yet");
    slow.let_go();
    assert_eq!(sending.await.unwrap(), 2);
    assert!(deliveries(&service, &slow_hook).await.iter().any(|delivery| delivery["state"] == "delivered"));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_answer_in_time_a_refused_connection_and_a_redirect_are_failures() {
    let service = Service::with(|config| config.webhooks.timeout_s = 0.2).await;
    let (slow, moved) = (Receiver::slow(&[]).await, Receiver::answering(&[302, 307]).await);
    let closed = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let refused = json!({"url": format!("http://{closed}/token-in-the-path"), "secret": SECRET});
    let refused = service.post_json("/v1/webhooks", &refused).await.expect(StatusCode::CREATED).text("/id");
    let hooks = [
        (hook(&service, &slow, &["risk"]).await, "no answer within 0.2 s", Value::Null),
        (
            hook(&service, &moved, &["risk"]).await,
            "the receiver answered 302, and redirects are not followed",
            json!(302),
        ),
        (format!("/v1/webhooks/{refused}"), "the connection failed", Value::Null),
    ];
    for (hook, ..) in &hooks {
        ping(&service, hook).await;
    }
    assert_eq!(send(&service).await, 3);
    for (hook, error, status) in &hooks {
        let kept = deliveries(&service, hook).await.remove(0);
        assert_eq!((&kept["state"], &kept["last_status"]), (&json!("pending"), status), "{kept}");
        let found = kept["last_error"].as_str().unwrap();
        assert!(found.starts_with(error) && !found.contains("token-in-the-path"), "{found}");
    }
    assert!(moved.received().iter().all(|received| received.path == "/hook"), "nothing went elsewhere");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_delivery_is_given_up_after_its_attempts_or_its_age_and_listed_as_failed() {
    for change in
        [|config: &mut Config| config.webhooks.attempts_max = 2, |config: &mut Config| config.webhooks.age_max_s = 20.0]
    {
        let (service, receiver) = (Service::with(change).await, Receiver::answering(&[500; 9]).await);
        let hook = hook(&service, &receiver, &["risk"]).await;
        ping(&service, &hook).await;
        let later = now() + SignedDuration::from_secs(6);
        assert_eq!(send(&service).await, 1);
        assert_eq!(deliveries(&service, &hook).await[0]["state"], "pending");
        assert_eq!(service.sender().send_due(later).await, 1);
        let kept = deliveries(&service, &hook).await.remove(0);
        assert_eq!(
            (&kept["state"], &kept["attempts"], &kept["next_attempt_at"]),
            (&json!("failed"), &json!(2), &Value::Null)
        );
        assert_eq!(service.sender().send_due(later + SignedDuration::from_hours(99)).await, 0);
        assert_eq!(service.get(&hook).await.value("/enabled"), json!(true));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_receiver_that_is_gone_disables_its_webhook() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[410]).await);
    let hook = hook(&service, &receiver, &["threshold", "risk"]).await;
    ping(&service, &hook).await;
    assert_eq!(send(&service).await, 1);
    let kept = service.get(&hook).await.json();
    assert_eq!(
        (&kept["enabled"], &kept["disabled_because"]),
        (&json!(false), &json!("the receiver answered 410 Gone"))
    );
    assert_eq!(deliveries(&service, &hook).await[0]["state"], "failed");
    service.post(&format!("{hook}/test"), None, "").await.expect_problem(409, &[]);
    worn(&service, "EHA-1", &growing()).await;
    assert_eq!((send(&service).await, deliveries(&service, &hook).await.len()), (0, 1));
    let enabled = service.patch_json(&hook, &json!({"enabled": true})).await.expect(StatusCode::OK);
    assert_eq!((enabled.value("/enabled"), enabled.value("/disabled_because")), (json!(true), Value::Null));
    ping(&service, &hook).await;
    assert_eq!((send(&service).await, receiver.received().len()), (1, 2));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_waits_is_sent_after_a_restart_by_the_task_of_the_service() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[500]).await);
    let hook = hook(&service, &receiver, &["threshold"]).await;
    worn(&service, "EHA-1", &growing()).await;
    assert_eq!(send(&service).await, 1);
    let service = service.restarted_with(|config| config.webhooks.poll_s = 0.01).await;
    let query = sqlx::query("UPDATE deliveries SET next_attempt_at = 0");
    query.execute(&service.database().await).await.unwrap();
    service.sender().start();
    let delivered = async {
        while deliveries(&service, &hook).await[0]["state"] != "delivered" {
            tokio::time::sleep(PAUSE).await;
        }
        ping(&service, &hook).await;
        while receiver.received().len() < 3 {
            tokio::time::sleep(PAUSE).await;
        }
    };
    timeout(PATIENCE, delivered).await.unwrap();
    service.sender().stop().await;
    let received = receiver.received();
    assert_eq!(received[0].header("webhook-id"), received[1].header("webhook-id"));
    assert_eq!(received[0].body, received[1].body);
    assert_eq!((checked(&received[1])["event"].clone(), received.len()), (json!("alert.raised"), 3));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_does_not_wait_for_a_receiver_that_does_not_answer() {
    let (service, receiver) = (Service::new().await, Receiver::slow(&[]).await);
    let hook = hook(&service, &receiver, &["risk"]).await;
    ping(&service, &hook).await;
    service.sender().start();
    receiver.called().await;
    timeout(Duration::from_secs(5), service.sender().stop()).await.unwrap();
    assert_eq!(deliveries(&service, &hook).await[0]["state"], "pending", "it is sent again after the next start");
    receiver.let_go();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_secret_is_shown_once_if_the_service_made_it_and_signs_as_the_standard_says() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[]).await);
    let made = service.post_json("/v1/webhooks", &json!({"url": receiver.url})).await.expect(StatusCode::CREATED);
    let hook = format!("/v1/webhooks/{}", made.text("/id"));
    assert_eq!(made.header("location"), hook);
    assert_eq!((made.value("/kinds"), made.value("/enabled")), (json!(["threshold", "risk"]), json!(true)));
    let secret = made.text("/secret");
    let key = from_base64(secret.strip_prefix("whsec_").unwrap());
    assert_eq!(key.len(), 32);
    ping(&service, &hook).await;
    send(&service).await;
    assert!(receiver.received()[0].is_signed_with(&key));

    let mine = json!({"url": receiver.url, "secret": SECRET});
    let mine = service.post_json("/v1/webhooks", &mine).await.expect(StatusCode::CREATED);
    assert_eq!(mine.value("/secret"), Value::Null);
    let change = json!({"secret": "another secret..".replace(' ', "-")});
    let changed = service.patch_json(&hook, &change).await.expect(StatusCode::OK);
    ping(&service, &hook).await;
    send(&service).await;
    assert!(receiver.received()[1].is_signed_with(b"another-secret.."));
    let answers = [changed, service.get(&hook).await, service.get("/v1/webhooks").await, mine];
    for answer in answers {
        let text = String::from_utf8(answer.body.to_vec()).unwrap();
        assert!([&secret, SECRET, "another-secret"].iter().all(|secret| !text.contains(*secret)), "{text}");
    }
    for delivery in deliveries(&service, &hook).await {
        assert!(!delivery.to_string().contains("secret"), "{delivery}");
    }
}

#[tokio::test]
async fn webhooks_are_listed_changed_and_deleted() {
    let (service, receiver) = (Service::new().await, Receiver::answering(&[]).await);
    let (one, two) =
        (hook(&service, &receiver, &["risk", "risk"]).await, hook(&service, &receiver, &["threshold"]).await);
    let first = service.get(&one).await.expect(StatusCode::OK).json();
    let names: Vec<_> = first.as_object().unwrap().keys().collect();
    assert_eq!(names, ["created_at", "disabled_because", "enabled", "id", "kinds", "url"]);
    assert_eq!((&first["kinds"], &first["url"]), (&json!(["risk"]), &json!(receiver.url)));
    let page = service.get("/v1/webhooks?limit=1").await.json();
    assert_eq!(page["items"], json!([first]));
    let rest = items(&service, &format!("/v1/webhooks?cursor={}", page["next_cursor"].as_str().unwrap())).await;
    assert_eq!(rest, [service.get(&two).await.json()]);
    let waiting = ping(&service, &one).await;
    assert_eq!(ping(&service, &one).await, waiting, "while one waits, no second is queued");
    let change = json!({"url": "https://example.com", "enabled": false, "kinds": ["threshold"]});
    let changed = service.patch_json(&one, &change).await.expect(StatusCode::OK).json();
    assert_eq!((&changed["url"], &changed["enabled"]), (&json!("https://example.com/"), &json!(false)));
    assert_eq!(changed["kinds"], json!(["threshold"]));
    assert_eq!(service.patch_json(&one, &json!({})).await.expect(StatusCode::OK).json(), changed);
    assert_eq!(send(&service).await, 0, "what waits for a disabled webhook is not sent");
    service.delete(&one).await.expect(StatusCode::NO_CONTENT);
    service.delete(&one).await.expect_problem(404, &[]);
    service.get(&one).await.expect_problem(404, &[]);
    service.get(&format!("{one}/deliveries")).await.expect_problem(404, &[]);
    service.patch_json(&one, &change).await.expect_problem(404, &[]);
    service.post(&format!("{one}/test"), None, "").await.expect_problem(404, &[]);
    assert_eq!(items(&service, "/v1/webhooks").await.len(), 1);
}

#[tokio::test]
async fn a_webhook_that_is_none_is_refused_by_its_fields_and_its_secret_is_not_repeated() {
    let service = Service::new().await;
    let good = "http://localhost/";
    let cases = [
        (json!({}), 400, vec![""]),
        (json!({"url": 7}), 400, vec!["/url"]),
        (json!({"url": good, "colour": "red"}), 400, vec!["/colour"]),
        (json!({"url": good, "kinds": ["smoke"]}), 400, vec!["/kinds/0"]),
        (json!({"url": good, "kinds": "risk"}), 400, vec!["/kinds"]),
        (json!({"url": good, "kinds": []}), 422, vec!["/kinds"]),
        (json!({"url": good, "enabled": "yes"}), 400, vec!["/enabled"]),
        (json!({"url": "ftp://localhost/"}), 422, vec!["/url"]),
        (json!({"url": "http://me:tooshort@localhost/"}), 422, vec!["/url"]),
        (json!({"url": format!("{good}{}", "x".repeat(2048))}), 422, vec!["/url"]),
        (json!({"url": "", "secret": "tooshort", "kinds": []}), 422, vec!["/url", "/secret", "/kinds"]),
        (json!({"url": good, "secret": "tooshort".repeat(33)}), 422, vec!["/secret"]),
        (json!({"url": good, "secret": {"tooshort": 1}}), 400, vec!["/secret"]),
        (json!([good]), 400, vec![""]),
    ];
    let kept = service.post_json("/v1/webhooks", &json!({"url": good})).await.expect(StatusCode::CREATED).text("/id");
    for (body, status, pointers) in &cases {
        let refused = service.post_json("/v1/webhooks", body).await.expect_problem(*status, pointers);
        assert!(!String::from_utf8_lossy(&refused.body).contains("tooshort"), "{body}");
        if body.as_object().is_some_and(|body| !body.is_empty()) {
            service.patch_json(&format!("/v1/webhooks/{kept}"), body).await.expect_problem(*status, pointers);
        }
    }
    service.post("/v1/webhooks", Some("text/plain"), "x").await.expect_problem(415, &[]);
    assert_eq!(items(&service, "/v1/webhooks").await.len(), 1);
}
