/* Zones for tests: the files of the system's tzdata, and files that a test builds. */
#ifndef TESTS_FIRMWARE_POLICY_ZONE_RIG_H
#define TESTS_FIRMWARE_POLICY_ZONE_RIG_H

#include <stddef.h>
#include <stdint.h>

#include "firmware/policy/zone.h"

#define ZONE_RIG_FOLDER "/usr/share/zoneinfo"

/* Reads the bytes of a zone's file. The caller frees them. Returns NULL without such a file. */
uint8_t *zone_rig_bytes(const char *name, size_t *size);

/* Reads a zone. Fails the test if the file is missing or refused. */
void zone_rig_read(const char *name, struct iso_zone *zone);

/* A zone without changes whose clock is offset_s before UTC. */
void zone_rig_fixed(int32_t offset_s, struct iso_zone *zone);

/* A file that a test builds: one or two types, changes between them, and a rule. */
struct zone_file {
    char version; /* '2' */
    uint32_t n;
    int64_t at_s[4];
    uint8_t type_of[4];
    uint32_t n_types;
    int32_t offset_s[2];
    uint32_t n_leap;
    const char *footer; /* with its newlines */
};

enum { ZONE_FILE_SIZE = 512 };

/* Writes the file and returns its size. */
size_t zone_file_write(const struct zone_file *file, uint8_t bytes[ZONE_FILE_SIZE]);

#endif
