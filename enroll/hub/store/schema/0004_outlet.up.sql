-- Where the events go out of the hub.
CREATE TABLE outlet (
    id uuid PRIMARY KEY,
    name text NOT NULL UNIQUE,
    kind text NOT NULL CHECK (kind IN ('webhook', 'syslog')),
    address text NOT NULL,
    secret bytea, -- sealed with the hub's storage key
    ca text, -- certificates in PEM; NULL: those of the system
    events text NOT NULL DEFAULT '', -- names, separated by commas; '': all
    added_s bigint NOT NULL,
    batch uuid, -- the key of the batch that is handed over; NULL: none
    batches bigint NOT NULL DEFAULT 0, -- that were handed over
    delivered bigint NOT NULL DEFAULT 0, -- events
    delivered_s bigint NOT NULL DEFAULT 0,
    failures bigint NOT NULL DEFAULT 0, -- since the last success
    next_attempt_ms bigint NOT NULL DEFAULT 0, -- since 1970
    stopped boolean NOT NULL DEFAULT false,
    trouble text NOT NULL DEFAULT ''
);

-- How far an outlet has come with the events of a door; a door without a row is at 0. Up to
-- batch_number goes the batch that is handed over.
CREATE TABLE outlet_cursor (
    outlet uuid NOT NULL REFERENCES outlet ON DELETE CASCADE,
    door uuid NOT NULL,
    number bigint NOT NULL,
    batch_number bigint NOT NULL CHECK (batch_number >= number),
    turn bigint NOT NULL DEFAULT 0, -- the number of the last batch in which the door was
    PRIMARY KEY (outlet, door)
);
