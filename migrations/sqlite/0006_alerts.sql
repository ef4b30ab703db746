-- An alert is open until it is cleared; there is one open alert for each kind and fault of an actuator, and none is ever deleted.
-- `life` is the maintenance event that began the life in which it was raised, '' for the first; `fault` is '' for the risk.
CREATE TABLE alerts (
    id TEXT PRIMARY KEY NOT NULL,
    actuator_id TEXT NOT NULL REFERENCES actuators (id),
    life TEXT NOT NULL,
    kind TEXT NOT NULL CHECK (kind IN ('threshold', 'risk')),
    fault TEXT NOT NULL,
    state TEXT NOT NULL DEFAULT 'open' CHECK (state IN ('open', 'acknowledged', 'cleared')),
    raised_at INTEGER NOT NULL,
    acknowledged_at INTEGER,
    cleared_at INTEGER,
    cleared_because TEXT,
    usage REAL NOT NULL,
    value REAL,
    value_std REAL,
    threshold REAL,
    risk REAL,
    risk_limit REAL,
    risk_within REAL,
    trace_id TEXT REFERENCES traces (id),
    message TEXT NOT NULL,
    note TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE UNIQUE INDEX alerts_open ON alerts (actuator_id, kind, fault) WHERE cleared_at IS NULL;
CREATE INDEX alerts_by_state ON alerts (state, id);
CREATE INDEX alerts_of_actuator ON alerts (actuator_id, id);

-- `kinds` is a JSON array of the kinds of alerts that a webhook is told of.
CREATE TABLE webhooks (
    id TEXT PRIMARY KEY NOT NULL,
    url TEXT NOT NULL,
    secret TEXT NOT NULL,
    kinds TEXT NOT NULL,
    enabled INTEGER NOT NULL,
    disabled_because TEXT,
    created_at INTEGER NOT NULL
) STRICT;

-- The outbox: what is to be told to a webhook is written with what it tells of, in one transaction, and sent afterwards. `body` is
-- sent as it is, at every attempt.
CREATE TABLE deliveries (
    id TEXT PRIMARY KEY NOT NULL,
    webhook_id TEXT NOT NULL REFERENCES webhooks (id) ON DELETE CASCADE,
    alert_id TEXT REFERENCES alerts (id),
    event TEXT NOT NULL,
    body TEXT NOT NULL,
    state TEXT NOT NULL DEFAULT 'pending' CHECK (state IN ('pending', 'delivered', 'failed')),
    attempts INTEGER NOT NULL DEFAULT 0,
    next_attempt_at INTEGER,
    last_status INTEGER,
    last_error TEXT,
    created_at INTEGER NOT NULL,
    delivered_at INTEGER
) STRICT;
CREATE INDEX deliveries_of_webhook ON deliveries (webhook_id, id);
CREATE INDEX deliveries_due ON deliveries (webhook_id, next_attempt_at, id) WHERE state = 'pending';
CREATE INDEX deliveries_over ON deliveries (created_at) WHERE state <> 'pending';
