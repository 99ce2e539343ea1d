-- The certificates that the hub has signed for the doors: for the list of revoked ones, and so that a
-- door can renew its own.
CREATE TABLE door_certificate (
    door uuid NOT NULL REFERENCES door,
    serial bytea PRIMARY KEY CHECK (length(serial) = 16),
    ends_s bigint NOT NULL,
    key bytea NOT NULL CHECK (length(key) = 32) -- SHA-256 of the public key
);
CREATE INDEX door_certificate_door ON door_certificate (door);
CREATE INDEX door_certificate_key ON door_certificate (key);
