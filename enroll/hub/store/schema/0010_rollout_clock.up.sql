-- A rollout has a clock, which stands still while it is stopped and while the hub is away; the time that a door takes is measured by it, and
-- does not begin anew when the door goes and comes back.
ALTER TABLE rollout ADD clock_s bigint NOT NULL DEFAULT 0;
ALTER TABLE rollout_door ADD work_s bigint NOT NULL DEFAULT 0; -- for how long it was at work (told, fetching, installed), up to work_from_s
ALTER TABLE rollout_door ADD work_from_s bigint NOT NULL DEFAULT 0; -- since when it is at work, by the clock of the rollout
ALTER TABLE rollout_door ADD finished_s bigint NOT NULL DEFAULT 0; -- when it was healthy or failed; silence counts only the first time
UPDATE rollout_door SET finished_s = changed_s WHERE state IN ('healthy', 'failed', 'went-back');
