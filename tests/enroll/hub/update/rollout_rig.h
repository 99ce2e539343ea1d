/* Doors that are played for the rollouts of a zone: they ask, and act by what they are told. One
 * rig at a time. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_UPDATE_ROLLOUT_RIG_H
#define TESTS_ENROLL_HUB_UPDATE_ROLLOUT_RIG_H

#include "enroll/hub/update/hub_update.h"
#include "tests/enroll/hub/rigs/played_door.h"

#define ROLLOUT_BOARD "isotherm-pc-usb-amd64"

enum { ROLLOUT_DOORS = 12 };

/* A door with what it says of itself. */
struct player {
    struct played_door door;
    char version[16], state[16], health[400];
    bool breaks; /* its new version does not start */
};

extern struct player *rollout_players; /* [ROLLOUT_DOORS] */
extern struct iso_fault rollout_fault;

/* A database with the file of version 1.2 for ROLLOUT_BOARD; for cmocka. */
int rollout_rig_setup(void **state);
int rollout_rig_teardown(void **state);

/* Lets player i join, or all of them in the zone "office". */
void rollout_rig_join(struct store_rig *rig, size_t i, const struct iso_fleet_id *zone);
struct iso_fleet_id rollout_rig_join_all(struct store_rig *rig);

/* A question, and one with what the door then does. One step of all, a minute later. */
void rollout_rig_ask(struct store_rig *rig, struct player *p);
void rollout_rig_step(struct store_rig *rig, struct player *p);
void rollout_rig_round(struct store_rig *rig);

/* Begins the rollout of 1.2 in "office". */
void rollout_rig_start(struct store_rig *rig, uint32_t first, uint32_t stop_after, uint32_t wait_s);

/* The newest rollout; how many doors of all rollouts are in a state. */
struct hub_rollout rollout_rig_now(struct store_rig *rig);
int64_t rollout_rig_count(struct store_rig *rig, const char *state);

/* Fails unless the door of the newest rollout that needs attention most is described by "NAME STATE
 * FAULT". */
void rollout_rig_expect_first(struct store_rig *rig, const char *text);

#endif
