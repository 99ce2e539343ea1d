/* A hub for tests: keys in a temporary directory, a database of the PostgreSQL rig, and a clock
 * that the test sets. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_STORE_RIGS_STORE_RIG_H
#define TESTS_ENROLL_STORE_RIGS_STORE_RIG_H

#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_zone.h"
#include "tests/enroll/hub/rigs/rig_postgres.h"

extern int64_t store_rig_now_s; /* the clock of all stores */

struct store_rig {
    struct rig_postgres postgres;
    char key_file[128];
    struct hub_store store;
};

/* For a whole group: starts PostgreSQL and makes the keys. If it is not installed, the program ends
 * with the code for "skipped". */
int store_rig_start(void **state);
int store_rig_stop(void **state);

/* For each test: an empty database with the tables, and a store. */
int store_rig_setup(void **state);
int store_rig_teardown(void **state);

/* Another store on the same database. */
void store_rig_open(struct store_rig *rig, struct hub_store *out);

/* Fails the test with the line of the fault unless error is 0. */
void store_rig_fine(int error, const struct iso_fault *fault);

struct iso_fleet_id store_rig_zone(struct store_rig *rig, const char *name);
struct hub_zone store_rig_zone_now(struct store_rig *rig, const struct iso_fleet_id *zone);

/* A person of this name with `n` templates, each 2000 bytes `fill`. The texts and bytes belong to
 * the rig until the next call with the same name. */
struct iso_fleet_person store_rig_person(const char *name, uint32_t algorithm, size_t n,
                                         uint8_t fill);

/* Puts such a person into zones. */
struct iso_fleet_id store_rig_put(struct store_rig *rig, const char *name,
                                  const struct iso_fleet_id *zones, size_t n_zones);

/* One number from a statement without values. */
int64_t store_rig_number(struct store_rig *rig, const char *sql);

#endif
