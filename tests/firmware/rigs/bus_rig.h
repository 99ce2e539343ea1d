/* The service on a private bus, with two clients. All of them are in one process: a call runs their
 * loop until its answer has arrived. */
#ifndef TESTS_FIRMWARE_RIGS_BUS_RIG_H
#define TESTS_FIRMWARE_RIGS_BUS_RIG_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "firmware/bus/bus.h"
#include "tests/firmware/rigs/rig.h"

/* A wait for an event fails after this number of rounds. */
enum { BUS_RIG_ROUNDS = 20000 };

struct bus_rig {
    struct rig *rig; /* its appliance reports to the bus */
    sd_event *event;
    struct iso_bus *service;
    sd_bus *client[2];
    char told[2][1024]; /* received signals: "EnrollStatus enroll-completed; ..." */
};

/* cmocka set-up and tear-down. Those of the group start and stop the bus, those of a test start and
 * stop the service and the clients. */
int bus_rig_group_setup(void **state);
int bus_rig_group_teardown(void **state);
int bus_rig_setup(void **state);
int bus_rig_teardown(void **state);

/* Returns the rig of a test. Skips the test if there is no dbus-daemon. */
struct bus_rig *bus_rig_need(void **state);

const char *bus_rig_address(void);

/* Connects one more client. Its signals are noted in told[1024]. */
sd_bus *bus_rig_connect(char *told);

/* Runs the service and both clients once. */
void bus_rig_go_round(struct bus_rig *rig);

struct bus_answer {
    bool there;
    char error[96], text[128];
    sd_bus_message *reply;
};

/* Makes a call of a client. The test appends the arguments and passes it to bus_rig_send. */
sd_bus_message *bus_rig_new_call(struct bus_rig *rig, int client, const char *method);

/* Sends the call, releases it, and waits for the answer, which is valid until the next
 * bus_rig_send. */
struct bus_answer *bus_rig_send(struct bus_rig *rig, int client, sd_bus_message *message);

/* Calls a method without arguments, or with one string. Returns "" or the last word of the error's
 * name. */
const char *bus_rig_call(struct bus_rig *rig, int client, const char *method, const char *argument);

/* Runs the appliance for this time, then delivers its signals. */
void bus_rig_run(struct bus_rig *rig, int64_t ms);

/* Returns the signals that a client has received since the last call of this function. The text is
 * valid until the next one. */
const char *bus_rig_news(struct bus_rig *rig, int client);

/* Disconnects the clients, if they are connected, and connects them to the present bus. */
void bus_rig_connect_clients(struct bus_rig *rig);

/* Stops the bus while service and clients are connected, and starts another one at the same
 * address. */
void bus_rig_restart_bus(struct bus_rig *rig);

/* Stops the bus while service and clients are connected. */
void bus_rig_end_bus(void);

#endif
