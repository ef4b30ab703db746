use std::sync::Arc;

use elevon::store::records::{Id, MaintenanceKind, TrendRecord, now};
use elevon::store::{Page, Records, StoreError};

use super::samples::{all, at, forecast, maintained, measured, registered, step};

/// Keeps a step with a forecast of the actuator's revision.
async fn kept(records: &dyn Records, step: &TrendRecord) {
    let revision = records.actuator(step.actuator_id).await.unwrap().unwrap().revision;
    let forecast = forecast(step.actuator_id, revision, None, None);
    assert!(records.store_forecast(&forecast, Some(step)).await.unwrap());
}

async fn trend(records: &dyn Records, actuator: Id) -> Vec<TrendRecord> {
    records.trend(actuator, None, None, &all()).await.unwrap().items
}

pub async fn contract_a_forecast_is_kept_with_its_step_of_the_trend_or_not_at_all(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    let first = step(a, measured(&*records, a, 10, Some(0.1)).await, 10);
    assert!(!records.store_forecast(&forecast(a, 0, None, None), Some(&first)).await.unwrap());
    assert!(trend(&*records, a).await.is_empty(), "the history had moved on");
    assert!(records.store_forecast(&forecast(a, 1, None, None), None).await.unwrap());
    assert!(trend(&*records, a).await.is_empty());
    kept(&*records, &first).await;
    assert_eq!(trend(&*records, a).await, [first]);
    assert!(trend(&*records, b).await.is_empty());
    let unknown = step(b, Id::now(), 20);
    let error = records.store_forecast(&forecast(b, 0, Some(0.5), None), Some(&unknown)).await.unwrap_err();
    assert!(matches!(error, StoreError::Database(_)), "{error:?}");
    assert_eq!(records.forecast(b).await.unwrap(), None, "a step of no trace takes its forecast with it");
}

pub async fn contract_a_step_of_the_same_life_and_trace_is_replaced_and_others_stay(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let first = step(actuator, measured(&*records, actuator, 10, Some(0.1)).await, 10);
    let second = step(actuator, measured(&*records, actuator, 20, Some(0.2)).await, 20);
    for step in [&first, &second] {
        kept(&*records, step).await;
    }
    let mut again = second.clone();
    (again.made_at, again.usage, again.actuator, again.basis) = (now(), 25.0, None, "other".into());
    again.faults.fdj_n = again.faults.kgm.take();
    kept(&*records, &again).await;
    assert_eq!(trend(&*records, actuator).await, [first.clone(), again.clone()]);
    maintained(&*records, actuator, MaintenanceKind::Overhauled, 15).await;
    let renewed = TrendRecord { life_started_at: Some(at(15)), life_start_usage: Some(15.0), ..second };
    kept(&*records, &renewed).await;
    assert_eq!(trend(&*records, actuator).await, [first, again, renewed], "the same trace in another life");
}

pub async fn contract_a_step_fills_a_gap_and_replaces_none(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let first = step(actuator, measured(&*records, actuator, 10, Some(0.1)).await, 10);
    let second = step(actuator, measured(&*records, actuator, 20, Some(0.2)).await, 20);
    kept(&*records, &second).await;
    assert!(records.fill_trend(&first).await.unwrap());
    let again = TrendRecord { actuator: None, made_at: now(), ..second.clone() };
    assert!(!records.fill_trend(&again).await.unwrap());
    assert_eq!(trend(&*records, actuator).await, [first.clone(), second]);
    records.fill_trend(&TrendRecord { trace_id: Id::now(), ..first }).await.unwrap_err();
}

pub async fn contract_the_trend_is_sorted_by_life_and_usage_page_by_page(records: Arc<dyn Records>) {
    let (actuator, other) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    let mut expected = Vec::new();
    for (life, usage) in [(Some(50), 5.0), (None, 30.0), (None, 10.0), (Some(50), 3.0), (None, 30.0), (None, -2.5)] {
        let mut step = step(actuator, measured(&*records, actuator, 60, Some(0.1)).await, 60);
        (step.life_started_at, step.life_start_usage, step.usage) = (life.map(at), life.map(|_| 1.0), usage);
        kept(&*records, &step).await;
        expected.push(step);
    }
    kept(&*records, &step(other, measured(&*records, other, 60, Some(0.1)).await, 60)).await;
    expected.sort_by(|a, b| a.life_started_at.cmp(&b.life_started_at).then(a.usage.total_cmp(&b.usage)));
    let (mut found, mut page) = (Vec::new(), Page { after: None, limit: 2 });
    loop {
        let read = records.trend(actuator, None, None, &page).await.unwrap();
        assert!(read.items.len() == 2);
        found.extend(read.items);
        page.after = read.next_cursor;
        if page.after.is_none() {
            break;
        }
        for wrong in [(other, None), (actuator, Some(at(1)))] {
            let error = records.trend(wrong.0, wrong.1, None, &page).await.unwrap_err();
            assert!(matches!(error, StoreError::Cursor { .. }), "{error:?}");
        }
    }
    assert_eq!(found, expected);
}

pub async fn contract_the_trend_is_cut_by_the_time_of_recording(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    for second in 1..=5 {
        kept(&*records, &step(actuator, measured(&*records, actuator, second, Some(0.1)).await, second)).await;
    }
    let cut = async |from: Option<i64>, to: Option<i64>| -> Vec<f64> {
        let page = records.trend(actuator, from.map(at), to.map(at), &all()).await.unwrap();
        page.items.into_iter().map(|step| step.usage).collect()
    };
    assert_eq!(cut(Some(2), Some(5)).await, [2.0, 3.0, 4.0]);
    assert_eq!(cut(Some(4), None).await, [4.0, 5.0]);
    assert_eq!(cut(None, Some(2)).await, [1.0]);
}

pub async fn contract_the_steps_of_an_excluded_trace_are_left_out_until_it_is_taken_back(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let mut steps = Vec::new();
    for second in [10, 20] {
        steps.push(step(actuator, measured(&*records, actuator, second, Some(0.1)).await, second));
        kept(&*records, &steps[steps.len() - 1]).await;
    }
    records.exclude_trace(steps[0].trace_id, true, "unplugged").await.unwrap();
    assert_eq!(trend(&*records, actuator).await, steps[1..]);
    records.exclude_trace(steps[0].trace_id, false, "").await.unwrap();
    assert_eq!(trend(&*records, actuator).await, steps);
}
