-- Doors of a rollout that report, and whose stage would never end: since when a door that was told says nothing of its updates (0: it
-- does), and whether it failed because it stayed in one state for too long.
ALTER TABLE rollout_door ADD mute_s bigint NOT NULL DEFAULT 0;
ALTER TABLE rollout_door ADD stuck boolean NOT NULL DEFAULT false;
