//! Forecasts that learn from the lives of others and from a part's own earlier ones.

use elevon::jobs::run::Models;
use elevon::store::records::{Actuator, ActuatorUpdate, Id, MaintenanceKind};
use serde_json::{Value, json};

use super::bench::{Bench, csv, driven};
use crate::store_contract::samples::{all, maintained, measured, registered};

/// Measures KGM every 250 hours in a life that begins at a usage and ends after as many hours, up to a part of it.
async fn aged(bench: &Bench, actuator: Id, start: i64, life: i64, part: f64) {
    for age in (0..).map(|i| 250 * i + 50).take_while(|&age| age as f64 <= part * life as f64) {
        measured(&*bench.records, actuator, start + age, Some(0.4 * age as f64 / life as f64)).await;
    }
}

/// The forecast of KGM as the actuator is now.
async fn forecast(bench: &Bench, actuator: Id) -> Value {
    let actuator: Actuator = bench.records.actuator(actuator).await.unwrap().unwrap();
    bench.jobs.forecast(&actuator).await.unwrap().document["faults"]["kgm"].clone()
}

fn median(forecast: &Value) -> f64 {
    forecast["forecast"]["quantiles"]["0.5"].as_f64().unwrap()
}

/// A bench with five actuators of its cohort that are worn after about 5000 h.
async fn worn_fleet(dir: &std::path::Path) -> Bench {
    let bench = Bench::open(dir, driven(), Models).await;
    for (i, life) in [4600, 5300, 4900, 5600, 5100].into_iter().enumerate() {
        let id = registered(&*bench.records, &format!("worn {i}")).await.id;
        aged(&bench, id, 0, life, 0.95).await;
        forecast(&bench, id).await;
    }
    bench
}

#[tokio::test]
async fn a_young_part_is_forecast_like_the_worn_ones_of_its_cohort() {
    let dir = tempfile::tempdir().unwrap();
    let bench = worn_fleet(dir.path()).await;
    let young = registered(&*bench.records, "young").await.id;
    measured(&*bench.records, young, 300, Some(0.02)).await;
    let among_them = forecast(&bench, young).await;
    assert_eq!(among_them["learnt_from"], json!({"actuators": 5, "earlier_lives": 0}));
    assert!((median(&among_them) - 4700.0).abs() < 1000.0, "{among_them}");

    let other = ActuatorUpdate { threshold_kgm: Some(0.41), ..ActuatorUpdate::default() };
    bench.records.change_actuator(young, &other).await.unwrap();
    let alone = forecast(&bench, young).await;
    assert_eq!(alone["learnt_from"], json!({"actuators": 0, "earlier_lives": 0}), "no other has its threshold");
    assert!(median(&alone) < 3200.0, "by its age alone: {alone}");
}

#[tokio::test]
async fn a_part_is_forecast_like_its_own_earlier_lives_rather_than_others() {
    let dir = tempfile::tempdir().unwrap();
    let bench = worn_fleet(dir.path()).await;
    let id = registered(&*bench.records, "again and again").await.id;
    for life in 0..2 {
        aged(&bench, id, 2000 * life, 2000, 0.95).await;
        maintained(&*bench.records, id, MaintenanceKind::Overhauled, 2000 * (life + 1)).await;
    }
    measured(&*bench.records, id, 4100, Some(0.02)).await;
    let third = forecast(&bench, id).await;
    assert_eq!(third["learnt_from"], json!({"actuators": 5, "earlier_lives": 2}));
    assert!((median(&third) - 1900.0).abs() < 600.0, "{third}");
}

#[tokio::test]
async fn what_is_learnt_of_an_ended_life_follows_its_history() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    aged(&bench, id, 0, 4000, 0.5).await;
    maintained(&*bench.records, id, MaintenanceKind::Replaced, 4000).await;
    let next = registered(&*bench.records, "B").await.id;
    measured(&*bench.records, next, 100, Some(0.01)).await;
    let told = async || {
        forecast(&bench, id).await;
        let cohort = "model 1, reference, flight_hours, kgm from 0 to 0.4";
        bench.records.fleet_tally(cohort, next).await.unwrap()
    };
    let before = told().await;
    assert_eq!(before.actuators, 1, "the ended life counts though nothing of the next was seen");
    measured(&*bench.records, id, 3900, Some(0.2)).await;
    let after = told().await;
    assert_ne!(before.tally, after.tally, "a late trace of the ended life");
    assert_eq!(after.actuators, 1);
}

