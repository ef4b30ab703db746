use std::sync::Arc;

use elevon::store::alerts::{AlertFault, AlertKind};
use elevon::store::records::{Id, now};
use elevon::store::webhooks::{
    Attempt, Delivery, DeliveryState, DueDelivery, Event, Followed, Secret, WEBHOOKS_MAX, Webhook, WebhookChange,
};
use elevon::store::{Page, Records, StoreError};
use jiff::Timestamp;
use serde_json::Value;

use super::alerts::{alerts, changed, risk, threshold};
use super::samples::{all, at, measured, registered};

const URL: &str = "http://localhost/hook";

pub fn webhook(kinds: &[AlertKind]) -> Webhook {
    let (id, created_at) = (Id::now(), now());
    Webhook { id, url: URL.into(), kinds: kinds.to_vec(), enabled: true, disabled_because: None, created_at }
}

/// A kept webhook.
pub async fn hook(records: &dyn Records, kinds: &[AlertKind]) -> Id {
    let webhook = webhook(kinds);
    records.insert_webhook(&webhook, &Secret::new("0123456789abcdef")).await.unwrap();
    webhook.id
}

/// The deliveries of a webhook, newest first.
pub async fn deliveries(records: &dyn Records, webhook: Id) -> Vec<Delivery> {
    records.deliveries(webhook, &all()).await.unwrap().items
}

/// What a webhook was or will be told, newest first.
pub async fn told(records: &dyn Records, webhook: Id) -> Vec<Event> {
    deliveries(records, webhook).await.into_iter().map(|delivery| delivery.event).collect()
}

async fn due(records: &dyn Records, second: i64) -> Vec<DueDelivery> {
    records.due_deliveries(at(second)).await.unwrap()
}

fn attempt(second: i64, status: u16, followed: Followed) -> Attempt {
    let error = (!matches!(followed, Followed::Delivered)).then(|| format!("answered {status}"));
    Attempt { at: at(second), status: Some(status), error, followed }
}

async fn pinged(records: &dyn Records, webhook: Id, second: i64) -> Delivery {
    records.ping_webhook(webhook, at(second)).await.unwrap().unwrap()
}

pub async fn contract_a_webhook_comes_back_as_it_was_kept_and_as_it_was_changed(records: Arc<dyn Records>) {
    let mut expected = webhook(&[AlertKind::Risk]);
    records.insert_webhook(&expected, &Secret::new("0123456789abcdef")).await.unwrap();
    assert_eq!(records.webhook(expected.id).await.unwrap().as_ref(), Some(&expected));
    let unchanged = records.change_webhook(expected.id, &WebhookChange::default()).await.unwrap();
    assert_eq!(unchanged.as_ref(), Some(&expected));
    let change = WebhookChange {
        url: Some("https://example.com/".into()),
        secret: Some(Secret::new("fedcba9876543210")),
        kinds: Some(vec![AlertKind::Threshold]),
        enabled: Some(false),
    };
    (expected.url, expected.kinds, expected.enabled) =
        ("https://example.com/".into(), vec![AlertKind::Threshold], false);
    assert_eq!(records.change_webhook(expected.id, &change).await.unwrap().as_ref(), Some(&expected));
    assert_eq!(records.webhook(expected.id).await.unwrap().as_ref(), Some(&expected));
    assert_eq!(records.change_webhook(Id::now(), &change).await.unwrap(), None);
}

pub async fn contract_webhooks_are_listed_as_they_were_made_and_have_a_limit(records: Arc<dyn Records>) {
    let mut expected = Vec::new();
    for _ in 0..WEBHOOKS_MAX {
        expected.push(hook(&*records, &AlertKind::ALL).await);
    }
    let first = records.webhooks(&Page { after: None, limit: 30 }).await.unwrap();
    let rest = records.webhooks(&Page { after: first.next_cursor, limit: 30 }).await.unwrap();
    let found: Vec<_> = first.items.into_iter().chain(rest.items).map(|webhook| webhook.id).collect();
    assert_eq!((found, rest.next_cursor), (expected.clone(), None));
    let one_more = records.insert_webhook(&webhook(&AlertKind::ALL), &Secret::new("0123456789abcdef")).await;
    assert!(matches!(one_more, Err(StoreError::TooMany { what: "webhooks", limit: WEBHOOKS_MAX })), "{one_more:?}");
    assert!(records.delete_webhook(expected[0]).await.unwrap());
    hook(&*records, &AlertKind::ALL).await;
}

