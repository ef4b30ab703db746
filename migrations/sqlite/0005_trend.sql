-- How the forecasts of an actuator moved: one row for each trace of a life, what was forecast last while it was the newest. The least integer stands for the start of the first life, which began with the actuator. The figures of the actuator
-- have columns, those of its faults are an object; a forecast that could not be made is null, its `reached` with it.
CREATE TABLE forecast_trend (
    actuator_id TEXT NOT NULL REFERENCES actuators (id),
    life_started_at INTEGER NOT NULL,
    trace_id TEXT NOT NULL REFERENCES traces (id),
    life_start_usage REAL,
    recorded_at INTEGER NOT NULL,
    usage REAL NOT NULL,
    made_at INTEGER NOT NULL,
    risk_window REAL NOT NULL,
    q05 REAL,
    q50 REAL,
    q95 REAL,
    mean REAL,
    reached INTEGER,
    risk REAL,
    faults TEXT NOT NULL,
    basis TEXT NOT NULL,
    version TEXT NOT NULL,
    PRIMARY KEY (actuator_id, life_started_at, trace_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX forecast_trend_by_usage ON forecast_trend (actuator_id, life_started_at, usage, made_at, trace_id);
