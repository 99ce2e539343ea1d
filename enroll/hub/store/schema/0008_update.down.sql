DROP TABLE rollout_door;
DROP TABLE rollout;
DROP TABLE update_file;
