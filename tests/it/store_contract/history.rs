use std::collections::BTreeMap;
use std::sync::Arc;

use elevon::estimation::{Estimate, Verdict};
use elevon::store::records::{HealthRecord, Id, JobState, MaintenanceKind, Outcome, now};
use elevon::store::{Page, Records};
use serde_json::json;

use super::samples::{ROOMY, all, at, estimate, finish, job, maintained, measured, queued, registered, trace};

/// The whole history, read in pages of two.
async fn history(records: &dyn Records, actuator: Id) -> Vec<HealthRecord> {
    let mut found = Vec::new();
    let mut page = Page { after: None, limit: 2 };
    loop {
        let read = records.health(actuator, None, None, &page).await.unwrap();
        assert!(read.items.len() == 2 || read.next_cursor.is_none());
        found.extend(read.items);
        page.after = read.next_cursor;
        if page.after.is_none() {
            return found;
        }
    }
}

pub async fn contract_a_late_upload_is_sorted_in_and_pages_follow_on(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let other = registered(&*records, "B").await.id;
    let mut expected = Vec::new();
    for second in [30, 10, -50, 20, 20, 40] {
        expected.push((at(second), measured(&*records, actuator, second, Some(0.1)).await));
        measured(&*records, other, second, Some(0.2)).await;
    }
    expected.sort_unstable();
    let found = history(&*records, actuator).await;
    assert_eq!(found.iter().map(|record| (record.recorded_at, record.trace_id)).collect::<Vec<_>>(), expected);
    let first = &found[0];
    assert_eq!((first.usage, first.kgm, first.kgm_std), (-50.0, Some(0.1), Some(0.01)));
    assert_eq!((first.fdj_n, first.fdj_n_std, first.verdict), (Some(400.0), Some(8.0), Verdict::Conclusive));
}

pub async fn contract_from_is_inclusive_and_to_is_not(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    for second in 1..=6 {
        measured(&*records, actuator, second, Some(0.1)).await;
    }
    let mut page = Page { after: None, limit: 2 };
    let mut found = Vec::new();
    for _ in 0..2 {
        let read = records.health(actuator, Some(at(2)), Some(at(6)), &page).await.unwrap();
        found.extend(read.items.iter().map(|record| record.usage));
        page.after = read.next_cursor;
    }
    assert_eq!(found, [2.0, 3.0, 4.0, 5.0]);
    assert_eq!(page.after, None);
}

pub async fn contract_a_trace_has_one_row_its_newest_estimate(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let trace = measured(&*records, actuator, 10, Some(0.1)).await;
    let again = queued(&*records).await;
    finish(&*records, again, trace, Some(0.3)).await;
    let found = history(&*records, actuator).await;
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].kgm, found[0].job_id), (Some(0.3), again));
    assert_eq!(records.actuator(actuator).await.unwrap().unwrap().revision, 2);
}

pub async fn contract_the_newest_estimate_is_that_of_the_job_asked_for_last(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let trace = measured(&*records, actuator, 10, Some(0.1)).await;
    let (sooner, later) = (queued(&*records).await, queued(&*records).await);
    finish(&*records, later, trace, Some(0.3)).await;
    finish(&*records, sooner, trace, Some(0.2)).await;
    let found = history(&*records, actuator).await;
    assert_eq!((found.len(), found[0].kgm, found[0].job_id), (1, Some(0.3), later));
    assert_eq!(records.job(sooner).await.unwrap().unwrap().state, JobState::Succeeded);
    assert_eq!(records.actuator(actuator).await.unwrap().unwrap().revision, 2, "the history did not change");
}

pub async fn contract_the_other_faults_of_the_newest_estimate_stand_in_the_history(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let trace = measured(&*records, actuator, 10, Some(0.1)).await;
    assert!(history(&*records, actuator).await[0].faults.is_empty());
    let faults = BTreeMap::from([
        ("clearance_m".to_owned(), Some(0.1 + 0.2)),
        ("clearance_m_std".to_owned(), Some(1e-300)),
        ("clogging".to_owned(), None),
    ]);
    let estimate = Box::new(Estimate { faults: faults.clone(), ..estimate(Some(0.1)) });
    let id = queued(&*records).await;
    records.claim_job(id, now()).await.unwrap().unwrap();
    let outcome = Outcome::Estimated { trace_id: trace, estimate, result: json!({}) };
    assert!(records.finish_job(id, 1, &outcome, now()).await.unwrap());
    assert_eq!(history(&*records, actuator).await[0].faults, faults);
    assert_eq!(records.life_history(actuator).await.unwrap().unwrap().records[0].faults, faults);
    assert_eq!(records.fleet(None, &all()).await.unwrap().items[0].newest.as_ref().unwrap().faults, faults);
    finish(&*records, queued(&*records).await, trace, Some(0.2)).await;
    assert!(history(&*records, actuator).await[0].faults.is_empty(), "the newest estimate was not asked for them");
}