#[tokio::test]
async fn a_part_that_was_in_service_before_its_first_trace_neither_teaches_nor_learns() {
    let dir = tempfile::tempdir().unwrap();
    let bench = worn_fleet(dir.path()).await;
    let taken_over = registered(&*bench.records, "taken over").await.id;
    for i in 0..4 {
        measured(&*bench.records, taken_over, 6000 + 100 * i, Some(0.2 + 0.01 * i as f64)).await;
    }
    let alone = forecast(&bench, taken_over).await;
    assert_eq!(alone["learnt_from"], json!({"actuators": 0, "earlier_lives": 0}));
    let next = registered(&*bench.records, "next").await.id;
    measured(&*bench.records, next, 300, Some(0.02)).await;
    assert_eq!(forecast(&bench, next).await["learnt_from"], json!({"actuators": 5, "earlier_lives": 0}));
    maintained(&*bench.records, taken_over, MaintenanceKind::Replaced, 7000).await;
    measured(&*bench.records, taken_over, 7100, Some(0.01)).await;
    let renewed = forecast(&bench, taken_over).await;
    assert_eq!(renewed["learnt_from"], json!({"actuators": 6, "earlier_lives": 0}), "an event began this life");
}

#[tokio::test]
async fn a_late_trace_of_an_ended_life_is_forecast_without_what_came_after_it() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let steps = async |id: Id, later: bool| {
        aged(&bench, id, 0, 9000, 0.15).await;
        if later {
            aged(&bench, id, 1500, 9000 - 1500, 0.9).await;
            maintained(&*bench.records, id, MaintenanceKind::Replaced, 9000).await;
            measured(&*bench.records, id, 9100, Some(0.0)).await;
            forecast(&bench, id).await;
        }
        let (late, _) = bench.upload(id, 1400, csv()).await;
        bench.run_all().await;
        let steps = bench.records.trend(id, None, None, &all()).await.unwrap().items;
        steps.into_iter().find(|step| step.trace_id == late.id).unwrap()
    };
    let one = registered(&*bench.records, "one").await.id;
    let cohort =
        ActuatorUpdate { threshold_kgm: Some(0.39), threshold_fdj_n: Some(990.0), ..ActuatorUpdate::default() };
    let other = registered(&*bench.records, "other").await.id;
    bench.records.change_actuator(other, &cohort).await.unwrap();
    let back = ActuatorUpdate { threshold_kgm: Some(0.4), threshold_fdj_n: Some(1000.0), ..ActuatorUpdate::default() };
    let first = steps(one, true).await;
    // The first leaves the cohort, so that the second has nobody to learn from either.
    bench.records.change_actuator(one, &cohort).await.unwrap();
    forecast(&bench, one).await;
    bench.records.change_actuator(other, &back).await.unwrap();
    let second = steps(other, false).await;
    assert_eq!(first.faults, second.faults);
}

#[tokio::test]
async fn another_question_does_not_move_a_forecast_whatever_others_have_taught_since() {
    let dir = tempfile::tempdir().unwrap();
    let bench = worn_fleet(dir.path()).await;
    let young = registered(&*bench.records, "young").await.id;
    measured(&*bench.records, young, 300, Some(0.02)).await;
    let kept = forecast(&bench, young).await;
    for i in 0..3 {
        let id = registered(&*bench.records, &format!("short {i}")).await.id;
        aged(&bench, id, 0, 1500, 0.95).await;
        forecast(&bench, id).await;
    }
    let actuator = bench.records.actuator(young).await.unwrap().unwrap();
    let asked = bench.jobs.remaining_life(&actuator, Some(777.0), None).await.unwrap();
    let kgm = &asked["faults"]["kgm"];
    assert_eq!(kgm["risk"]["within"], 777.0);
    for same in ["learnt_from", "act_by", "band"] {
        assert_eq!(kgm[same], kept[same], "{same}");
    }
    assert_eq!(kgm["forecast"]["quantiles"], kept["forecast"]["quantiles"]);
    measured(&*bench.records, young, 310, Some(0.02)).await;
    let next = forecast(&bench, young).await;
    assert_eq!(next["learnt_from"], json!({"actuators": 8, "earlier_lives": 0}));
    assert!(median(&next) < 0.9 * median(&kept), "the next estimate learns of the others: {next}");
}
