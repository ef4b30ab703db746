//! The plans that SQLite makes for what is read or written often: none may look at a whole table or sort.

use sqlx::{AssertSqlSafe, Row as _};

use super::{SqliteRecords, actuators, alerts, cohorts, fleet, health, jobs, parameter_sets, trend, webhooks};

async fn plan(records: &SqliteRecords, sql: &'static str) -> Vec<String> {
    let explain = AssertSqlSafe(format!("EXPLAIN QUERY PLAN {sql}"));
    let rows = sqlx::query(explain).fetch_all(&records.writer).await.unwrap();
    rows.iter().map(|row| row.get(3)).collect()
}

#[tokio::test]
async fn every_hot_query_searches_an_index_and_sorts_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let hot = [
        actuators::LIST,
        parameter_sets::NEWEST,
        parameter_sets::BY_HASH,
        parameter_sets::LIST,
        jobs::LIST,
        jobs::LIST_IN_STATE,
        jobs::COUNT_QUEUED,
        jobs::CLAIM,
        jobs::GIVE_UP,
        jobs::QUEUED,
        health::LIST,
        health::LIFE,
        health::LIFE_START,
        health::MAINTENANCE,
        fleet::FLEET,
        fleet::FLEET_OF_TAIL,
        trend::LIST,
        cohorts::SHARE,
        cohorts::SHARE_IN,
        cohorts::SUM,
        cohorts::PRIOR,
        alerts::OPEN,
        alerts::OF_FORMER_LIVES,
        alerts::LIST,
        alerts::LIST_IN_STATE,
        alerts::LIST_OF_ACTUATOR,
        alerts::LIST_OF_ACTUATOR_IN_STATE,
        webhooks::LIST,
        webhooks::WAITING_PING,
        webhooks::DELIVERIES,
        webhooks::DUE,
        webhooks::ABANDON,
        webhooks::FORGET,
    ];
    for sql in hot {
        let plan = plan(&records, sql).await;
        assert!(plan.iter().any(|step| step.starts_with("SEARCH")), "{sql}: {plan:?}");
        assert!(plan.iter().all(|step| !step.starts_with("SCAN") && !step.contains("B-TREE")), "{sql}: {plan:?}");
    }
}

#[tokio::test]
async fn stale_forecasts_are_found_in_an_index_of_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    let plan = plan(&records, fleet::STALE).await;
    assert!(matches!(&plan[..], [step] if step.contains("INDEX actuators_stale")), "{plan:?}");
}
