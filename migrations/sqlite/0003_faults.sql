-- The other faults that the newest estimate of a trace was asked for, by their names with units, and their standard deviations:
-- the object `faults` of an estimate. What was estimated before has it in the result of its job.
ALTER TABLE health ADD COLUMN faults TEXT NOT NULL DEFAULT '{}';
UPDATE health SET faults = coalesce(
    (SELECT json_extract(result, '$.faults') FROM jobs WHERE id = health.job_id AND json_type(result, '$.faults') = 'object'),
    '{}');
