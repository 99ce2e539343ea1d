/* Doors that come back, are expelled or never ask again during a rollout, and what may go on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/store/hub_door.h"
#include "tests/enroll/hub/update/rollout_rig.h"

/* The rollout is looked at each minute for so long, and no door asks. */
static void minutes_of_silence(struct store_rig *rig, int minutes)
{
    for (int i = 0; i < minutes; i++) {
        store_rig_now_s += 60;
        store_rig_fine(hub_rollouts_look(&rig->store, &rollout_fault), &rollout_fault);
    }
}

static void silence_is_noticed_although_nobody_asks(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    rollout_rig_join(rig, 0, &zone);
    rollout_rig_start(rig, 1, 0, 0);
    rollout_rig_step(rig, &rollout_players[0]);
    minutes_of_silence(rig, HUB_UPDATE_SILENT_S / 60);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    minutes_of_silence(rig, 1);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
}

/* A power cut while it fetched: it reports that it does nothing, and names the rollout. */
static void a_door_that_comes_back_is_told_again(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 1, 0);
    rollout_rig_step(rig, p);
    rollout_rig_ask(rig, p);
    assert_int_equal(rollout_rig_count(rig, "fetching"), 1);
    minutes_of_silence(rig, HUB_UPDATE_SILENT_S / 60 + 1);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
    strcpy(p->state, "idle");
    rollout_rig_ask(rig, p);
    assert_int_equal(rollout_rig_count(rig, "told"), 1);
    assert_true(p->door.is_ordered);
}

/* The first question after a restart knows neither state nor board. */
static void an_order_holds_over_a_restart_of_the_door(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 0, 0);
    rollout_rig_step(rig, p);
    assert_true(p->door.is_ordered);
    p->door.health = NULL;
    store_rig_fine(played_door_ask(&p->door, &rig->store, &rollout_fault), &rollout_fault);
    assert_true(p->door.is_ordered);
    assert_string_equal(p->door.update.board, ROLLOUT_BOARD);
}

static void expelled_doors_are_left_out(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 0, 0);
    rollout_rig_step(rig, &rollout_players[0]); /* told */
    store_rig_fine(hub_door_expel(&rig->store, &rollout_players[0].door.id, &rollout_fault),
                   &rollout_fault);
    store_rig_fine(hub_door_expel(&rig->store, &rollout_players[5].door.id, &rollout_fault),
                   &rollout_fault);
    for (int i = 0; i < 40 && rollout_rig_now(rig).stage.state == HUB_ROLLOUT_RUNNING; i++) {
        store_rig_now_s += 60;
        for (size_t k = 1; k < ROLLOUT_DOORS; k++) {
            if (k != 5) {
                rollout_rig_step(rig, &rollout_players[k]);
            }
        }
    }
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
    assert_int_equal(rollout_rig_count(rig, "healthy"), ROLLOUT_DOORS - 2);
    assert_int_equal(rollout_rig_count(rig, "unable"), 2);
}

static void a_rollout_goes_on_only_if_it_still_can(void **state)
{
    struct store_rig *rig = *state;
    struct hub_rollout_options options = {.version = "1.2", .zone = "lab", .first = 1};
    const struct iso_fleet_id both[2] = {store_rig_zone(rig, "office"), store_rig_zone(rig, "lab")};
    played_door_join(&rollout_players[0].door, rig, "both", both, 2);
    rollout_rig_start(rig, 1, 0, 0);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    /* Meanwhile its door takes part in another one. */
    store_rig_fine(hub_rollout_start(&rig->store, &options, &rollout_fault), &rollout_fault);
    assert_int_equal(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), -EALREADY);
    assert_non_null(strstr(rollout_fault.text, "zone lab"));
    store_rig_fine(hub_rollout_stop(&rig->store, "lab", NULL, &rollout_fault), &rollout_fault);
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    /* The version of a stopped one may be removed; then it cannot go on. */
    assert_int_equal(hub_update_remove(&rig->store, "1.2", &rollout_fault), -EALREADY);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    store_rig_fine(hub_update_remove(&rig->store, "1.2", &rollout_fault), &rollout_fault);
    assert_int_equal(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), -ENOENT);
}

