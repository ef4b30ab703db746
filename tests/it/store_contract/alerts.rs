use std::sync::Arc;

use elevon::store::alerts::{Alert, AlertChange, AlertFault, AlertKind, AlertState, Cause, ClearedBecause, NewAlert};
use elevon::store::records::{Id, MaintenanceKind, UsageUnit, now};
use elevon::store::webhooks::Event;
use elevon::store::{Page, Records, StoreError, WithForecast};

use super::samples::{all, at, forecast, maintained, measured, registered};
use super::webhooks::{deliveries, hook, told};

/// The change that raises an alert of a risk.
pub fn risk(second: i64) -> AlertChange {
    raise(Cause::Risk { risk: 0.25, limit: 0.1, within: 100.0, trace_id: None }, second)
}

/// The change that raises an alert of a fault's threshold.
pub fn threshold(fault: AlertFault, trace_id: Id, second: i64) -> AlertChange {
    raise(Cause::Threshold { fault, value: 0.41, value_std: Some(0.01), threshold: 0.4, trace_id }, second)
}

fn raise(cause: Cause, second: i64) -> AlertChange {
    let message = "it is so".to_owned();
    AlertChange::Raise(Box::new(NewAlert { id: Id::now(), cause, usage: 12.5, message, raised_at: at(second) }))
}

pub fn clear(id: Id, second: i64) -> AlertChange {
    AlertChange::Clear { id, because: ClearedBecause::RiskFell, at: at(second) }
}

fn with(alerts: &[AlertChange]) -> WithForecast<'_> {
    WithForecast { alerts, ..WithForecast::default() }
}

/// Keeps a forecast of the actuator's newest revision with changes of its alerts.
pub async fn changed(records: &dyn Records, actuator: Id, changes: &[AlertChange]) {
    let revision = records.actuator(actuator).await.unwrap().unwrap().revision;
    assert!(records.store_forecast_with(&forecast(actuator, revision, None, None), &with(changes)).await.unwrap());
}

/// Every alert, newest first.
pub async fn alerts(records: &dyn Records) -> Vec<Alert> {
    records.alerts(None, None, &all()).await.unwrap().items
}

pub async fn contract_an_alert_comes_back_as_it_was_raised(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await;
    let trace = measured(&*records, actuator.id, 10, Some(0.41)).await;
    changed(&*records, actuator.id, &[threshold(AlertFault::Kgm, trace, 20)]).await;
    let alert = alerts(&*records).await.remove(0);
    let expected = Alert {
        id: alert.id,
        actuator_id: actuator.id,
        serial_number: "A".into(),
        tail_number: "I-ABCD".into(),
        kind: AlertKind::Threshold,
        fault: Some(AlertFault::Kgm),
        state: AlertState::Open,
        raised_at: at(20),
        acknowledged_at: None,
        cleared_at: None,
        cleared_because: None,
        usage: 12.5,
        usage_unit: UsageUnit::FlightHours,
        value: Some(0.41),
        value_std: Some(0.01),
        threshold: Some(0.4),
        risk: None,
        limit: None,
        within: None,
        trace_id: Some(trace),
        note: String::new(),
        message: "it is so".into(),
    };
    assert_eq!(alert, expected);
    assert_eq!(records.alert(alert.id).await.unwrap(), Some(expected));
    assert_eq!(records.alert(Id::now()).await.unwrap(), None);
    changed(&*records, actuator.id, &[risk(30)]).await;
    let alert = alerts(&*records).await.remove(0);
    assert_eq!((alert.kind, alert.fault, alert.value), (AlertKind::Risk, None, None));
    assert_eq!((alert.risk, alert.limit, alert.within), (Some(0.25), Some(0.1), Some(100.0)));
}

