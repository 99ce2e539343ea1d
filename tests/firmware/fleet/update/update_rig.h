/* A door with an image, for tests of its updates: a server of the test in place of the hub, a
 * script in place of isotherm(1), functions in place of the daemon, and the program install-update
 * of the image, which the rig runs as the unit of the image would. Failures fail the running
 * cmocka test. */
#ifndef TESTS_FIRMWARE_FLEET_UPDATE_UPDATE_RIG_H
#define TESTS_FIRMWARE_FLEET_UPDATE_UPDATE_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/fleet/update/update.h"
#include "tests/firmware/fleet/link/fetch_server.h"

enum { UPDATE_FILE_BYTES = 2 * ISO_FLEET_UPDATE_PART_BYTES + 1234 };

#define UPDATE_BOARD "isotherm-pc-usb-amd64"

struct update_rig {
    sd_event *event;
    struct link_http *http;
    struct fetch_server server;
    struct link_update *update;
    char folder[256], state[300], bin[300], program[320], restart[340];
    uint8_t *file;
    struct iso_fleet_update order;
    /* Of the hub. */
    unsigned status;          /* of the next replies; 200 */
    bool is_damaged;          /* a byte of the file is another one */
    unsigned begins, damaged; /* how often it was fetched; so many times it was damaged at first */
    uint64_t last_after;
    uint64_t cut_at;   /* replies behind it fail; 0: none */
    bool has_no_units; /* nothing of the image looks at the inbox */
    bool is_on_trial;  /* the running version, when its slots are said the next time */
    /* Of the daemon. */
    bool is_busy, is_away;
    unsigned tells;
    enum iso_fleet_update_state told;
};

int update_rig_setup(void **state);
int update_rig_teardown(void **state);

/* The updates of the door begin, as after a restart of the link, and end. */
void update_rig_start(struct update_rig *rig);
void update_rig_stop(struct update_rig *rig);

/* What `isotherm update --json` says from now on; before the first call there is no RAUC. The
 * script keeps a copy of what it installs, as the file "installed", and refuses with the code of a
 * line of `refusals` each time, at last always with that of the last line; "": it installs. */
void update_rig_slots(struct update_rig *rig, const char *version, bool good, bool waiting);
void update_rig_slots_with(struct update_rig *rig, const char *version, const char *other,
                           bool good, bool waiting); /* RAUC knows the version of the other one */
void update_rig_program(struct update_rig *rig, const char *refusals);

/* One turn of the event loop, and of the units of the image. */
void update_rig_turn(struct update_rig *rig);

/* The hub answers a question, and orders. */
void update_rig_order(struct update_rig *rig);

/* All of it, for a door with version 1.1: it starts, and the hub orders what is refused so. */
void update_rig_begin(struct update_rig *rig, const char *refusals);

/* Whether the daemon was told this last; runs the loop until it was; until the server has had so
 * many requests. Each of them plays the units of the image. */
bool update_rig_is_told(const struct update_rig *rig, enum iso_fleet_update_state state);
void update_rig_wait(struct update_rig *rig, enum iso_fleet_update_state state);
void update_rig_run(struct update_rig *rig, unsigned requests);

/* Whether the folder has a file of this name; whether what was installed is the file of the hub. */
bool update_rig_has(const struct update_rig *rig, const char *name);
void update_rig_expect_installed(struct update_rig *rig);

#endif
