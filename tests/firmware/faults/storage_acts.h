/* The acts of an appliance that change files, for test_storage_faults.c. Each act is prepared while
 * the disk works, and carried out while the disk fails. */
#ifndef TESTS_FIRMWARE_FAULTS_STORAGE_ACTS_H
#define TESTS_FIRMWARE_FAULTS_STORAGE_ACTS_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/firmware/rigs/rig.h"

struct storage_world {
    char directory[64];
    char lockout_path[96];
    struct rig *rig;  /* NULL: the act opens the stores itself */
    int file;         /* the file with the people to import */
    int records_told; /* number of the records "x" that the appliance reported as written */
    int grants_told;  /* 1 after an allowed visit, otherwise 0 */
};

struct storage_act {
    const char *name;
    /* Prepares the state before the act. */
    void (*prepare)(struct storage_world *w);
    /* Returns 0, or a negative errno with *fault: the answer to the client. */
    int (*act)(struct storage_world *w, struct iso_fault *fault);
    bool opens;           /* the act opens the stores, and no client gets an answer */
    bool may_be_stricter; /* after an error, a door may stay shut until the next restart */
    int unknown_records;  /* number of records that may be there after a restart although they were
                             not reported as written, if the store could not remove them again */
};

extern const struct storage_act storage_acts[];
extern const size_t storage_acts_n;

/* Starts an appliance in the directory of the world, with the stores that exist there. */
void storage_world_start(struct storage_world *w);

/* Writes a list of all people with their faces and limits, "anna 50 0:0, bob 80 81 5:2000, ". It
 * leaves out "zoe". */
void storage_people(struct iso_gallery *gallery, char *text, size_t size);

#endif
