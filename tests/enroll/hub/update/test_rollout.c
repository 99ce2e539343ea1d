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

#include "tests/enroll/hub/update/rollout_rig.h"

static void stages_double(void **state)
{
    struct store_rig *rig = *state;
    int64_t told[8] = {0};
    size_t n = 0;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 0, 0);
    for (int i = 0; i < 40 && rollout_rig_now(rig).stage.state == HUB_ROLLOUT_RUNNING; i++) {
        rollout_rig_round(rig);
        const struct hub_rollout r = rollout_rig_now(rig);
        /* Nobody is told before all who were told are healthy. */
        if (n == 0 || told[n - 1] != r.count.told) {
            assert_true(n < 8);
            told[n++] = r.count.told;
        }
    }
    const struct hub_rollout end = rollout_rig_now(rig);
    assert_int_equal(end.stage.state, HUB_ROLLOUT_DONE);
    assert_int_equal(end.healthy, ROLLOUT_DOORS);
    /* 2, 4, 8, 12; within a round, the doors behind the one that completes a stage are told. */
    assert_int_equal(told[0], 2);
    assert_int_equal(told[n - 1], ROLLOUT_DOORS);
    assert_int_equal(end.stage.stage, 4);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'update-stage'"),
                     3);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'update-done'"),
                     1);
}

static void a_stage_is_never_exceeded(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 3, 0, 600);
    for (int i = 0; i < 4; i++) {
        rollout_rig_round(rig);
        assert_int_equal(rollout_rig_count(rig, "waiting"), ROLLOUT_DOORS - 3);
    }
    /* All three are healthy since the fourth round, and the time to wait runs. */
    assert_int_equal(rollout_rig_count(rig, "healthy"), 3);
    rollout_rig_round(rig);
    assert_int_equal(rollout_rig_count(rig, "waiting"), ROLLOUT_DOORS - 3);
    store_rig_now_s += 600;
    rollout_rig_round(rig);
    assert_int_equal(rollout_rig_count(rig, "waiting"), ROLLOUT_DOORS - 6);
}

static void failures_stop_a_rollout(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_players[1].breaks = rollout_players[2].breaks = rollout_players[4].breaks = true;
    rollout_rig_start(rig, 2, 1, 0);
    for (int i = 0; i < 12; i++) {
        rollout_rig_round(rig);
    }
    struct hub_rollout r = rollout_rig_now(rig);
    assert_int_equal(r.stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(r.stage.stage, 2);
    assert_int_equal(r.count.failed, 2);
    assert_string_equal(r.why, "2 of 4 doors have failed");
    assert_int_equal(rollout_rig_count(rig, "went-back"), 2);
    assert_int_equal(rollout_rig_count(rig, "waiting"), ROLLOUT_DOORS - 4);
    for (size_t i = 4; i < ROLLOUT_DOORS; i++) {
        assert_string_equal(rollout_players[i].version, "1.1");
        assert_false(rollout_players[i].door.is_ordered);
    }
    /* It goes on when somebody says so, and what has failed does not count any more. */
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    for (int i = 0; i < 20; i++) {
        rollout_rig_round(rig);
    }
    r = rollout_rig_now(rig);
    assert_int_equal(r.stage.state, HUB_ROLLOUT_DONE);
    assert_int_equal(r.healthy, ROLLOUT_DOORS - 3);
    assert_int_equal(rollout_rig_count(rig, "went-back"), 3);
}

static void a_stop_takes_orders_back(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 0, 0);
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_true(rollout_players[0].door.is_ordered);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    assert_int_equal(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), -EALREADY);
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_false(rollout_players[0].door.is_ordered);
    rollout_rig_ask(rig, &rollout_players[1]);
    assert_false(rollout_players[1].door.is_ordered);
    assert_string_equal(rollout_rig_now(rig).why, "by anna");
    /* It goes on where it was. */
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_true(rollout_players[0].door.is_ordered);
    assert_int_equal(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), -EALREADY);
}

static void a_silent_door_has_failed(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 0, 0);
    rollout_rig_step(rig, &rollout_players[0]);
    rollout_rig_step(rig, &rollout_players[1]);
    /* Door 0 never reports again; the others do. */
    for (int i = 0; i < HUB_UPDATE_SILENT_S / 60; i++) {
        store_rig_now_s += 60;
        for (size_t k = 1; k < ROLLOUT_DOORS; k++) {
            rollout_rig_step(rig, &rollout_players[k]);
        }
        assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    }
    store_rig_now_s += 60;
    rollout_rig_step(rig, &rollout_players[5]);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
    /* It was only away: what it says then is what counts. */
    strcpy(rollout_players[0].version, "1.2");
    strcpy(rollout_players[0].state, "healthy");
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_int_equal(rollout_rig_count(rig, "failed"), 0);
    assert_int_equal(rollout_rig_count(rig, "healthy"), 2);
}

