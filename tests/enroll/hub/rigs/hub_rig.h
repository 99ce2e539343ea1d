/* A whole hub for tests: PostgreSQL, mosquitto with TLS, and processes of the hub. Failures fail
 * the running cmocka test. */
#ifndef TESTS_HUB_RIGS_HUB_RIG_H
#define TESTS_HUB_RIGS_HUB_RIG_H

#include "enroll/hub/store/hub_store.h"
#include "tests/enroll/hub/rigs/broker_rig.h"
#include "tests/enroll/hub/rigs/rig_postgres.h"

enum { HUB_RIG_PROCESSES = 2 };

struct hub_rig {
    const char *folder, *broker_folder; /* the authority; what mosquitto reads */
    struct rig_postgres *postgres;      /* one for all tests of the program */
    struct broker_rig broker;
    uint16_t broker_port, hub_broker_port;
    struct hub_store store; /* of the test, who is the administrator */
    struct iso_fleet_id zone;
    struct {
        pid_t pid; /* 0: it does not run */
        uint16_t port;
        char log[128], metrics[128];
    } hubs[HUB_RIG_PROCESSES];
};

/* Starts the database with one zone, "Office", and the broker. False: a program is missing. */
bool hub_rig_start(struct hub_rig *rig, const char *folder);
void hub_rig_stop(struct hub_rig *rig);

/* Stops the server of the database after the last test: a tear-down of the group for cmocka. */
int hub_rig_end(void **state);

/* Starts a process of the hub and waits until it listens. */
void hub_rig_serve(struct hub_rig *rig, int i);

/* Ends it by SIGKILL. */
void hub_rig_kill(struct hub_rig *rig, int i);

/* The number of the process that is the leader, waiting for one; it says so in its log. */
int hub_rig_leader(struct hub_rig *rig);

/* How often a text is in the log of a process. */
int hub_rig_says(const struct hub_rig *rig, int i, const char *text);

/* Adds a door to the zone; returns its code in a static buffer. */
const char *hub_rig_add_door(struct hub_rig *rig, const char *name);

/* Waits until the rights of the broker mention a text (or do not), and lets the broker read them.
 */
void hub_rig_reload(struct hub_rig *rig, const char *text, bool mentions);

#endif
