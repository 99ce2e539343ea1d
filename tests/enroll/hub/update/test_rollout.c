/* Rollouts over doors that are played: who is told when, what stops a rollout, and what people see.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/update/hub_update.h"
#include "tests/enroll/hub/rigs/played_door.h"

#define BOARD "isotherm-pc-usb-amd64"

enum { DOORS = 12 };

static struct iso_fault fault;

/* A door with what it says of itself. */
struct player {
    struct played_door door;
    char version[16], state[16], health[400];
    bool breaks; /* its new version does not start */
};

static struct player *players;

static int setup(void **state)
{
    struct store_rig *rig = *state;
    (void)store_rig_setup(state);
    players = calloc(DOORS, sizeof *players);
    assert_non_null(players);
    const struct hub_update_file file = {.version = "1.2", .board = BOARD, .size = 1000};
    store_rig_fine(hub_update_add(&rig->store, &file, &fault), &fault);
    return 0;
}

static int teardown(void **state)
{
    free(players);
    return store_rig_teardown(state);
}

static void join(struct store_rig *rig, size_t i, const struct iso_fleet_id *zone)
{
    char name[16];
    (void)snprintf(name, sizeof name, "door%02zu", i);
    played_door_join(&players[i].door, rig, name, zone, 1);
    strcpy(players[i].version, "1.1");
    strcpy(players[i].state, "idle");
}

static struct iso_fleet_id join_all(struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    for (size_t i = 0; i < DOORS; i++) {
        join(rig, i, &zone);
    }
    return zone;
}

static void ask(struct store_rig *rig, struct player *p)
{
    char rollout[ISO_FLEET_ID_TEXT_SIZE];
    (void)snprintf(p->health, sizeof p->health,
                   "{\"update-state\":\"%s\",\"update-rollout\":\"%s\",\"image-version\":\"%s\","
                   "\"image-board\":\"" BOARD "\",\"update-fault\":\"%s\"}",
                   p->state, iso_fleet_id_text(&p->door.update.rollout, rollout), p->version,
                   strcmp(p->state, "failed") == 0 ? "no space" : "");
    p->door.health = p->health;
    store_rig_fine(played_door_ask(&p->door, &rig->store, &fault), &fault);
}

/* One step of a door: it asks, and acts by the answer. */
static void step(struct store_rig *rig, struct player *p)
{
    ask(rig, p);
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

static void round_of_all(struct store_rig *rig)
{
    store_rig_now_s += 60;
    for (size_t i = 0; i < DOORS; i++) {
        step(rig, &players[i]);
    }
}

static void start(struct store_rig *rig, uint32_t first, uint32_t stop_after, uint32_t wait_s)
{
    const struct hub_rollout_options options = {.version = "1.2",
                                                .zone = "office",
                                                .first = first,
                                                .stop_after = stop_after,
                                                .wait_s = wait_s};
    store_rig_fine(hub_rollout_start(&rig->store, &options, &fault), &fault);
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

static struct hub_rollout now(struct store_rig *rig)
{
    struct hub_rollout out = {.doors = -1};
    store_rig_fine(hub_rollout_each(&rig->store, keep_last, &out, &fault), &fault);
    return out;
}

static int64_t in_state(struct store_rig *rig, const char *state)
{
    char sql[120];
    (void)snprintf(sql, sizeof sql, "SELECT count(*) FROM rollout_door WHERE state = '%s'", state);
    return store_rig_number(rig, sql);
}

static void stages_double(void **state)
{
    struct store_rig *rig = *state;
    int64_t told[8] = {0};
    size_t n = 0;
    (void)join_all(rig);
    start(rig, 2, 0, 0);
    for (int i = 0; i < 40 && now(rig).stage.state == HUB_ROLLOUT_RUNNING; i++) {
        round_of_all(rig);
        const struct hub_rollout r = now(rig);
        /* Nobody is told before all who were told are healthy. */
        if (n == 0 || told[n - 1] != r.count.told) {
            assert_true(n < 8);
            told[n++] = r.count.told;
        }
    }
    const struct hub_rollout end = now(rig);
    assert_int_equal(end.stage.state, HUB_ROLLOUT_DONE);
    assert_int_equal(end.healthy, DOORS);
    /* 2, 4, 8, 12; within a round, the doors behind the one that completes a stage are told. */
    assert_int_equal(told[0], 2);
    assert_int_equal(told[n - 1], DOORS);
    assert_int_equal(end.stage.stage, 4);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'update-stage'"),
                     3);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'update-done'"),
                     1);
}