pub async fn contract_an_alert_that_is_open_is_not_raised_again(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    let trace = measured(&*records, a, 10, Some(0.41)).await;
    let webhook = hook(&*records, &AlertKind::ALL).await;
    let twice = [threshold(AlertFault::Kgm, trace, 20), threshold(AlertFault::Kgm, trace, 21)];
    changed(&*records, a, &twice).await;
    changed(&*records, a, &twice[..1]).await;
    let first = alerts(&*records).await;
    assert_eq!(first.len(), 1);
    records.acknowledge_alert(first[0].id, "", at(30)).await.unwrap();
    changed(&*records, a, &twice).await;
    assert_eq!(alerts(&*records).await.len(), 1, "an acknowledged alert is still open");
    assert_eq!(told(&*records, webhook).await, [Event::Acknowledged, Event::Raised]);
    changed(&*records, a, &[threshold(AlertFault::FdjN, trace, 40), risk(40)]).await;
    changed(&*records, b, &[risk(40)]).await;
    assert_eq!(alerts(&*records).await.len(), 4, "another fault, kind or actuator has its own");
    assert_eq!(records.open_alerts(a).await.unwrap().len(), 3);
}

pub async fn contract_a_forecast_of_an_older_revision_changes_no_alert(records: Arc<dyn Records>) {
    let id = registered(&*records, "A").await.id;
    changed(&*records, id, &[risk(10)]).await;
    let open = alerts(&*records).await;
    measured(&*records, id, 20, Some(0.1)).await;
    let late = forecast(id, 0, None, None);
    let trace = measured(&*records, id, 30, Some(0.1)).await;
    let changes = [clear(open[0].id, 40), threshold(AlertFault::Kgm, trace, 40)];
    assert!(!records.store_forecast_with(&late, &with(&changes)).await.unwrap());
    assert_eq!(alerts(&*records).await, open);
}

pub async fn contract_an_alert_is_acknowledged_once_and_cleared_once_and_keeps_its_times(records: Arc<dyn Records>) {
    let id = registered(&*records, "A").await.id;
    let webhook = hook(&*records, &AlertKind::ALL).await;
    changed(&*records, id, &[risk(10)]).await;
    let alert = alerts(&*records).await.remove(0).id;
    let (acknowledged, new) = records.acknowledge_alert(alert, "seen", at(20)).await.unwrap().unwrap();
    assert!(new && acknowledged.state == AlertState::Acknowledged);
    let (again, new) = records.acknowledge_alert(alert, "seen twice", at(30)).await.unwrap().unwrap();
    assert_eq!((again, new), (acknowledged, false));
    changed(&*records, id, &[clear(alert, 40)]).await;
    changed(&*records, id, &[clear(alert, 50)]).await;
    let cleared = alerts(&*records).await.remove(0);
    assert_eq!((cleared.state, cleared.cleared_because), (AlertState::Cleared, Some(ClearedBecause::RiskFell)));
    assert_eq!((cleared.raised_at, cleared.acknowledged_at, cleared.cleared_at), (at(10), Some(at(20)), Some(at(40))));
    assert_eq!(cleared.note, "seen");
    let (late, new) = records.acknowledge_alert(alert, "late", at(60)).await.unwrap().unwrap();
    assert_eq!((late, new), (cleared, false));
    assert_eq!(records.acknowledge_alert(Id::now(), "", at(60)).await.unwrap(), None);
    assert_eq!(told(&*records, webhook).await, [Event::Cleared, Event::Acknowledged, Event::Raised]);
    changed(&*records, id, &[risk(70)]).await;
    assert_eq!(alerts(&*records).await.len(), 2, "once it is cleared, another may be raised");
}

pub async fn contract_a_new_life_clears_the_alerts_of_the_former_one(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    let webhook = hook(&*records, &AlertKind::ALL).await;
    for id in [a, b] {
        changed(&*records, id, &[risk(100)]).await;
    }
    maintained(&*records, a, MaintenanceKind::Inspected, 200).await;
    assert_eq!(records.open_alerts(a).await.unwrap().len(), 1, "its life goes on");
    let event = maintained(&*records, a, MaintenanceKind::Overhauled, 300).await;
    assert_eq!(records.open_alerts(a).await.unwrap(), []);
    assert_eq!(records.open_alerts(b).await.unwrap().len(), 1, "another actuator's life goes on");
    let cleared = records.alerts(Some(AlertState::Cleared), None, &all()).await.unwrap().items.remove(0);
    assert_eq!((cleared.actuator_id, cleared.cleared_because), (a, Some(ClearedBecause::Maintenance)));
    assert_eq!(cleared.cleared_at, Some(event.created_at));
    assert_eq!(told(&*records, webhook).await, [Event::Cleared, Event::Raised, Event::Raised]);
    changed(&*records, a, &[risk(400)]).await;
    maintained(&*records, a, MaintenanceKind::Replaced, 250).await;
    assert_eq!(records.open_alerts(a).await.unwrap().len(), 1, "an event of long ago begins no life that is newer");
}

