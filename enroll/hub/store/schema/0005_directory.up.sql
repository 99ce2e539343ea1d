-- People whom a directory names. Those with a face are linked with a person of the fleet.
CREATE TABLE directory (
    id uuid PRIMARY KEY,
    source text NOT NULL, -- the name of the directory
    external text NOT NULL, -- the id there
    name text NOT NULL,
    folded text NOT NULL, -- the common form of all spellings of the name
    active boolean NOT NULL,
    valid_from_s bigint NOT NULL DEFAULT 0,
    valid_until_s bigint NOT NULL DEFAULT 0,
    named boolean NOT NULL, -- the directory still names it
    added_s bigint NOT NULL,
    person uuid UNIQUE REFERENCES person ON DELETE SET NULL,
    UNIQUE (source, external)
);

-- The zones that the directory gives to a person.
CREATE TABLE directory_zone (
    directory uuid NOT NULL REFERENCES directory ON DELETE CASCADE,
    zone uuid NOT NULL REFERENCES zone,
    PRIMARY KEY (directory, zone)
);
