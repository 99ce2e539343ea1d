DROP TABLE directory_zone, directory;
