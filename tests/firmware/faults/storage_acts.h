/* What an appliance does that changes files, for test_storage_faults.c: each act is prepared while
 * the disk works, and carried out while it fails. */
#ifndef TESTS_FIRMWARE_FAULTS_STORAGE_ACTS_H
#define TESTS_FIRMWARE_FAULTS_STORAGE_ACTS_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/firmware/rigs/rig.h"

struct storage_world {
    char directory[64];
    char lockout_path[96];
    struct rig *rig;  /* NULL: the act opens the stores itself */
    int file;         /* people to be imported */
    int records_told; /* records "x" of which the appliance said that they are written */
    int grants_told;  /* visits that were allowed */
};

struct storage_act {
    const char *name;
    /* Makes what there is before. */
    void (*prepare)(struct storage_world *w);
    /* 0, or a negative errno with *fault: what the client is told. */
    int (*act)(struct storage_world *w, struct iso_fault *fault);
    bool opens;           /* the act opens the stores, and no client is told anything */
    bool may_be_stricter; /* after an error a door may be shut until the next restart only */
    int unknown_records;  /* so many records that were not said to be written may be there after a
                             restart, if they could not be taken away again */
};

extern const struct storage_act storage_acts[];
extern const size_t storage_acts_n;

/* A running appliance in the directory of the world, with the stores that are there. */
void storage_world_start(struct storage_world *w);

/* "anna 50 0:0, bob 80 81 5:2000, ": everybody with the faces and the limits, but for "zoe". */
void storage_people(struct iso_gallery *gallery, char *text, size_t size);

#endif
