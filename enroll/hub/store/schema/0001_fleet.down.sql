DROP TABLE act, request, event, snapshot_chunk, snapshot, delta, template, person_zone, person, door_place, door_zone, door, zone;
DROP SEQUENCE person_revision;
