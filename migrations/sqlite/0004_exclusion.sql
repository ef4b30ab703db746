-- A trace that is excluded stays, and its estimates with it, but no history shows them. The history's row repeats it so that a
-- page is read from one table.
ALTER TABLE traces ADD COLUMN excluded INTEGER NOT NULL DEFAULT 0;
ALTER TABLE traces ADD COLUMN reason TEXT NOT NULL DEFAULT '';
ALTER TABLE health ADD COLUMN excluded INTEGER NOT NULL DEFAULT 0;
