#include "tests/enroll/hub/update/rollout_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct player *rollout_players;
struct iso_fault rollout_fault;

int rollout_rig_setup(void **state)
{
    struct store_rig *rig = *state;
    (void)store_rig_setup(state);
    rollout_players = calloc(ROLLOUT_DOORS, sizeof *rollout_players);
    assert_non_null(rollout_players);
    const struct hub_update_file file = {.version = "1.2", .board = ROLLOUT_BOARD, .size = 1000};
    store_rig_fine(hub_update_add(&rig->store, &file, &rollout_fault), &rollout_fault);
    return 0;
}

int rollout_rig_teardown(void **state)
{
    free(rollout_players);
    return store_rig_teardown(state);
}

void rollout_rig_join(struct store_rig *rig, size_t i, const struct iso_fleet_id *zone)
{
    char name[16];
    (void)snprintf(name, sizeof name, "door%02zu", i);
    played_door_join(&rollout_players[i].door, rig, name, zone, 1);
    strcpy(rollout_players[i].version, "1.1");
    strcpy(rollout_players[i].state, "idle");
}

struct iso_fleet_id rollout_rig_join_all(struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    for (size_t i = 0; i < ROLLOUT_DOORS; i++) {
        rollout_rig_join(rig, i, &zone);
    }
    return zone;
}

void rollout_rig_ask(struct store_rig *rig, struct player *p)
{
    char rollout[ISO_FLEET_ID_TEXT_SIZE];
    (void)snprintf(p->health, sizeof p->health,
                   "{\"update-state\":\"%s\",\"update-rollout\":\"%s\",\"image-version\":\"%s\","
                   "\"image-board\":\"" ROLLOUT_BOARD "\",\"update-fault\":\"%s\"}",
                   p->state, iso_fleet_id_text(&p->door.update.rollout, rollout), p->version,
                   strcmp(p->state, "failed") == 0 ? "no space" : "");
    p->door.health = p->health;
    store_rig_fine(played_door_ask(&p->door, &rig->store, &rollout_fault), &rollout_fault);
}

/* One step of a door: it asks, and acts by the answer. */
void rollout_rig_step(struct store_rig *rig, struct player *p)
{
    rollout_rig_ask(rig, p);
    if (!p->door.is_ordered) {
        return;
    }
    assert_string_equal(p->door.update.version, "1.2");
    if (strcmp(p->state, "idle") == 0) {
        strcpy(p->state, "fetching");
    } else if (strcmp(p->state, "fetching") == 0) {
        strcpy(p->state, "installed");
    } else if (p->breaks) {
        strcpy(p->state, "went-back");
    } else {
        strcpy(p->state, "healthy");
        strcpy(p->version, "1.2");
    }
}

void rollout_rig_round(struct store_rig *rig)
{
    store_rig_now_s += 60;
    for (size_t i = 0; i < ROLLOUT_DOORS; i++) {
        rollout_rig_step(rig, &rollout_players[i]);
    }
}

void rollout_rig_start(struct store_rig *rig, uint32_t first, uint32_t stop_after, uint32_t wait_s)
{
    const struct hub_rollout_options options = {.version = "1.2",
                                                .zone = "office",
                                                .first = first,
                                                .stop_after = stop_after,
                                                .wait_s = wait_s};
    store_rig_fine(hub_rollout_start(&rig->store, &options, &rollout_fault), &rollout_fault);
}

static int keep_last(void *context, const struct hub_rollout *rollout)
{
    struct hub_rollout *out = context;
    static char why[100];
    *out = *rollout;
    (void)snprintf(why, sizeof why, "%s", rollout->why);
    out->why = why;
    return 0;
}

struct hub_rollout rollout_rig_now(struct store_rig *rig)
{
    struct hub_rollout out = {.doors = -1};
    store_rig_fine(hub_rollout_each(&rig->store, keep_last, &out, &rollout_fault), &rollout_fault);
    return out;
}

int64_t rollout_rig_count(struct store_rig *rig, const char *state)
{
    char sql[120];
    (void)snprintf(sql, sizeof sql, "SELECT count(*) FROM rollout_door WHERE state = '%s'", state);
    return store_rig_number(rig, sql);
}

static int expect_first(void *context, const struct hub_rollout_door *door)
{
    const char **text = context;
    if (*text) {
        char line[256];
        (void)snprintf(line, sizeof line, "%s %s %s", door->name, door->state, door->fault);
        assert_string_equal(line, *text);
        *text = NULL;
    }
    return 0;
}

void rollout_rig_expect_first(struct store_rig *rig, const char *text)
{
    store_rig_fine(hub_rollout_doors(&rig->store, "office", expect_first, &text, &rollout_fault),
                   &rollout_fault);
}
