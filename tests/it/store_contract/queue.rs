use std::sync::Arc;

use elevon::store::records::{Id, JobState, Outcome, now};
use elevon::store::{Page, Paged, Records, StoreError};
use serde_json::json;
use tokio::task::JoinSet;

use super::samples::{ROOMY, all, at, estimated, job, queued, registered, trace};

async fn state(records: &dyn Records, id: Id) -> JobState {
    records.job(id).await.unwrap().unwrap().state
}

pub async fn contract_an_upload_is_kept_with_its_job_or_not_at_all(records: Arc<dyn Records>) {
    let actuator = registered(&*records, "A").await.id;
    let (kept, kept_job) = (trace(actuator, 10), job());
    records.insert_upload(&kept, &kept_job, 1).await.unwrap();
    assert_eq!(records.trace(kept.id).await.unwrap().unwrap(), kept);
    let found = records.job(kept_job.id).await.unwrap().unwrap();
    assert_eq!((found.state, found.attempt, found.progress), (JobState::Queued, 0, 0.0));
    assert_eq!((found.kind, found.spec, found.created_at), (kept_job.kind, kept_job.spec, kept_job.created_at));

    let (refused, refused_job) = (trace(actuator, 20), job());
    let error = records.insert_upload(&refused, &refused_job, 1).await.unwrap_err();
    assert!(matches!(error, StoreError::QueueFull { queued: 1, limit: 1 }), "{error}");
    let twice = records.insert_upload(&kept, &refused_job, ROOMY).await.unwrap_err();
    assert!(matches!(twice, StoreError::Database(_)) && !twice.may_pass(), "{twice}");
    assert_eq!(records.trace(refused.id).await.unwrap(), None);
    assert_eq!(records.job(refused_job.id).await.unwrap(), None);
}

pub async fn contract_a_full_queue_takes_a_job_again_once_one_left_it(records: Arc<dyn Records>) {
    let first = job();
    records.insert_job(&first, 1).await.unwrap();
    let error = records.insert_job(&job(), 1).await.unwrap_err();
    assert!(matches!(error, StoreError::QueueFull { queued: 1, limit: 1 }), "{error}");
    records.claim_job(first.id, now()).await.unwrap().unwrap();
    records.insert_job(&job(), 1).await.unwrap();
}

pub async fn contract_a_job_is_claimed_once_whoever_asks_at_the_same_time(records: Arc<dyn Records>) {
    let id = queued(&*records).await;
    let mut claims = JoinSet::new();
    for second in 0..20 {
        let records = records.clone();
        claims.spawn(async move { records.claim_job(id, at(second)).await.unwrap() });
    }
    let won: Vec<_> = claims.join_all().await.into_iter().flatten().collect();
    assert_eq!(won.len(), 1, "{won:?}");
    assert_eq!((won[0].state, won[0].attempt), (JobState::Running, 1));
    assert_eq!(records.job(id).await.unwrap().as_ref(), Some(&won[0]));
    assert_eq!(records.claim_job(Id::now(), now()).await.unwrap(), None);
}

pub async fn contract_only_the_running_attempt_reports_and_finishes(records: Arc<dyn Records>) {
    let id = queued(&*records).await;
    let outcome = Outcome::Failed { error: "no figure".into() };
    assert!(!records.finish_job(id, 0, &outcome, at(9)).await.unwrap(), "it does not run yet");
    records.claim_job(id, at(5)).await.unwrap().unwrap();
    assert!(records.report_progress(id, 1, 0.25).await.unwrap());
    for attempt in [0, 2] {
        assert!(!records.report_progress(id, attempt, 0.75).await.unwrap());
        assert!(!records.finish_job(id, attempt, &outcome, at(9)).await.unwrap());
    }
    let running = records.job(id).await.unwrap().unwrap();
    assert_eq!((running.state, running.progress, running.started_at), (JobState::Running, 0.25, Some(at(5))));

    assert!(records.finish_job(id, 1, &outcome, at(9)).await.unwrap());
    assert!(!records.finish_job(id, 1, &Outcome::Failed { error: "other".into() }, at(10)).await.unwrap());
    assert!(!records.report_progress(id, 1, 1.0).await.unwrap());
    let failed = records.job(id).await.unwrap().unwrap();
    assert_eq!((failed.state, failed.error.as_deref()), (JobState::Failed, Some("no figure")));
    assert_eq!((failed.progress, failed.finished_at), (0.25, Some(at(9))));
}

