use std::sync::Arc;

use elevon::store::records::{Id, JobState, MaintenanceKind};
use elevon::store::{FleetRow, Page, Records, StoreError};

use super::samples::{actuator, all, at, forecast, maintained, measured, registered};

pub async fn contract_a_serial_number_is_taken_once(records: Arc<dyn Records>) {
    let first = registered(&*records, "SN-1").await;
    let error = records.insert_actuator(&actuator("SN-1")).await.unwrap_err();
    assert!(matches!(&error, StoreError::Conflict { field: "serial_number", value } if value == "SN-1"), "{error}");
    assert_eq!(records.actuator(first.id).await.unwrap(), Some(first));
    assert_eq!(records.actuator(Id::now()).await.unwrap(), None);
}

pub async fn contract_actuators_are_listed_in_the_order_of_registration(records: Arc<dyn Records>) {
    let mut expected = Vec::new();
    for serial_number in ["C", "A", "B"] {
        expected.push(registered(&*records, serial_number).await);
    }
    let first = records.actuators(&Page { after: None, limit: 2 }).await.unwrap();
    let second = records.actuators(&Page { after: first.next_cursor, limit: 2 }).await.unwrap();
    assert_eq!((&first.items[..], &second.items[..]), expected.split_at(2));
    assert_eq!(second.next_cursor, None);
}

pub async fn contract_a_malformed_cursor_is_refused_by_every_list(records: Arc<dyn Records>) {
    let page = Page { after: Some("no cursor".into()), limit: 1 };
    let id = Id::now();
    let errors = [
        records.actuators(&page).await.unwrap_err(),
        records.parameter_sets(&page).await.unwrap_err(),
        records.jobs(None, &page).await.unwrap_err(),
        records.health(id, None, None, &page).await.unwrap_err(),
        records.maintenance(id, &page).await.unwrap_err(),
        records.fleet(None, &page).await.unwrap_err(),
        records.trend(id, None, None, &page).await.unwrap_err(),
        records.alerts(None, None, &page).await.unwrap_err(),
        records.webhooks(&page).await.unwrap_err(),
        records.deliveries(id, &page).await.unwrap_err(),
    ];
    for error in errors {
        assert!(matches!(&error, StoreError::Cursor { found } if found == "no cursor"), "{error}");
    }
}

pub async fn contract_a_cursor_of_another_list_is_refused(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    for second in [10, 20] {
        measured(&*records, a, second, Some(0.1)).await;
        maintained(&*records, a, MaintenanceKind::Inspected, second).await;
    }
    let first = Page { after: None, limit: 1 };
    let of_health = records.health(a, None, None, &first).await.unwrap().next_cursor;
    let of_fleet = records.fleet(None, &first).await.unwrap().next_cursor;
    let of_jobs = records.jobs(None, &first).await.unwrap().next_cursor;
    assert!(of_health.is_some() && of_fleet.is_some() && of_jobs.is_some());
    let [of_health, of_fleet, of_jobs] = [of_health, of_fleet, of_jobs].map(|after| Page { after, limit: 1 });
    let errors = [
        records.health(b, None, None, &of_health).await.unwrap_err(),
        records.health(a, Some(at(10)), None, &of_health).await.unwrap_err(),
        records.maintenance(a, &of_health).await.unwrap_err(),
        records.trend(a, None, None, &of_health).await.unwrap_err(),
        records.fleet(Some("I-ABCD"), &of_fleet).await.unwrap_err(),
        records.actuators(&of_jobs).await.unwrap_err(),
        records.parameter_sets(&of_jobs).await.unwrap_err(),
        records.jobs(Some(JobState::Succeeded), &of_jobs).await.unwrap_err(),
    ];
    assert!(errors.iter().all(|error| matches!(error, StoreError::Cursor { .. })), "{errors:?}");
    assert_eq!(records.health(a, None, None, &of_health).await.unwrap().items.len(), 1);
}

