ALTER TABLE rollout_door DROP finished_s;
ALTER TABLE rollout_door DROP work_from_s;
ALTER TABLE rollout_door DROP work_s;
ALTER TABLE rollout DROP clock_s;