pub async fn contract_only_enabled_webhooks_of_its_kind_are_told_of_an_alert(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let trace = measured(&*records, actuator, 10, Some(0.41)).await;
    let risks = hook(&*records, &[AlertKind::Risk]).await;
    let both = hook(&*records, &AlertKind::ALL).await;
    let off = hook(&*records, &AlertKind::ALL).await;
    records.change_webhook(off, &WebhookChange { enabled: Some(false), ..Default::default() }).await.unwrap();
    changed(&*records, actuator, &[risk(20)]).await;
    changed(&*records, actuator, &[threshold(AlertFault::Kgm, trace, 30)]).await;
    let counts = [risks, both, off].map(async |webhook| deliveries(&*records, webhook).await.len());
    let [risks_told, both_told, off_told] = counts;
    assert_eq!((risks_told.await, both_told.await, off_told.await), (1, 2, 0));

    let delivery = deliveries(&*records, risks).await.remove(0);
    let alert = alerts(&*records).await.pop().unwrap();
    assert_eq!((delivery.event, delivery.alert_id), (Event::Raised, Some(alert.id)));
    assert_eq!((delivery.state, delivery.attempts, delivery.created_at), (DeliveryState::Pending, 0, at(20)));
    let sent = due(&*records, 20).await;
    assert_eq!((sent[0].id, &sent[0].url[..], sent[0].secret.reveal()), (delivery.id, URL, "0123456789abcdef"));
    let body: Value = serde_json::from_str(&sent[0].body).unwrap();
    assert_eq!(body["event"], "alert.raised");
    assert_eq!(body["delivery_id"], delivery.id.to_string());
    assert_eq!(body["created_at"], at(20).to_string());
    assert_eq!(body["alert"], serde_json::to_value(&alert).unwrap());
}

pub async fn contract_a_delivery_is_due_until_its_end_is_kept(records: Arc<dyn Records>) {
    let webhook = hook(&*records, &AlertKind::ALL).await;
    let id = pinged(&*records, webhook, 100).await.id;
    assert_eq!(due(&*records, 99).await, []);
    assert_eq!(due(&*records, 100).await[0].id, id);
    assert_eq!(due(&*records, 100).await[0].attempts, 0, "what was read and not recorded is read again");
    let retry = attempt(101, 500, Followed::Retry { at: at(110) });
    assert!(records.record_attempt(id, &retry).await.unwrap());
    assert_eq!(due(&*records, 109).await, []);
    assert_eq!(due(&*records, 110).await[0].attempts, 1);
    let waits = deliveries(&*records, webhook).await.remove(0);
    assert_eq!((waits.next_attempt_at, waits.last_status), (Some(at(110)), Some(500)));
    assert_eq!(waits.last_error.as_deref(), Some("answered 500"));
    assert!(records.record_attempt(id, &attempt(111, 204, Followed::Delivered)).await.unwrap());
    assert_eq!(due(&*records, 10_000).await, []);
    let over = deliveries(&*records, webhook).await.remove(0);
    assert_eq!((over.state, over.attempts, over.delivered_at), (DeliveryState::Delivered, 2, Some(at(111))));
    assert_eq!((over.next_attempt_at, over.last_status, over.last_error), (None, Some(204), None));
    assert!(!records.record_attempt(id, &retry).await.unwrap(), "it is over");
}

pub async fn contract_each_enabled_webhook_has_the_delivery_due_that_waited_longest(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (one, two) = (hook(&*records, &AlertKind::ALL).await, hook(&*records, &AlertKind::ALL).await);
    let ping = pinged(&*records, one, 300).await.id;
    changed(&*records, actuator, &[risk(200)]).await;
    let raised = deliveries(&*records, one).await.into_iter().find(|delivery| delivery.event == Event::Raised).unwrap();
    let found: Vec<_> = due(&*records, 400).await.into_iter().map(|due| (due.webhook_id, due.id)).collect();
    assert_eq!(found, [(one, raised.id), (two, deliveries(&*records, two).await[0].id)]);
    let retry = attempt(400, 500, Followed::Retry { at: at(500) });
    records.record_attempt(raised.id, &retry).await.unwrap();
    assert_eq!(due(&*records, 600).await[0].id, ping, "it has waited since 300");
    records.change_webhook(one, &WebhookChange { enabled: Some(false), ..Default::default() }).await.unwrap();
    assert_eq!(due(&*records, 600).await.len(), 1);
    records.change_webhook(one, &WebhookChange { enabled: Some(true), ..Default::default() }).await.unwrap();
    assert_eq!(due(&*records, 600).await.len(), 2, "what waits is sent once it is enabled again");
}