/* The door reports each minute. */
static void minutes_of(struct store_rig *rig, struct player *p, int minutes)
{
    for (int i = 0; i < minutes; i++) {
        store_rig_now_s += 60;
        rollout_rig_ask(rig, p);
    }
}

/* Its link does not work any more: the daemon goes on to report, without a word of the image. */
static void a_door_that_says_nothing_of_updates_fails(void **state)
{
    static const char *const healths[] = {NULL, "{\"update-state\":\"none\"}"};
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 0);
    for (size_t i = 0; i < 2; i++) {
        rollout_rig_ask(rig, p);
        assert_int_equal(rollout_rig_count(rig, "told"), 1);
        p->door.health = healths[i];
        for (int minute = 0; minute <= HUB_UPDATE_SILENT_S / 60; minute++) {
            store_rig_now_s += 60;
            store_rig_fine(played_door_ask(&p->door, &rig->store, &rollout_fault), &rollout_fault);
            assert_int_equal(rollout_rig_count(rig, "told"), 1);
        }
        rollout_rig_expect_first(rig, "door00 told it says nothing of its updates");
        minutes_of_silence(rig, 1); /* not silence: it has reported a minute ago */
        rollout_rig_expect_first(rig, "door00 failed it reports, but says nothing of its updates");
        /* It says no more, and stays failed; then it says more, and is told again. */
        store_rig_fine(played_door_ask(&p->door, &rig->store, &rollout_fault), &rollout_fault);
        assert_int_equal(rollout_rig_count(rig, "failed"), 1);
        assert_false(p->door.is_ordered);
    }
    rollout_rig_ask(rig, p);
    assert_true(p->door.is_ordered);
}

/* It waits for ever for a quiet moment to restart. */
static void a_door_that_does_not_move_fails(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 0);
    rollout_rig_step(rig, p);
    strcpy(p->state, "installed");
    minutes_of(rig, p, HUB_UPDATE_STILL_S / 60); /* since it was told */
    assert_int_equal(rollout_rig_count(rig, "installed"), 1);
    minutes_of(rig, p, 1);
    rollout_rig_expect_first(rig, "door00 failed it was installed for too long");
    /* The stage does not wait for this door, and the hub does not tell the door the same order
     * again. */
    minutes_of(rig, p, 2);
    strcpy(p->state, "idle");
    minutes_of(rig, p, 1);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
    assert_false(p->door.is_ordered);
    rollout_rig_ask(rig, &rollout_players[1]);
    assert_true(rollout_players[1].door.is_ordered);
    /* Somebody restarts it. */
    strcpy(p->state, "healthy");
    strcpy(p->version, "1.2");
    minutes_of(rig, p, 1);
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
    assert_int_equal(rollout_rig_count(rig, "failed"), 0);
}

static void a_stopped_rollout_waits_for_nobody(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 0);
    rollout_rig_step(rig, p);
    rollout_rig_ask(rig, p);
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    minutes_of(rig, p, HUB_UPDATE_STILL_S / 60 + 10);
    assert_int_equal(rollout_rig_count(rig, "fetching"), 1);
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    minutes_of(rig, p, 2);
    assert_int_equal(rollout_rig_count(rig, "fetching"), 1);
    assert_true(p->door.is_ordered);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, rollout_rig_setup, rollout_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(silence_is_noticed_although_nobody_asks),
        TEST(a_door_that_comes_back_is_told_again),
        TEST(an_order_holds_over_a_restart_of_the_door),
        TEST(expelled_doors_are_left_out),
        TEST(a_rollout_goes_on_only_if_it_still_can),
        TEST(a_door_that_says_nothing_of_updates_fails),
        TEST(a_door_that_does_not_move_fails),
        TEST(a_stopped_rollout_waits_for_nobody),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
