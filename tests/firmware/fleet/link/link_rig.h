/* A link between a fake daemon and a fake hub, over a real broker, in one event loop. */
#ifndef TESTS_FLEET_LINK_LINK_RIG_H
#define TESTS_FLEET_LINK_LINK_RIG_H

#include "firmware/fleet/link/link.h"
#include "tests/firmware/fleet/link/certificates.h"
#include "tests/firmware/fleet/link/fake_hub.h"
#include "tests/firmware/fleet/link/mosquitto_rig.h"

enum { RIG_WAIT_MS = 20000, RIG_NOTES_SIZE = 16384 };

struct link_rig {
    sd_event *event;
    struct mosquitto_rig broker;
    struct fake_daemon daemon;
    struct fake_hub hub;
    struct link_http *http;
    struct link_door *door;
    bool is_secure;
    struct authority authority; /* if it is secure */
    char notes[RIG_NOTES_SIZE]; /* what the link has said */
};

/* cmocka set-up and tear-down: broker, hub and daemon run; the hub has no zone yet. */
int link_rig_setup(void **state);

/* The same with TLS everywhere: the broker and the hub have certificates of an authority, and the
 * broker wants certificates of its clients. */
int link_rig_setup_secure(void **state);
int link_rig_teardown(void **state);

/* Starts the link; and with these names of files of the rig's directory in place of the right
 * ones. */
void link_rig_start(struct link_rig *rig);
void link_rig_start_with(struct link_rig *rig, const char *ca, const char *certificate,
                         const char *key);

/* Runs the event loop until the condition holds; the test fails after RIG_WAIT_MS. */
#define link_rig_until(rig, condition)                                                          \
    do {                                                                                        \
        const int64_t end_ = link_rig_now_ms() + RIG_WAIT_MS;                                   \
        while (!(condition)) {                                                                  \
            if (link_rig_now_ms() > end_) {                                                     \
                fail_msg("%s: has not come true; the link says: %s", #condition, (rig)->notes); \
            }                                                                                   \
            link_rig_turn(rig);                                                                 \
        }                                                                                       \
    } while (0)

int64_t link_rig_now_ms(void);
void link_rig_turn(struct link_rig *rig);

/* Runs the event loop for a time. */
void link_rig_run(struct link_rig *rig, int ms);

/* Runs until the daemon is as far as the hub in all zones, and the hub knows it. */
void link_rig_until_level(struct link_rig *rig);

/* Starts the link with one empty zone, and runs until the door is online and level with the hub. */
struct hub_zone *link_rig_begin(struct link_rig *rig);

/* What the link reports. */
#define link_rig_report(rig) link_door_report((rig)->door)

#endif
