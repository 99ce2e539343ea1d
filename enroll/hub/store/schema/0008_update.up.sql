-- Updates of the image of doors: the files, and how far a zone is with a version.
CREATE TABLE update_file (
    version text NOT NULL,
    board text NOT NULL,
    size bigint NOT NULL CHECK (size > 0),
    sha256 bytea NOT NULL CHECK (length(sha256) = 32),
    added_s bigint NOT NULL,
    PRIMARY KEY (version, board)
);

CREATE TABLE rollout (
    id uuid PRIMARY KEY,
    version text NOT NULL,
    zone uuid NOT NULL REFERENCES zone,
    state text NOT NULL CHECK (state IN ('running', 'stopped', 'done', 'replaced')),
    why text NOT NULL DEFAULT '', -- it was stopped
    stage bigint NOT NULL DEFAULT 1,
    most bigint NOT NULL CHECK (most > 0), -- doors that are told up to the end of this stage
    told bigint NOT NULL DEFAULT 0, -- doors that count, when they were counted last
    stop_after bigint NOT NULL, -- failures
    wait_s bigint NOT NULL, -- between two stages
    started_s bigint NOT NULL,
    counted_s bigint NOT NULL, -- when the doors were counted last
    watched_s bigint NOT NULL -- since when they are counted without a long pause
);
-- A zone has one rollout at a time.
CREATE UNIQUE INDEX rollout_current ON rollout (zone) WHERE state IN ('running', 'stopped');

CREATE TABLE rollout_door (
    rollout uuid NOT NULL REFERENCES rollout,
    door uuid NOT NULL REFERENCES door,
    state text NOT NULL DEFAULT 'waiting' CHECK (state IN ('waiting', 'told', 'fetching', 'installed', 'healthy', 'failed', 'went-back', 'unable')),
    counts boolean NOT NULL DEFAULT false, -- it was told, and its failure is one of those that stop the rollout
    changed_s bigint NOT NULL,
    fault text NOT NULL DEFAULT '',
    board text NOT NULL DEFAULT '', -- for which its file is
    PRIMARY KEY (rollout, door)
);
CREATE INDEX rollout_door_door ON rollout_door (door);