static void a_stage_is_never_exceeded(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    start(rig, 3, 0, 600);
    for (int i = 0; i < 4; i++) {
        round_of_all(rig);
        assert_int_equal(in_state(rig, "waiting"), DOORS - 3);
    }
    /* All three are healthy since the fourth round, and the time to wait runs. */
    assert_int_equal(in_state(rig, "healthy"), 3);
    round_of_all(rig);
    assert_int_equal(in_state(rig, "waiting"), DOORS - 3);
    store_rig_now_s += 600;
    round_of_all(rig);
    assert_int_equal(in_state(rig, "waiting"), DOORS - 6);
}

static void failures_stop_a_rollout(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    players[1].breaks = players[2].breaks = players[4].breaks = true;
    start(rig, 2, 1, 0);
    for (int i = 0; i < 12; i++) {
        round_of_all(rig);
    }
    struct hub_rollout r = now(rig);
    assert_int_equal(r.stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(r.stage.stage, 2);
    assert_int_equal(r.count.failed, 2);
    assert_string_equal(r.why, "2 of 4 doors have failed");
    assert_int_equal(in_state(rig, "went-back"), 2);
    assert_int_equal(in_state(rig, "waiting"), DOORS - 4);
    for (size_t i = 4; i < DOORS; i++) {
        assert_string_equal(players[i].version, "1.1");
        assert_false(players[i].door.is_ordered);
    }
    /* It goes on when somebody says so, and what has failed does not count any more. */
    store_rig_fine(hub_rollout_resume(&rig->store, "office", &fault), &fault);
    for (int i = 0; i < 20; i++) {
        round_of_all(rig);
    }
    r = now(rig);
    assert_int_equal(r.stage.state, HUB_ROLLOUT_DONE);
    assert_int_equal(r.healthy, DOORS - 3);
    assert_int_equal(in_state(rig, "went-back"), 3);
}

static void a_stop_takes_orders_back(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    start(rig, 2, 0, 0);
    ask(rig, &players[0]);
    assert_true(players[0].door.is_ordered);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", &fault), &fault);
    assert_int_equal(hub_rollout_stop(&rig->store, "office", &fault), -EALREADY);
    ask(rig, &players[0]);
    assert_false(players[0].door.is_ordered);
    ask(rig, &players[1]);
    assert_false(players[1].door.is_ordered);
    assert_string_equal(now(rig).why, "by anna");
    /* It goes on where it was. */
    store_rig_fine(hub_rollout_resume(&rig->store, "office", &fault), &fault);
    ask(rig, &players[0]);
    assert_true(players[0].door.is_ordered);
    assert_int_equal(hub_rollout_resume(&rig->store, "office", &fault), -EALREADY);
}

static void a_silent_door_has_failed(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    start(rig, 2, 0, 0);
    step(rig, &players[0]);
    step(rig, &players[1]);
    /* Door 0 never reports again; the others do. */
    for (int i = 0; i < HUB_UPDATE_SILENT_S / 60; i++) {
        store_rig_now_s += 60;
        for (size_t k = 1; k < DOORS; k++) {
            step(rig, &players[k]);
        }
        assert_int_equal(now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    }
    store_rig_now_s += 60;
    step(rig, &players[5]);
    assert_int_equal(now(rig).stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(in_state(rig, "failed"), 1);
    /* It was only away: what it says then is what counts. */
    strcpy(players[0].version, "1.2");
    strcpy(players[0].state, "healthy");
    ask(rig, &players[0]);
    assert_int_equal(in_state(rig, "failed"), 0);
    assert_int_equal(in_state(rig, "healthy"), 2);
}

/* A hub that was switched off has heard of no door. */
static void a_pause_of_the_hub_is_no_silence(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    start(rig, 2, 0, 0);
    step(rig, &players[0]);
    step(rig, &players[1]);
    store_rig_now_s += 24 * 3600;
    step(rig, &players[5]);
    store_rig_now_s += 60;
    step(rig, &players[5]);
    assert_int_equal(now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    step(rig, &players[0]);
    assert_int_equal(in_state(rig, "failed"), 0);
}

static void doors_that_cannot_are_left_out(void **state)
{
    struct store_rig *rig = *state;
    (void)join_all(rig);
    start(rig, DOORS, 0, 0);
    /* An older release, a machine without image, and another board. */
    store_rig_fine(played_door_ask(&players[0].door, &rig->store, &fault), &fault);
    assert_false(players[0].door.is_ordered);
    players[1].door.health = "{\"update-state\":\"none\"}";
    store_rig_fine(played_door_ask(&players[1].door, &rig->store, &fault), &fault);
    assert_false(players[1].door.is_ordered);
    players[2].door.health =
        "{\"update-state\":\"idle\",\"image-version\":\"1.1\",\"image-board\":\"other\"}";
    store_rig_fine(played_door_ask(&players[2].door, &rig->store, &fault), &fault);
    assert_false(players[2].door.is_ordered);
    assert_int_equal(in_state(rig, "unable"), 3);
    /* One that has the version already need not be told. */
    strcpy(players[3].version, "1.2");
    ask(rig, &players[3]);
    assert_false(players[3].door.is_ordered);
    assert_int_equal(in_state(rig, "healthy"), 1);
    assert_int_equal(now(rig).count.told, 0);
    /* The older release was upgraded. */
    ask(rig, &players[0]);
    assert_true(players[0].door.is_ordered);
    /* A door that was told stays so while it does not know its state, as after a restart. */
    players[0].door.health = NULL;
    store_rig_fine(played_door_ask(&players[0].door, &rig->store, &fault), &fault);
    assert_int_equal(in_state(rig, "told"), 1);
    /* What a door says is not believed to be a word. */
    players[4].door.health = "{\"update-state\":\"broken\",\"image-version\":7}";
    store_rig_fine(played_door_ask(&players[4].door, &rig->store, &fault), &fault);
    players[4].door.health = "{\"update-state\":\"idle\",\"image-version\":\"1.1\","
                             "\"image-board\":\"a b'; DROP TABLE door\"}";
    store_rig_fine(played_door_ask(&players[4].door, &rig->store, &fault), &fault);
    assert_int_equal(in_state(rig, "unable"), 3);
}

static int expect_order(void *context, const struct hub_rollout_door *door)
{
    static const char *const expected[] = {"door01 failed no space", "door00 told ",
                                           "door02 waiting "};
    size_t *n = context;
    char text[200];
    (void)snprintf(text, sizeof text, "%s %s %s", door->name, door->state, door->fault);
    if (*n < 3) {
        assert_string_equal(text, expected[*n]);
    }
    assert_true(door->changed_s > 0);
    ++*n;
    return 0;
}

static void people_see_what_needs_attention_first(void **state)
{
    struct store_rig *rig = *state;
    size_t n = 0;
    (void)join_all(rig);
    assert_int_equal(hub_rollout_doors(&rig->store, "office", expect_order, &n, &fault), -ENOENT);
    start(rig, 2, 5, 0);
    ask(rig, &players[0]);
    ask(rig, &players[1]);
    strcpy(players[1].state, "failed");
    ask(rig, &players[1]);
    store_rig_fine(hub_rollout_doors(&rig->store, "office", expect_order, &n, &fault), &fault);
    assert_int_equal(n, DOORS);
}

static void what_cannot_be_started(void **state)
{
    struct store_rig *rig = *state;
    struct hub_rollout_options options = {.version = "1.2", .zone = "office", .first = 1};
    const struct iso_fleet_id office = store_rig_zone(rig, "office");
    const struct iso_fleet_id both[2] = {store_rig_zone(rig, "lab"), office};
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -ENODATA);
    join(rig, 0, &office);
    played_door_join(&players[1].door, rig, "both", both, 2);
    options.version = "1.3";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -ENOENT);
    options.version = "1.2";
    options.zone = "nowhere";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -ENOENT);
    options.zone = "office";
    options.first = 0;
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -EINVAL);
    options.first = 1;
    store_rig_fine(hub_rollout_start(&rig->store, &options, &fault), &fault);
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -EALREADY);
    assert_non_null(strstr(fault.text, "version 1.2"));
    options.zone = "lab";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &fault), -EALREADY);
    assert_non_null(strstr(fault.text, "zone office"));
    /* A stopped one is replaced. */
    store_rig_fine(hub_rollout_stop(&rig->store, "office", &fault), &fault);
    options.zone = "office";
    store_rig_fine(hub_rollout_start(&rig->store, &options, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM rollout WHERE state = 'replaced'"),
                     1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(stages_double, setup, teardown),
        cmocka_unit_test_setup_teardown(a_stage_is_never_exceeded, setup, teardown),
        cmocka_unit_test_setup_teardown(failures_stop_a_rollout, setup, teardown),
        cmocka_unit_test_setup_teardown(a_stop_takes_orders_back, setup, teardown),
        cmocka_unit_test_setup_teardown(a_silent_door_has_failed, setup, teardown),
        cmocka_unit_test_setup_teardown(a_pause_of_the_hub_is_no_silence, setup, teardown),
        cmocka_unit_test_setup_teardown(doors_that_cannot_are_left_out, setup, teardown),
        cmocka_unit_test_setup_teardown(people_see_what_needs_attention_first, setup, teardown),
        cmocka_unit_test_setup_teardown(what_cannot_be_started, setup, teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
