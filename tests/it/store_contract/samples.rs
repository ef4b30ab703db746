//! Records for tests, and the way to bring them into a store.

use elevon::estimation::{Estimate, Verdict};
use elevon::store::records::{
    Actuator, ForecastRecord, Id, JobKind, Maintenance, MaintenanceKind, NewJob, Outcome, ParameterSetRecord,
    Thresholds, TraceRecord, TrendFaults, TrendFigures, TrendRecord, UsageUnit, now,
};
use elevon::store::{Page, Records};
use jiff::Timestamp;
use serde_json::json;

/// A queue that is never full.
pub const ROOMY: u64 = 1_000_000;

/// A time: seconds since the epoch.
pub fn at(second: i64) -> Timestamp {
    Timestamp::from_second(second).unwrap()
}

/// The first page, of everything.
pub fn all() -> Page {
    Page { after: None, limit: 500 }
}

pub fn actuator(serial_number: &str) -> Actuator {
    Actuator {
        id: Id::now(),
        serial_number: serial_number.into(),
        tail_number: "I-ABCD".into(),
        location: "left aileron".into(),
        parameter_set: "reference".into(),
        parameter_set_hash: "00".into(),
        thresholds: Thresholds::default(),
        usage_unit: UsageUnit::FlightHours,
        created_at: now(),
        revision: 0,
    }
}

/// A kept actuator.
pub async fn registered(records: &dyn Records, serial_number: &str) -> Actuator {
    let actuator = actuator(serial_number);
    records.insert_actuator(&actuator).await.unwrap();
    actuator
}

/// A trace of an actuator, recorded at a second and with as much usage.
pub fn trace(actuator: Id, second: i64) -> TraceRecord {
    TraceRecord {
        id: Id::now(),
        actuator_id: Some(actuator),
        recorded_at: Some(at(second)),
        usage: Some(second as f64),
        media_type: "text/csv".into(),
        columns: "Cor:servovalve_current_ma".into(),
        sample_rate_hz: Some(1e4),
        size_bytes: 12,
        sha256: "ab".repeat(32),
        samples: 20_001,
        duration_s: 2.0,
        excluded: false,
        reason: String::new(),
        created_at: now(),
    }
}

/// A version of a parameter set; whatever its hash, the store takes it.
pub fn parameter_set(name: &str, hash: &str) -> ParameterSetRecord {
    let parameters = json!({"jack": {"area_m2": 0.1 + 0.2, "mass_kg": 10}, "oil": "constant"});
    ParameterSetRecord { id: Id::now(), name: name.into(), hash: hash.into(), parameters, created_at: now() }
}

pub fn job() -> NewJob {
    NewJob { id: Id::now(), kind: JobKind::Estimation, spec: json!({"of": "a test"}), created_at: now() }
}

/// A kept job.
pub async fn queued(records: &dyn Records) -> Id {
    let job = job();
    records.insert_job(&job, ROOMY).await.unwrap();
    job.id
}

/// An estimate with a KGM, or an inconclusive one.
pub fn estimate(kgm: Option<f64>) -> Estimate {
    Estimate {
        kgm,
        kgm_std: kgm.map(|_| 0.01),
        fdj_n: kgm.map(|_| 400.0),
        fdj_n_std: kgm.map(|_| 8.0),
        cost: Some(0.5),
        evaluations: 440,
        method: "ga".into(),
        seed: 1,
        objective: "features".into(),
        verdict: if kgm.is_some() { Verdict::Conclusive } else { Verdict::Inconclusive },
        reasons: Vec::new(),
        faults: Default::default(),
        parameter_set_hash: "00".into(),
        version: elevon::VERSION.into(),
    }
}

pub fn estimated(trace_id: Id, kgm: Option<f64>) -> Outcome {
    Outcome::Estimated { trace_id, estimate: Box::new(estimate(kgm)), result: json!({"kgm": kgm}) }
}

/// Claims a queued job and ends its attempt with an estimate.
pub async fn finish(records: &dyn Records, job: Id, trace: Id, kgm: Option<f64>) {
    let attempt = records.claim_job(job, now()).await.unwrap().unwrap().attempt;
    assert!(records.finish_job(job, attempt, &estimated(trace, kgm), now()).await.unwrap());
}

/// Keeps a trace and its estimate; the trace's id.
pub async fn measured(records: &dyn Records, actuator: Id, second: i64, kgm: Option<f64>) -> Id {
    let (trace, job) = (trace(actuator, second), job());
    records.insert_upload(&trace, &job, ROOMY).await.unwrap();
    finish(records, job.id, trace.id, kgm).await;
    trace.id
}

/// Keeps a maintenance event.
pub async fn maintained(records: &dyn Records, actuator_id: Id, kind: MaintenanceKind, second: i64) -> Maintenance {
    let (id, created_at) = (Id::now(), now());
    let (at, usage) = (at(second), second as f64);
    let event = Maintenance { id, actuator_id, kind, at, usage, note: "as planned".into(), created_at };
    records.insert_maintenance(&event).await.unwrap();
    event
}

pub fn forecast(actuator_id: Id, revision: i64, risk: Option<f64>, median_remaining: Option<f64>) -> ForecastRecord {
    let document = json!({"made_from": revision});
    ForecastRecord { actuator_id, revision, risk, median_remaining, document, basis: "this".into(), created_at: now() }
}

/// A step of a trend at a trace of the first life, recorded at a second and with as much usage.
pub fn step(actuator_id: Id, trace_id: Id, second: i64) -> TrendRecord {
    let figures = |q50: f64| TrendFigures {
        q05: Some(0.1 + 0.2),
        q50: Some(q50),
        q95: None,
        mean: Some(1e-300),
        reached: false,
        risk: Some(0.25),
    };
    TrendRecord {
        actuator_id,
        life_started_at: None,
        life_start_usage: None,
        trace_id,
        recorded_at: at(second),
        usage: second as f64,
        made_at: now(),
        risk_window: 100.0,
        actuator: Some(figures(10.0)),
        faults: TrendFaults { kgm: Some(figures(20.0)), fdj_n: None },
        basis: "this".into(),
        version: elevon::VERSION.into(),
    }
}
