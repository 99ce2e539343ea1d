DROP TABLE door_certificate;