pub async fn contract_alerts_are_listed_newest_first_by_state_and_by_actuator(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    for _ in 0..2 {
        for id in [a, b] {
            changed(&*records, id, &[risk(10)]).await;
            let open = records.open_alerts(id).await.unwrap();
            changed(&*records, id, &[clear(open[0].id, 20)]).await;
        }
    }
    changed(&*records, a, &[risk(30)]).await;
    let everything = alerts(&*records).await;
    assert_eq!(everything.iter().map(|alert| alert.actuator_id).collect::<Vec<_>>(), [a, b, a, b, a]);
    let chosen = [
        (None, None),
        (Some(AlertState::Open), None),
        (Some(AlertState::Cleared), None),
        (None, Some(b)),
        (Some(AlertState::Cleared), Some(a)),
        (Some(AlertState::Acknowledged), Some(a)),
    ];
    for (state, actuator) in chosen {
        let expected: Vec<_> = everything
            .iter()
            .filter(|alert| state.is_none_or(|state| alert.state == state))
            .filter(|alert| actuator.is_none_or(|actuator| alert.actuator_id == actuator))
            .cloned()
            .collect();
        let mut found = Vec::new();
        let mut page = Page { after: None, limit: 1 };
        loop {
            let read = records.alerts(state, actuator, &page).await.unwrap();
            found.extend(read.items);
            page.after = read.next_cursor;
            if page.after.is_none() {
                break;
            }
        }
        assert_eq!(found, expected, "{state:?} {actuator:?}");
    }
    let of_all = records.alerts(None, None, &Page { after: None, limit: 1 }).await.unwrap().next_cursor;
    let error = records.alerts(None, Some(a), &Page { after: of_all, limit: 1 }).await.unwrap_err();
    assert!(matches!(error, StoreError::Cursor { .. }), "{error}");
}

pub async fn contract_the_fleet_counts_the_alerts_that_are_not_cleared(records: Arc<dyn Records>) {
    let id = registered(&*records, "A").await.id;
    let open = async || records.fleet(None, &all()).await.unwrap().items[0].alerts_open;
    assert_eq!(open().await, 0);
    let trace = measured(&*records, id, 10, Some(0.41)).await;
    changed(&*records, id, &[risk(10), threshold(AlertFault::Kgm, trace, 10)]).await;
    assert_eq!(open().await, 2);
    let alert = records.open_alerts(id).await.unwrap().remove(0).id;
    records.acknowledge_alert(alert, "", now()).await.unwrap();
    assert_eq!(open().await, 2);
    changed(&*records, id, &[clear(alert, 20)]).await;
    assert_eq!(open().await, 1);
}

pub async fn contract_an_alert_and_what_is_told_of_it_are_one_change(records: Arc<dyn Records>) {
    let id = registered(&*records, "A").await.id;
    let webhook = hook(&*records, &AlertKind::ALL).await;
    let kept = forecast(id, 0, None, None);
    // The trace does not exist, so that raising the second alert fails after the first was raised.
    let changes = [risk(10), threshold(AlertFault::Kgm, Id::now(), 10)];
    let error = records.store_forecast_with(&kept, &with(&changes)).await.unwrap_err();
    assert!(matches!(error, StoreError::Database(_)), "{error}");
    assert_eq!(alerts(&*records).await, []);
    assert_eq!(deliveries(&*records, webhook).await, []);
    assert_eq!(records.forecast(id).await.unwrap(), None);
}
