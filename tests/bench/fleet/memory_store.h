/* The people of one door in memory: the table of a door's store (firmware/fleet/door/fleet_store.h)
 * without a disk and without templates, so that thousands of doors fit into a machine. Names,
 * numbers and access records are kept as a gallery keeps them; templates are counted and
 * forgotten. */
#ifndef TESTS_BENCH_FLEET_MEMORY_STORE_H
#define TESTS_BENCH_FLEET_MEMORY_STORE_H

#include "firmware/fleet/door/fleet_store.h"

struct memory_access {
    void *bytes;
    size_t size;
};

/* All zero is empty. */
struct memory_store {
    size_t n, capacity;
    struct iso_person *people;
    struct memory_access *accesses; /* of the people, in their order */
    struct memory_access record;    /* of the fleet */
    int64_t last;                   /* the last number of a person */
    uint64_t changes;
};

/* The store must outlive what is returned. */
struct iso_fleet_store memory_store_table(struct memory_store *store);

void memory_store_done(struct memory_store *store);

#endif
