/* The service on a private bus, with two clients. All are in one process: the loop goes round until
 * an answer is there. */
#ifndef TESTS_FIRMWARE_RIGS_BUS_RIG_H
#define TESTS_FIRMWARE_RIGS_BUS_RIG_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "firmware/bus/bus.h"
#include "tests/firmware/rigs/rig.h"

enum { BUS_RIG_ROUNDS = 20000 };

struct bus_rig {
    struct rig *rig; /* its appliance reports to the bus */
    sd_event *event;
    struct iso_bus *service;
    sd_bus *client[2];
    char told[2][1024]; /* signals: "EnrollStatus enroll-completed; ..." */
};

/* cmocka set-up and tear-down: of the bus for a group, of service and clients for a test. */
int bus_rig_group_setup(void **state);
int bus_rig_group_teardown(void **state);
int bus_rig_setup(void **state);
int bus_rig_teardown(void **state);

/* The rig of a test; skips the test where there is no dbus-daemon. */
struct bus_rig *bus_rig_need(void **state);

const char *bus_rig_address(void);

/* One more client, whose signals are noted in told[1024]. */
sd_bus *bus_rig_connect(char *told);

/* One round of the service and both clients. */
void bus_rig_go_round(struct bus_rig *rig);

struct bus_answer {
    bool there;
    char error[96], text[128];
    sd_bus_message *reply;
};

/* A call of a client, to be filled in; sends it and waits for the answer, valid until the next. */
sd_bus_message *bus_rig_new_call(struct bus_rig *rig, int client, const char *method);
struct bus_answer *bus_rig_send(struct bus_rig *rig, int client, sd_bus_message *message);

/* A method without arguments, or with one string. "" or the error's last word. */
const char *bus_rig_call(struct bus_rig *rig, int client, const char *method, const char *argument);

/* Lets the appliance run, and what it says arrive. */
void bus_rig_run(struct bus_rig *rig, int64_t ms);

/* What a client was told since the last call. */
const char *bus_rig_news(struct bus_rig *rig, int client);

/* The clients leave the bus, if they have one, and connect to that which is there. */
void bus_rig_connect_clients(struct bus_rig *rig);

/* The bus goes away, under everybody's feet, and another one comes to the same address. */
void bus_rig_restart_bus(struct bus_rig *rig);

/* The bus goes away, under everybody's feet. */
void bus_rig_end_bus(void);

#endif
