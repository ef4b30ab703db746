-- Times are microseconds since 1970-01-01 UTC; ids are UUIDs of version 7 as text, so that they sort by creation.

-- The order columns are what the fleet's list is sorted by: risk falling in whole percents (it is not known better), then
-- median remaining life rising, unknown last. A forecast of an older revision than the actuator's is stale; -1 is none at all.
CREATE TABLE actuators (
    id TEXT PRIMARY KEY NOT NULL,
    serial_number TEXT NOT NULL UNIQUE,
    tail_number TEXT NOT NULL,
    location TEXT NOT NULL,
    parameter_set TEXT NOT NULL,
    threshold_kgm REAL NOT NULL,
    threshold_fdj_n REAL NOT NULL,
    usage_unit TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    revision INTEGER NOT NULL DEFAULT 0,
    forecast_revision INTEGER NOT NULL DEFAULT -1,
    risk REAL,
    median_remaining REAL,
    risk_order REAL NOT NULL GENERATED ALWAYS AS (coalesce(-round(risk, 2), 1.0)) STORED,
    median_order REAL NOT NULL GENERATED ALWAYS AS (coalesce(median_remaining, 1e308)) STORED
) STRICT;
CREATE INDEX actuators_by_risk ON actuators (risk_order, median_order, id);
CREATE INDEX actuators_of_tail_by_risk ON actuators (tail_number, risk_order, median_order, id);
CREATE INDEX actuators_stale ON actuators (id) WHERE forecast_revision <> revision;

CREATE TABLE forecasts (
    actuator_id TEXT PRIMARY KEY NOT NULL REFERENCES actuators (id),
    created_at INTEGER NOT NULL,
    document TEXT NOT NULL,
    basis TEXT NOT NULL
) STRICT;

CREATE TABLE traces (
    id TEXT PRIMARY KEY NOT NULL,
    actuator_id TEXT REFERENCES actuators (id),
    recorded_at INTEGER,
    usage REAL,
    media_type TEXT NOT NULL,
    columns TEXT NOT NULL,
    sample_rate_hz REAL,
    size_bytes INTEGER NOT NULL,
    sha256 TEXT NOT NULL,
    samples INTEGER NOT NULL,
    duration_s REAL NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;

CREATE TABLE jobs (
    id TEXT PRIMARY KEY NOT NULL,
    kind TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
    progress REAL NOT NULL DEFAULT 0,
    attempt INTEGER NOT NULL DEFAULT 0,
    created_at INTEGER NOT NULL,
    started_at INTEGER,
    finished_at INTEGER,
    error TEXT,
    spec TEXT NOT NULL,
    result TEXT
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, id);

-- One row per trace, its newest estimate, kept in the order in which a history is read.
CREATE TABLE health (
    actuator_id TEXT NOT NULL REFERENCES actuators (id),
    recorded_at INTEGER NOT NULL,
    trace_id TEXT NOT NULL REFERENCES traces (id),
    job_id TEXT NOT NULL REFERENCES jobs (id),
    usage REAL NOT NULL,
    kgm REAL,
    kgm_std REAL,
    fdj_n REAL,
    fdj_n_std REAL,
    verdict TEXT NOT NULL,
    PRIMARY KEY (actuator_id, recorded_at, trace_id)
) STRICT, WITHOUT ROWID;

CREATE TABLE maintenance (
    actuator_id TEXT NOT NULL REFERENCES actuators (id),
    at INTEGER NOT NULL,
    id TEXT NOT NULL,
    kind TEXT NOT NULL CHECK (kind IN ('replaced', 'overhauled', 'inspected')),
    usage REAL NOT NULL,
    note TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    PRIMARY KEY (actuator_id, at, id)
) STRICT, WITHOUT ROWID;
