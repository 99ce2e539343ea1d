-- Zones: a group of doors with the same people, and how far its stream of changes has come.
CREATE TABLE zone (
    id uuid PRIMARY KEY,
    name text NOT NULL UNIQUE,
    epoch bigint NOT NULL DEFAULT 1 CHECK (epoch >= 1),
    sequence bigint NOT NULL DEFAULT 0 CHECK (sequence >= 0),
    digest bytea NOT NULL CHECK (length(digest) = 32),
    key bytea NOT NULL, -- of the epoch, sealed with the hub's storage key
    base_sequence bigint NOT NULL DEFAULT 0,
    base_digest bytea NOT NULL CHECK (length(base_digest) = 32),
    reset_epoch bigint NOT NULL DEFAULT 0,
    reset_sequence bigint NOT NULL DEFAULT 0,
    lease_s bigint NOT NULL CHECK (lease_s BETWEEN 0 AND 4294967295),
    local_people boolean NOT NULL DEFAULT false,
    approve_auto boolean NOT NULL DEFAULT false,
    lockdown boolean NOT NULL DEFAULT false,
    behind boolean NOT NULL DEFAULT false, -- a door knows more than this database
    policy text NOT NULL DEFAULT '',
    published bigint NOT NULL DEFAULT 0,
    published_epoch bigint NOT NULL DEFAULT 0
);

CREATE TABLE door (
    id uuid PRIMARY KEY,
    name text NOT NULL,
    signs bytea CHECK (length(signs) = 32),
    receives bytea CHECK (length(receives) = 32),
    added_s bigint NOT NULL,
    joined_s bigint NOT NULL DEFAULT 0,
    expelled_s bigint NOT NULL DEFAULT 0,
    code_digest bytea UNIQUE,
    code_until_s bigint NOT NULL DEFAULT 0,
    online boolean NOT NULL DEFAULT false,
    reported_s bigint NOT NULL DEFAULT 0,
    door_time_s bigint NOT NULL DEFAULT 0,
    algorithm bigint NOT NULL DEFAULT 0,
    last_event bigint NOT NULL DEFAULT 0,
    acked bigint NOT NULL DEFAULT 0,
    health text NOT NULL DEFAULT ''
);
-- The name and the appliance of an expelled door may be used again.
CREATE UNIQUE INDEX door_name ON door (name) WHERE expelled_s = 0;
CREATE UNIQUE INDEX door_signs ON door (signs) WHERE expelled_s = 0;

-- The zones of a door; position 0 is its home.
CREATE TABLE door_zone (
    door uuid NOT NULL REFERENCES door,
    zone uuid NOT NULL REFERENCES zone,
    position bigint NOT NULL,
    PRIMARY KEY (door, zone)
);
CREATE INDEX door_zone_zone ON door_zone (zone);

-- The places that a door has reported last.
CREATE TABLE door_place (
    door uuid NOT NULL REFERENCES door,
    zone uuid NOT NULL REFERENCES zone,
    epoch bigint NOT NULL,
    sequence bigint NOT NULL,
    digest bytea NOT NULL CHECK (length(digest) = 32),
    PRIMARY KEY (door, zone)
);

CREATE SEQUENCE person_revision;

CREATE TABLE person (
    id uuid PRIMARY KEY,
    name text NOT NULL,
    folded text NOT NULL UNIQUE, -- the common form of all spellings of the name
    revision bigint NOT NULL,
    valid_from_s bigint NOT NULL DEFAULT 0,
    valid_until_s bigint NOT NULL DEFAULT 0,
    enrolled_s bigint NOT NULL DEFAULT 0,
    offline_ok boolean NOT NULL DEFAULT false,
    credential bytea -- sealed, because it contains PINs; NULL: the default
);

CREATE TABLE person_zone (
    person uuid NOT NULL REFERENCES person ON DELETE CASCADE,
    zone uuid NOT NULL REFERENCES zone,
    PRIMARY KEY (zone, person)
);
CREATE INDEX person_zone_person ON person_zone (person);

CREATE TABLE template (
    person uuid NOT NULL REFERENCES person ON DELETE CASCADE,
    number bigint NOT NULL,
    algorithm bigint NOT NULL,
    sealed bytea NOT NULL,
    PRIMARY KEY (person, number)
);

-- The stream of each zone. It is also the queue of what is to be published.
CREATE TABLE delta (
    zone uuid NOT NULL REFERENCES zone,
    sequence bigint NOT NULL,
    epoch bigint NOT NULL,
    digest bytea NOT NULL CHECK (length(digest) = 32),
    bytes bytea NOT NULL,
    PRIMARY KEY (zone, sequence)
);

CREATE TABLE snapshot (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    zone uuid NOT NULL REFERENCES zone,
    epoch bigint NOT NULL,
    sequence bigint NOT NULL,
    made_s bigint NOT NULL
);
CREATE INDEX snapshot_zone ON snapshot (zone);

CREATE TABLE snapshot_chunk (
    snapshot bigint NOT NULL REFERENCES snapshot ON DELETE CASCADE,
    number bigint NOT NULL,
    bytes bytea NOT NULL,
    PRIMARY KEY (snapshot, number)
);

-- Sealed bytes do not become smaller by compression.
ALTER TABLE template ALTER sealed SET STORAGE EXTERNAL;
ALTER TABLE delta ALTER bytes SET STORAGE EXTERNAL;
ALTER TABLE snapshot_chunk ALTER bytes SET STORAGE EXTERNAL;

-- The records of the doors' logs. Sealed once, they are never changed.
CREATE TABLE event (
    door uuid NOT NULL,
    number bigint NOT NULL,
    time text NOT NULL,
    record jsonb NOT NULL,
    PRIMARY KEY (door, number)
) PARTITION BY HASH (door);
CREATE TABLE event_0 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 0);
CREATE TABLE event_1 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 1);
CREATE TABLE event_2 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 2);
CREATE TABLE event_3 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 3);
CREATE TABLE event_4 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 4);
CREATE TABLE event_5 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 5);
CREATE TABLE event_6 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 6);
CREATE TABLE event_7 PARTITION OF event FOR VALUES WITH (MODULUS 8, REMAINDER 7);
CREATE INDEX event_time ON event (time);

-- People who were enrolled at a door. state: 0 waits, 1 approved, 2 rejected.
CREATE TABLE request (
    person uuid PRIMARY KEY,
    door uuid NOT NULL REFERENCES door,
    name text NOT NULL,
    digest bytea NOT NULL, -- of the templates, which says whether a request is a new one
    sealed bytea,          -- the person with templates; NULL after the decision
    time_s bigint NOT NULL,
    state bigint NOT NULL DEFAULT 0 CHECK (state BETWEEN 0 AND 2)
);

-- What people did to the fleet.
CREATE TABLE act (
    number bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    time_s bigint NOT NULL,
    actor text NOT NULL,
    what text NOT NULL,
    object text NOT NULL,
    before jsonb,
    after jsonb
);