pub async fn contract_a_forecast_of_an_older_revision_is_refused(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    assert_eq!(records.forecast(actuator).await.unwrap(), None);
    let first = forecast(actuator, 0, None, None);
    assert!(records.store_forecast(&first, None).await.unwrap());
    measured(&*records, actuator, 10, Some(0.1)).await;
    assert!(!records.store_forecast(&forecast(actuator, 0, Some(0.5), None), None).await.unwrap());
    assert_eq!(records.forecast(actuator).await.unwrap(), Some(first));
    let second = forecast(actuator, 1, Some(0.25), Some(0.1 + 0.2));
    assert!(records.store_forecast(&second, None).await.unwrap());
    assert_eq!(records.forecast(actuator).await.unwrap(), Some(second));
    assert!(!records.store_forecast(&forecast(Id::now(), 0, None, None), None).await.unwrap());
}

pub async fn contract_what_changes_a_history_makes_its_forecast_stale(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    assert_eq!(records.stale_forecasts(10).await.unwrap(), [a, b]);
    assert_eq!(records.stale_forecasts(1).await.unwrap(), [a]);
    for id in [a, b] {
        records.store_forecast(&forecast(id, 0, None, None), None).await.unwrap();
    }
    assert!(records.stale_forecasts(10).await.unwrap().is_empty());
    records.expire_forecasts("this").await.unwrap();
    assert!(records.stale_forecasts(10).await.unwrap().is_empty());
    records.expire_forecasts("another").await.unwrap();
    assert_eq!(records.stale_forecasts(10).await.unwrap(), [a, b], "a forecast of another basis is made again");
    for id in [a, b] {
        assert!(records.store_forecast(&forecast(id, 0, None, None), None).await.unwrap());
    }
    measured(&*records, a, 10, None).await;
    assert_eq!(records.stale_forecasts(10).await.unwrap(), [a]);
    maintained(&*records, b, MaintenanceKind::Inspected, 10).await;
    assert_eq!(records.stale_forecasts(10).await.unwrap(), [a, b]);
}

pub async fn contract_the_fleet_is_listed_riskiest_first_page_by_page(records: Arc<dyn Records>) {
    let ranks = [
        ("unknown", None, None),
        ("safe", Some(0.0), None),
        ("safe, known", Some(0.0), Some(900.0)),
        ("later", Some(0.5), Some(80.0)),
        ("sooner", Some(0.5), Some(70.0)),
        ("worst", Some(0.9), Some(200.0)),
    ];
    for (serial_number, risk, median) in ranks {
        let id = registered(&*records, serial_number).await.id;
        records.store_forecast(&forecast(id, 0, risk, median), None).await.unwrap();
    }
    let mut elsewhere = actuator("elsewhere");
    elsewhere.tail_number = "I-OTHER".into();
    records.insert_actuator(&elsewhere).await.unwrap();

    let expected = ["worst", "sooner", "later", "safe, known", "safe", "unknown", "elsewhere"];
    for (tail_number, expected) in [(None, &expected[..]), (Some("I-ABCD"), &expected[..6]), (Some("none"), &[])] {
        let mut found = Vec::new();
        let mut page = Page { after: None, limit: 2 };
        loop {
            let read = records.fleet(tail_number, &page).await.unwrap();
            found.extend(read.items.into_iter().map(|row| row.actuator.serial_number));
            page.after = read.next_cursor;
            if page.after.is_none() {
                break;
            }
        }
        assert_eq!(found, expected, "{tail_number:?}");
    }
}

pub async fn contract_the_fleet_shows_the_newest_health_of_this_life(records: Arc<dyn Records>) {
    let id = registered(&*records, "A").await.id;
    let row = async || -> FleetRow { records.fleet(None, &all()).await.unwrap().items.remove(0) };
    let newest = async || row().await.newest.map(|record| record.usage);
    assert_eq!((newest().await, row().await.forecast), (None, None));
    for second in [20, 30, 10] {
        measured(&*records, id, second, Some(0.1)).await;
    }
    assert_eq!(newest().await, Some(30.0));
    let stored = forecast(id, 3, Some(0.1), Some(5.0));
    records.store_forecast(&stored, None).await.unwrap();
    maintained(&*records, id, MaintenanceKind::Replaced, 40).await;
    assert_eq!((newest().await, row().await.forecast), (None, Some(stored)));
    assert_eq!(row().await.actuator.revision, 4);
    measured(&*records, id, 50, Some(0.1)).await;
    assert_eq!(newest().await, Some(50.0));
}
