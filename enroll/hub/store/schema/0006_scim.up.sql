-- Users and groups of identity providers (SCIM). A user is a row of the directory, too, with the
-- source "scim" and its id as the id there.
CREATE TABLE scim_token (
    name text PRIMARY KEY,
    digest bytea NOT NULL UNIQUE CHECK (length(digest) = 32),
    added_s bigint NOT NULL,
    used_s bigint NOT NULL DEFAULT 0
);

CREATE TABLE scim_user (
    id uuid PRIMARY KEY,
    user_name text NOT NULL,
    folded text NOT NULL UNIQUE, -- the common form of all spellings of user_name
    external text NOT NULL, -- the id at the provider, or ''
    display text NOT NULL,
    formatted text NOT NULL,
    given text NOT NULL,
    family text NOT NULL,
    active boolean NOT NULL,
    valid_from_s bigint NOT NULL,
    valid_until_s bigint NOT NULL,
    version bigint NOT NULL DEFAULT 1,
    made_s bigint NOT NULL,
    changed_s bigint NOT NULL
);
CREATE INDEX scim_user_external ON scim_user (external);

CREATE TABLE scim_group (
    id uuid PRIMARY KEY,
    display text NOT NULL,
    folded text NOT NULL UNIQUE,
    external text NOT NULL,
    version bigint NOT NULL DEFAULT 1,
    made_s bigint NOT NULL,
    changed_s bigint NOT NULL
);

CREATE TABLE scim_member (
    team uuid NOT NULL REFERENCES scim_group ON DELETE CASCADE,
    member uuid NOT NULL REFERENCES scim_user ON DELETE CASCADE,
    PRIMARY KEY (team, member)
);
CREATE INDEX scim_member_member ON scim_member (member);

-- Which zones the members of a group get, by its name; the group need not exist yet.
CREATE TABLE scim_zone (
    folded text NOT NULL,
    display text NOT NULL,
    zone uuid NOT NULL REFERENCES zone,
    PRIMARY KEY (folded, zone)
);

-- Who has lost all zones, for the guard against a mistake that takes them from many.
CREATE TABLE scim_loss (
    time_s bigint NOT NULL,
    member uuid NOT NULL
);
CREATE INDEX scim_loss_time ON scim_loss (time_s);

-- Until when the guard lets everything pass.
CREATE TABLE scim_allowance (until_s bigint NOT NULL);