/* A hub that was switched off has heard of no door. */
static void a_pause_of_the_hub_is_no_silence(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 0, 0);
    rollout_rig_step(rig, &rollout_players[0]);
    rollout_rig_step(rig, &rollout_players[1]);
    store_rig_now_s += 24 * 3600;
    rollout_rig_step(rig, &rollout_players[5]);
    store_rig_now_s += 60;
    rollout_rig_step(rig, &rollout_players[5]);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    rollout_rig_step(rig, &rollout_players[0]);
    assert_int_equal(rollout_rig_count(rig, "failed"), 0);
}

static void doors_that_cannot_are_left_out(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, ROLLOUT_DOORS, 0, 0);
    /* An older release, a machine without image, and another board. */
    store_rig_fine(played_door_ask(&rollout_players[0].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    assert_false(rollout_players[0].door.is_ordered);
    rollout_players[1].door.health = "{\"update-state\":\"none\"}";
    store_rig_fine(played_door_ask(&rollout_players[1].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    assert_false(rollout_players[1].door.is_ordered);
    rollout_players[2].door.health =
        "{\"update-state\":\"idle\",\"image-version\":\"1.1\",\"image-board\":\"other\"}";
    store_rig_fine(played_door_ask(&rollout_players[2].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    assert_false(rollout_players[2].door.is_ordered);
    assert_int_equal(rollout_rig_count(rig, "unable"), 3);
    /* One that has the version already need not be told. */
    strcpy(rollout_players[3].version, "1.2");
    rollout_rig_ask(rig, &rollout_players[3]);
    assert_false(rollout_players[3].door.is_ordered);
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
    assert_int_equal(rollout_rig_now(rig).count.told, 0);
    /* The older release was upgraded. */
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_true(rollout_players[0].door.is_ordered);
    /* A door that was told stays so while it does not know its state, as after a restart. */
    rollout_players[0].door.health = NULL;
    store_rig_fine(played_door_ask(&rollout_players[0].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    assert_int_equal(rollout_rig_count(rig, "told"), 1);
    /* What a door says is not believed to be a word. */
    rollout_players[4].door.health = "{\"update-state\":\"broken\",\"image-version\":7}";
    store_rig_fine(played_door_ask(&rollout_players[4].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    rollout_players[4].door.health = "{\"update-state\":\"idle\",\"image-version\":\"1.1\","
                                     "\"image-board\":\"a b'; DROP TABLE door\"}";
    store_rig_fine(played_door_ask(&rollout_players[4].door, &rig->store, &rollout_fault),
                   &rollout_fault);
    assert_int_equal(rollout_rig_count(rig, "unable"), 3);
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
    (void)rollout_rig_join_all(rig);
    assert_int_equal(hub_rollout_doors(&rig->store, "office", expect_order, &n, &rollout_fault),
                     -ENOENT);
    rollout_rig_start(rig, 2, 5, 0);
    rollout_rig_ask(rig, &rollout_players[0]);
    rollout_rig_ask(rig, &rollout_players[1]);
    strcpy(rollout_players[1].state, "failed");
    rollout_rig_ask(rig, &rollout_players[1]);
    store_rig_fine(hub_rollout_doors(&rig->store, "office", expect_order, &n, &rollout_fault),
                   &rollout_fault);
    assert_int_equal(n, ROLLOUT_DOORS);
}

static void what_cannot_be_started(void **state)
{
    struct store_rig *rig = *state;
    struct hub_rollout_options options = {.version = "1.2", .zone = "office", .first = 1};
    const struct iso_fleet_id office = store_rig_zone(rig, "office");
    const struct iso_fleet_id both[2] = {store_rig_zone(rig, "lab"), office};
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -ENODATA);
    rollout_rig_join(rig, 0, &office);
    played_door_join(&rollout_players[1].door, rig, "both", both, 2);
    options.version = "1.3";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -ENOENT);
    options.version = "1.2";
    options.zone = "nowhere";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -ENOENT);
    options.zone = "office";
    options.first = 0;
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -EINVAL);
    options.first = 1;
    store_rig_fine(hub_rollout_start(&rig->store, &options, &rollout_fault), &rollout_fault);
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -EALREADY);
    assert_non_null(strstr(rollout_fault.text, "version 1.2"));
    options.zone = "lab";
    assert_int_equal(hub_rollout_start(&rig->store, &options, &rollout_fault), -EALREADY);
    assert_non_null(strstr(rollout_fault.text, "zone office"));
    /* A stopped one is replaced. */
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    options.zone = "office";
    store_rig_fine(hub_rollout_start(&rig->store, &options, &rollout_fault), &rollout_fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM rollout WHERE state = 'replaced'"),
                     1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(stages_double, rollout_rig_setup, rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(a_stage_is_never_exceeded, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(failures_stop_a_rollout, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(a_stop_takes_orders_back, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(a_silent_door_has_failed, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(a_pause_of_the_hub_is_no_silence, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(doors_that_cannot_are_left_out, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(people_see_what_needs_attention_first, rollout_rig_setup,
                                        rollout_rig_teardown),
        cmocka_unit_test_setup_teardown(what_cannot_be_started, rollout_rig_setup,
                                        rollout_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
