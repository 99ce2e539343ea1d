DROP TABLE delta_digest;
DROP INDEX act_time, event_stored;
ALTER TABLE event DROP stored_s;
ALTER TABLE delta DROP made_s;
