-- The events of a person are found without reading those of everybody.
CREATE INDEX event_person ON event ((record ->> 'person'), time);
