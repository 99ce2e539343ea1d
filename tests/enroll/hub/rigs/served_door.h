/* One test of the running hub: a hub with one process, and a door that has not joined. */
#ifndef TESTS_HUB_RIGS_SERVED_DOOR_H
#define TESTS_HUB_RIGS_SERVED_DOOR_H

#include "tests/enroll/hub/rigs/door_rig.h"
#include "tests/enroll/hub/rigs/hub_rig.h"

extern struct hub_rig rig;
extern struct door_rig door;

/* cmocka set-up and tear-down. Where PostgreSQL or mosquitto is missing, the test is skipped. */
int served_door_setup(void **state);
int served_door_teardown(void **state);

/* Begins a test: skips it if it cannot run. */
void served_door_begin(void);

/* Joins, and lets the broker know the door; connects, and asks a question. */
void served_door_join(void);
void served_door_connect(struct iso_fleet_lease *lease);

/* Seconds, monotonic. */
double served_now_s(void);

/* Fails the test with the fault of an error. */
void served_ok(int error, const struct iso_fault *fault);

#define SERVED_TEST(test) \
    cmocka_unit_test_setup_teardown(test, served_door_setup, served_door_teardown)

#endif