pub async fn contract_a_cancelled_job_is_not_claimed_and_not_finished(records: Arc<dyn Records>) {
    let (waiting, running) = (queued(&*records).await, queued(&*records).await);
    records.claim_job(running, now()).await.unwrap().unwrap();
    for id in [waiting, running] {
        let cancelled = records.cancel_job(id, at(7)).await.unwrap().unwrap();
        assert_eq!((cancelled.state, cancelled.finished_at), (JobState::Cancelled, Some(at(7))));
        assert_eq!(records.cancel_job(id, at(8)).await.unwrap().unwrap(), cancelled);
    }
    assert_eq!(records.claim_job(waiting, now()).await.unwrap(), None);
    assert!(!records.report_progress(running, 1, 0.5).await.unwrap());
    let actuator = registered(&*records, "A").await.id;
    let (trace, other) = (trace(actuator, 10), job());
    records.insert_upload(&trace, &other, ROOMY).await.unwrap();
    assert!(!records.finish_job(running, 1, &estimated(trace.id, Some(0.1)), now()).await.unwrap());
    assert_eq!(state(&*records, running).await, JobState::Cancelled);
    assert!(records.health(actuator, None, None, &all()).await.unwrap().items.is_empty());
    assert_eq!(records.actuator(actuator).await.unwrap().unwrap().revision, 0);
    assert_eq!(records.cancel_job(Id::now(), now()).await.unwrap(), None);
}

pub async fn contract_a_released_attempt_does_not_count(records: Arc<dyn Records>) {
    let id = queued(&*records).await;
    assert!(!records.release_job(id, 0).await.unwrap(), "it does not run yet");
    for _ in 0..3 {
        let claimed = records.claim_job(id, now()).await.unwrap().unwrap();
        assert_eq!(claimed.attempt, 1);
        assert!(records.release_job(id, 1).await.unwrap());
        assert!(!records.release_job(id, 1).await.unwrap());
        let waiting = records.job(id).await.unwrap().unwrap();
        assert_eq!((waiting.state, waiting.attempt, waiting.started_at), (JobState::Queued, 0, None));
    }
}

pub async fn contract_recovery_queues_what_ran_and_fails_what_used_its_attempts(records: Arc<dyn Records>) {
    let (dies, waits, done) = (queued(&*records).await, queued(&*records).await, queued(&*records).await);
    records.cancel_job(done, now()).await.unwrap();
    for attempt in 1..=2 {
        assert_eq!(records.claim_job(dies, now()).await.unwrap().unwrap().attempt, attempt);
        assert_eq!(records.recover_jobs(3, now()).await.unwrap(), [dies, waits]);
        assert_eq!(records.job(dies).await.unwrap().unwrap().attempt, attempt);
    }
    records.claim_job(dies, now()).await.unwrap().unwrap();
    assert_eq!(records.recover_jobs(3, at(9)).await.unwrap(), [waits]);
    let failed = records.job(dies).await.unwrap().unwrap();
    assert_eq!((failed.state, failed.attempt, failed.finished_at), (JobState::Failed, 3, Some(at(9))));
    let error = failed.error.unwrap();
    assert!(error.contains("ended") && error.contains("3 attempts"), "{error}");
    assert_eq!(state(&*records, done).await, JobState::Cancelled);
}

pub async fn contract_jobs_are_listed_newest_first_and_counted_by_state(records: Arc<dyn Records>) {
    let mut ids = Vec::new();
    for _ in 0..5 {
        ids.push(queued(&*records).await);
    }
    records.cancel_job(ids[3], now()).await.unwrap();
    ids.reverse();
    for (state, expected) in [
        (None, ids.clone()),
        (Some(JobState::Queued), vec![ids[0], ids[2], ids[3], ids[4]]),
        (Some(JobState::Cancelled), vec![ids[1]]),
        (Some(JobState::Running), vec![]),
    ] {
        let mut found = Vec::new();
        let mut page = Page { after: None, limit: 2 };
        loop {
            let Paged { items, next_cursor } = records.jobs(state, &page).await.unwrap();
            found.extend(items.iter().map(|job| job.id));
            page.after = next_cursor;
            if page.after.is_none() {
                break;
            }
        }
        assert_eq!(found, expected, "{state:?}");
    }
    let counts = records.job_counts().await.unwrap();
    assert_eq!(counts, JobState::ALL.into_iter().zip([4, 0, 0, 0, 1]).collect::<Vec<_>>());
    assert_eq!(records.job(ids[0]).await.unwrap().unwrap().spec, json!({"of": "a test"}));
}
