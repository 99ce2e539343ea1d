ALTER TABLE rollout_door DROP stuck;
ALTER TABLE rollout_door DROP mute_s;
