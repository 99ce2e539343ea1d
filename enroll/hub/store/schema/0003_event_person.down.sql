DROP INDEX event_person;
