//! Alerts that follow their forecasts: raised once, cleared by a margin, whatever happens to the process.

use std::sync::{Arc, Mutex};

use elevon::jobs::JobSettings;
use elevon::jobs::alerts::AlertSettings;
use elevon::jobs::run::fleet::KnownLives;
use elevon::jobs::run::predict::{Predicted, Risk, RiskQuestion};
use elevon::jobs::run::{Compute, Finding, Models, RunError, Work};
use elevon::numeric::watch::Watch;
use elevon::store::alerts::{AlertFault, AlertKind, AlertState, ClearedBecause};
use elevon::store::records::{Actuator, Id, MaintenanceKind};
use elevon::store::webhooks::Event;
use elevon::store::{LifeHistory, Records};

use super::bench::{Bench, driven};
use crate::store_contract::alerts::alerts;
use crate::store_contract::samples::{all, maintained, measured, registered};
use crate::store_contract::webhooks::{hook, told};

/// The models, whose forecasts say what a test wants: a risk, and whether KGM has reached its threshold.
#[derive(Clone, Default)]
struct Told(Arc<Mutex<(f64, bool)>>);

impl Compute for Told {
    fn compute(&self, work: Work, watch: &dyn Watch) -> Result<Finding, RunError> {
        Models.compute(work, watch)
    }

    fn predict(
        &self,
        actuator: &Actuator,
        history: &LifeHistory,
        known: &KnownLives,
        asked: &RiskQuestion,
    ) -> Predicted {
        let (probability, reached) = *self.0.lock().unwrap();
        let mut predicted = Models.predict(actuator, history, known, asked);
        let life = &mut predicted.life;
        life.risk = life.risk.map(|risk| Risk { probability, ..risk });
        if let Some(forecast) = &mut life.faults.kgm.forecast {
            forecast.forecast.reached = reached;
        }
        predicted
    }
}

/// A bench whose forecasts are told, and an actuator.
struct Stage {
    bench: Bench,
    told: Told,
    actuator: Id,
    second: i64,
}

impl Stage {
    async fn open(dir: &std::path::Path) -> Self {
        let told = Told::default();
        let bench = Bench::open(dir, driven(), told.clone()).await;
        let actuator = registered(&*bench.records, "A").await.id;
        let mut stage = Self { bench, told, actuator, second: 0 };
        stage.estimate(0.1, 0.0, false).await;
        stage
    }

    /// A new estimate of KGM, and a forecast that says this of it.
    async fn estimate(&mut self, kgm: f64, risk: f64, reached: bool) {
        self.second += 10;
        measured(&*self.bench.records, self.actuator, self.second, Some(kgm)).await;
        *self.told.0.lock().unwrap() = (risk, reached);
        forecast(&self.bench, self.actuator).await;
    }
}

async fn forecast(bench: &Bench, actuator: Id) {
    let actuator = bench.records.actuator(actuator).await.unwrap().unwrap();
    bench.jobs.forecast(&actuator).await.unwrap();
}

/// The open alerts of an actuator.
async fn open(records: &dyn Records, actuator: Id) -> Vec<(AlertKind, Option<AlertFault>)> {
    records.open_alerts(actuator).await.unwrap().iter().map(|alert| (alert.kind, alert.fault)).collect()
}

const RISK: (AlertKind, Option<AlertFault>) = (AlertKind::Risk, None);
const KGM: (AlertKind, Option<AlertFault>) = (AlertKind::Threshold, Some(AlertFault::Kgm));

#[tokio::test]
async fn a_risk_that_swings_makes_one_alert_and_one_notification_for_each_true_change() {
    let dir = tempfile::tempdir().unwrap();
    let mut stage = Stage::open(dir.path()).await;
    let webhook = hook(&*stage.bench.records, &AlertKind::ALL).await;
    let before = [0.04, 0.09, 0.06, 0.099, 0.051];
    let swinging = [0.12, 0.09, 0.11, 0.06, 0.101, 0.099, 0.051];
    let after = [0.049, 0.051, 0.049, 0.099, 0.06];
    for (risks, expected) in [(&before[..], &[][..]), (&swinging, &[RISK]), (&after, &[])] {
        for risk in risks {
            stage.estimate(0.1, *risk, false).await;
            assert_eq!(open(&*stage.bench.records, stage.actuator).await, expected, "{risk}");
        }
    }
    let alert = alerts(&*stage.bench.records).await;
    assert_eq!(alert.len(), 1);
    assert_eq!((alert[0].risk, alert[0].limit, alert[0].within), (Some(0.12), Some(0.1), Some(100.0)));
    assert_eq!((alert[0].usage, alert[0].cleared_because), (70.0, Some(ClearedBecause::RiskFell)));
    assert_eq!(told(&*stage.bench.records, webhook).await, [Event::Cleared, Event::Raised]);
}