pub async fn contract_an_excluded_trace_leaves_the_history_and_stays(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (first, second) =
        (measured(&*records, actuator, 10, Some(0.1)).await, measured(&*records, actuator, 20, Some(0.2)).await);
    let revision = async || records.actuator(actuator).await.unwrap().unwrap().revision;
    let usages = async || {
        let history: Vec<_> = history(&*records, actuator).await.iter().map(|record| record.usage).collect();
        let life = records.life_history(actuator).await.unwrap().unwrap().records;
        assert_eq!(history, life.iter().map(|record| record.usage).collect::<Vec<_>>());
        let newest = records.fleet(None, &all()).await.unwrap().items.remove(0).newest;
        assert_eq!(history.last().copied(), newest.map(|record| record.usage));
        history
    };
    for (times, grown) in [(1, 3), (2, 3)] {
        let trace = records.exclude_trace(second, true, "unplugged").await.unwrap().unwrap();
        assert_eq!((trace.excluded, trace.reason.as_str(), trace.id), (true, "unplugged", second));
        assert_eq!(records.trace(second).await.unwrap(), Some(trace));
        assert_eq!((usages().await, revision().await), (vec![10.0], grown), "excluded {times} times");
    }
    finish(&*records, queued(&*records).await, second, Some(0.3)).await;
    assert_eq!(usages().await, [10.0], "an estimate does not take an excluded trace back");
    records.exclude_trace(first, true, "").await.unwrap().unwrap();
    assert!(usages().await.is_empty());
    let before = revision().await;
    records.exclude_trace(second, false, "").await.unwrap().unwrap();
    assert_eq!((usages().await, revision().await), (vec![20.0], before + 1));
    assert_eq!(history(&*records, actuator).await[0].kgm, Some(0.3));
    assert_eq!(records.exclude_trace(Id::now(), true, "").await.unwrap(), None);
}

pub async fn contract_a_trace_excluded_before_its_estimate_does_not_enter_the_history(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (trace, job) = (trace(actuator, 10), job());
    records.insert_upload(&trace, &job, ROOMY).await.unwrap();
    records.exclude_trace(trace.id, true, "too hot").await.unwrap().unwrap();
    finish(&*records, job.id, trace.id, Some(0.1)).await;
    assert!(history(&*records, actuator).await.is_empty());
    records.exclude_trace(trace.id, false, "").await.unwrap().unwrap();
    assert_eq!(history(&*records, actuator).await.len(), 1);
}

pub async fn contract_an_inconclusive_estimate_is_listed_without_figures(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (trace, job) = (trace(actuator, 10), job());
    records.insert_upload(&trace, &job, ROOMY).await.unwrap();
    finish(&*records, job.id, trace.id, None).await;
    let found = history(&*records, actuator).await;
    assert_eq!((found[0].trace_id, found[0].verdict), (trace.id, Verdict::Inconclusive));
    assert_eq!((found[0].kgm, found[0].kgm_std, found[0].fdj_n, found[0].fdj_n_std), (None, None, None, None));
    let done = records.job(job.id).await.unwrap().unwrap();
    assert_eq!((done.state, done.progress, done.result), (JobState::Succeeded, 1.0, Some(json!({"kgm": null}))));
}

pub async fn contract_an_estimate_of_no_actuator_enters_no_history(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (mut trace, job) = (trace(actuator, 10), job());
    (trace.actuator_id, trace.recorded_at, trace.usage) = (None, None, None);
    records.insert_upload(&trace, &job, ROOMY).await.unwrap();
    finish(&*records, job.id, trace.id, Some(0.1)).await;
    assert_eq!(records.trace(trace.id).await.unwrap().unwrap(), trace);
    assert!(history(&*records, actuator).await.is_empty());
    assert_eq!(records.actuator(actuator).await.unwrap().unwrap().revision, 0);
}

pub async fn contract_a_simulation_adds_its_trace_when_it_finishes(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let simulated = |trace: &_| Outcome::Simulated { trace: Box::new(Clone::clone(trace)), result: json!({}) };
    let id = queued(&*records).await;
    records.claim_job(id, now()).await.unwrap().unwrap();
    let (lost, kept) = (trace(actuator, 1), trace(actuator, 2));
    assert!(!records.finish_job(id, 2, &simulated(&lost), now()).await.unwrap());
    assert!(records.finish_job(id, 1, &simulated(&kept), now()).await.unwrap());
    assert_eq!(records.trace(lost.id).await.unwrap(), None);
    assert_eq!(records.trace(kept.id).await.unwrap(), Some(kept));
}

pub async fn contract_maintenance_starts_a_life_unless_it_is_an_inspection(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    for second in [10, 20, 30, 40] {
        measured(&*records, actuator, second, Some(0.1)).await;
    }
    let life = async || {
        let life = records.life_history(actuator).await.unwrap().unwrap();
        (life.revision, life.life_start_usage, life.records.iter().map(|record| record.usage).collect::<Vec<_>>())
    };
    assert_eq!(life().await, (4, None, vec![10.0, 20.0, 30.0, 40.0]));
    maintained(&*records, actuator, MaintenanceKind::Inspected, 35).await;
    assert_eq!(life().await, (5, None, vec![10.0, 20.0, 30.0, 40.0]));
    maintained(&*records, actuator, MaintenanceKind::Overhauled, 30).await;
    assert_eq!(life().await, (6, Some(30.0), vec![30.0, 40.0]));
    maintained(&*records, actuator, MaintenanceKind::Replaced, 15).await;
    let started_at = records.life_history(actuator).await.unwrap().unwrap().life_started_at;
    assert_eq!(started_at, Some(at(30)));
    assert_eq!(life().await, (7, Some(30.0), vec![30.0, 40.0]), "the newest event starts the life, not the last told");
    assert_eq!(history(&*records, actuator).await.len(), 4, "older records stay");
    assert_eq!(records.life_history(Id::now()).await.unwrap(), None);
}

pub async fn contract_maintenance_is_listed_by_its_time(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let later = maintained(&*records, actuator, MaintenanceKind::Replaced, 20).await;
    let sooner = maintained(&*records, actuator, MaintenanceKind::Inspected, 10).await;
    let first = records.maintenance(actuator, &Page { after: None, limit: 1 }).await.unwrap();
    let second = records.maintenance(actuator, &Page { after: first.next_cursor, limit: 1 }).await.unwrap();
    assert_eq!((first.items, second.items, second.next_cursor), (vec![sooner], vec![later], None));
    assert!(records.maintenance(Id::now(), &all()).await.unwrap().items.is_empty());
}