pub async fn contract_a_webhook_whose_receiver_is_gone_is_disabled_and_what_waits_is_given_up(
    records: Arc<dyn Records>,
) {
    let actuator = registered(&*records, "A").await.id;
    let webhook = hook(&*records, &AlertKind::ALL).await;
    let other = hook(&*records, &AlertKind::ALL).await;
    changed(&*records, actuator, &[risk(10)]).await;
    let ping = pinged(&*records, webhook, 20).await.id;
    let gone = |url: &str| attempt(30, 410, Followed::Gone { url: url.into() });
    records.record_attempt(ping, &gone("http://localhost/former")).await.unwrap();
    assert!(records.webhook(webhook).await.unwrap().unwrap().enabled, "another address said so");
    let ping = pinged(&*records, webhook, 40).await.id;
    assert!(records.record_attempt(ping, &gone(URL)).await.unwrap());
    let disabled = records.webhook(webhook).await.unwrap().unwrap();
    assert_eq!(
        (disabled.enabled, disabled.disabled_because.as_deref()),
        (false, Some("the receiver answered 410 Gone"))
    );
    let all = deliveries(&*records, webhook).await;
    assert!(all.len() == 3 && all.iter().all(|delivery| delivery.state == DeliveryState::Failed), "{all:?}");
    assert!(all.iter().all(|delivery| delivery.next_attempt_at.is_none() && delivery.last_error.is_some()));
    assert_eq!(deliveries(&*records, other).await[0].state, DeliveryState::Pending);
    let change = WebhookChange { enabled: Some(true), ..Default::default() };
    let enabled = records.change_webhook(webhook, &change).await.unwrap().unwrap();
    assert_eq!((enabled.enabled, enabled.disabled_because), (true, None));
}

pub async fn contract_one_ping_waits_at_a_time(records: Arc<dyn Records>) {
    let webhook = hook(&*records, &AlertKind::ALL).await;
    let first = pinged(&*records, webhook, 10).await;
    assert_eq!(pinged(&*records, webhook, 20).await, first);
    records.record_attempt(first.id, &attempt(30, 200, Followed::Delivered)).await.unwrap();
    assert_ne!(pinged(&*records, webhook, 40).await.id, first.id);
    assert_eq!(records.ping_webhook(Id::now(), at(50)).await.unwrap(), None);
}

pub async fn contract_a_webhook_that_is_deleted_takes_its_deliveries_along(records: Arc<dyn Records>) {
    let (one, two) = (hook(&*records, &AlertKind::ALL).await, hook(&*records, &AlertKind::ALL).await);
    let id = pinged(&*records, one, 10).await.id;
    pinged(&*records, two, 10).await;
    assert!(records.delete_webhook(one).await.unwrap());
    assert!(!records.delete_webhook(one).await.unwrap());
    assert_eq!(records.webhook(one).await.unwrap(), None);
    assert_eq!(deliveries(&*records, one).await, []);
    assert_eq!(due(&*records, 10).await.len(), 1);
    assert!(!records.record_attempt(id, &attempt(20, 200, Followed::Delivered)).await.unwrap());
}

pub async fn contract_old_deliveries_that_are_over_are_forgotten(records: Arc<dyn Records>) {
    let (one, two) = (hook(&*records, &AlertKind::ALL).await, hook(&*records, &AlertKind::ALL).await);
    let over = pinged(&*records, one, 10).await.id;
    records.record_attempt(over, &attempt(20, 500, Followed::GivenUp)).await.unwrap();
    pinged(&*records, two, 10).await;
    assert_eq!(records.forget_deliveries(at(10)).await.unwrap(), 0);
    assert_eq!(records.forget_deliveries(Timestamp::MAX).await.unwrap(), 1);
    assert_eq!(deliveries(&*records, one).await, []);
    assert_eq!(deliveries(&*records, two).await.len(), 1, "what waits is not forgotten");
}
