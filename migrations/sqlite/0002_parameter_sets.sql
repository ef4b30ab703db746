-- A row is a version of a parameter set and never changes. The newest version of a name is the one with the greatest id.
CREATE TABLE parameter_sets (
    id TEXT PRIMARY KEY NOT NULL,
    name TEXT NOT NULL,
    hash TEXT NOT NULL,
    parameters TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    UNIQUE (name, hash)
) STRICT;
CREATE INDEX parameter_sets_by_name ON parameter_sets (name, id);

-- The version that the actuator is pinned to. Every actuator registered before has the built-in set, whose version every
-- start of the service writes here.
ALTER TABLE actuators ADD COLUMN parameter_set_hash TEXT NOT NULL DEFAULT '';
