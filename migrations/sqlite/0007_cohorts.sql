-- What an actuator's lives say of those of its cohort, by one fault: signed numbers of 4 bytes, the least significant first. `cohort` names
-- those whose lives can be compared. `prior` is what the actuator's own forecast took from its fleet: floating-point numbers of 8 bytes.
CREATE TABLE fleet_shares (
    actuator_id TEXT NOT NULL REFERENCES actuators (id),
    fault TEXT NOT NULL,
    cohort TEXT NOT NULL,
    tally BLOB NOT NULL,
    prior BLOB NOT NULL,
    PRIMARY KEY (actuator_id, fault)
) STRICT, WITHOUT ROWID;

-- The sums of the shares of each cohort, as signed numbers of 8 bytes, changed with every share in one transaction.
CREATE TABLE fleet_tallies (
    cohort TEXT PRIMARY KEY NOT NULL,
    actuators INTEGER NOT NULL,
    tally BLOB NOT NULL
) STRICT, WITHOUT ROWID;
