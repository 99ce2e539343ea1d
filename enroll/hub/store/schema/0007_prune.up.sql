-- When deltas and events were stored, by which they are pruned; and the digests of pruned deltas, by
-- which a door of another history is still noticed.
ALTER TABLE delta ADD made_s bigint NOT NULL DEFAULT extract(epoch FROM now())::bigint;
ALTER TABLE event ADD stored_s bigint NOT NULL DEFAULT extract(epoch FROM now())::bigint;
CREATE INDEX event_stored ON event USING brin (stored_s);
CREATE INDEX act_time ON act (time_s);

CREATE TABLE delta_digest (
    zone uuid NOT NULL REFERENCES zone,
    sequence bigint NOT NULL,
    digest bytea NOT NULL CHECK (length(digest) = 32),
    PRIMARY KEY (zone, sequence)
);