#[tokio::test]
async fn a_threshold_alert_outlasts_noise_and_ends_well_below_the_threshold() {
    let dir = tempfile::tempdir().unwrap();
    let mut stage = Stage::open(dir.path()).await;
    // The standard deviation of every estimate is 0.01; 0.9 of the threshold is 0.36.
    for (kgm, reached, expected) in [
        (0.38, false, &[][..]),
        (0.41, true, &[KGM]),
        (0.39, false, &[KGM]),
        (0.42, true, &[KGM]),
        (0.355, false, &[KGM]),
        (0.34, true, &[KGM]),
        (0.34, false, &[]),
        (0.39, false, &[]),
    ] {
        stage.estimate(kgm, 0.07, reached).await;
        assert_eq!(open(&*stage.bench.records, stage.actuator).await, expected, "{kgm} {reached}");
    }
    let alert = alerts(&*stage.bench.records).await;
    assert_eq!(alert.len(), 1);
    assert_eq!((alert[0].value, alert[0].value_std, alert[0].threshold), (Some(0.41), Some(0.01), Some(0.4)));
    assert_eq!(alert[0].cleared_because, Some(ClearedBecause::LevelFell));
}

#[tokio::test]
async fn the_same_forecast_again_and_a_start_raise_nothing_twice() {
    let dir = tempfile::tempdir().unwrap();
    let mut stage = Stage::open(dir.path()).await;
    let webhook = hook(&*stage.bench.records, &AlertKind::ALL).await;
    stage.estimate(0.41, 0.9, true).await;
    let Stage { bench, told: compute, actuator, .. } = stage;
    let first = alerts(&*bench.records).await;
    assert_eq!(first.len(), 2);
    for _ in 0..2 {
        bench.records.expire_forecasts("another basis").await.unwrap();
        forecast(&bench, actuator).await;
    }
    drop(bench);
    let again = Bench::open(dir.path(), driven(), compute).await;
    again.records.expire_forecasts("another basis").await.unwrap();
    again.jobs.start().await.unwrap();
    again.jobs.refresh_stale().await.unwrap();
    again.jobs.stop().await;
    assert_eq!(alerts(&*again.records).await, first);
    assert_eq!(told(&*again.records, webhook).await, [Event::Raised, Event::Raised]);
}

#[tokio::test]
async fn maintenance_clears_and_the_new_life_is_judged_by_its_own_estimates() {
    let dir = tempfile::tempdir().unwrap();
    let mut stage = Stage::open(dir.path()).await;
    stage.estimate(0.41, 0.9, true).await;
    let former = alerts(&*stage.bench.records).await;
    stage.bench.records.acknowledge_alert(former[0].id, "ordered", former[0].raised_at).await.unwrap();
    maintained(&*stage.bench.records, stage.actuator, MaintenanceKind::Replaced, 25).await;
    let cleared = stage.bench.records.alerts(Some(AlertState::Cleared), None, &all()).await.unwrap().items;
    assert_eq!(cleared.len(), 2);
    assert!(cleared.iter().all(|alert| alert.cleared_because == Some(ClearedBecause::Maintenance)), "{cleared:?}");
    forecast(&stage.bench, stage.actuator).await;
    assert_eq!(open(&*stage.bench.records, stage.actuator).await, [], "no estimate of the new life yet");
    stage.estimate(0.01, 0.0, false).await;
    assert_eq!(open(&*stage.bench.records, stage.actuator).await, []);
    stage.estimate(0.41, 0.02, true).await;
    assert_eq!(open(&*stage.bench.records, stage.actuator).await, [KGM]);
    assert_eq!(alerts(&*stage.bench.records).await.len(), 3);
}

#[tokio::test]
async fn other_bounds_make_every_forecast_anew_at_the_start_and_judge_it_by_them() {
    let dir = tempfile::tempdir().unwrap();
    let mut stage = Stage::open(dir.path()).await;
    stage.estimate(0.1, 0.08, false).await;
    assert_eq!(open(&*stage.bench.records, stage.actuator).await, []);
    let Stage { bench, told, actuator, .. } = stage;
    drop(bench);
    let alerts = AlertSettings { risk_raise: 0.06, risk_clear: 0.03, ..AlertSettings::default() };
    let strict = Bench::open(dir.path(), JobSettings { alerts, ..driven() }, told).await;
    strict.jobs.start().await.unwrap();
    strict.jobs.refresh_stale().await.unwrap();
    assert_eq!(open(&*strict.records, actuator).await, [RISK]);
    strict.jobs.stop().await;
}

#[tokio::test]
async fn the_models_own_forecast_raises_what_a_history_beyond_its_threshold_shows() {
    let dir = tempfile::tempdir().unwrap();
    let bench = Bench::open(dir.path(), driven(), Models).await;
    let id = registered(&*bench.records, "A").await.id;
    for i in 1..=4 {
        measured(&*bench.records, id, 100 * i, Some(0.002 * i as f64)).await;
    }
    forecast(&bench, id).await;
    assert_eq!(open(&*bench.records, id).await, []);
    let mut last = Id::now();
    for i in 5..=20 {
        last = measured(&*bench.records, id, 100 * i, Some(0.04 * (i - 4) as f64)).await;
    }
    forecast(&bench, id).await;
    let mut found = open(&*bench.records, id).await;
    found.sort_by_key(|(kind, _)| *kind);
    assert_eq!(found, [KGM, RISK]);
    let raised = bench.records.open_alerts(id).await.unwrap();
    assert!(raised.iter().all(|alert| alert.trace_id == Some(last) && alert.usage == 2000.0), "{raised:?}");
    assert!(raised.iter().any(|alert| alert.message.contains("KGM") && alert.message.contains("0.4")), "{raised:?}");
}
