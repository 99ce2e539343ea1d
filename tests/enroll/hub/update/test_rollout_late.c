/* Doors that come and go, pauses of the hub, and doors that come back when their rollout is done.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/hub/update/rollout_rig.h"

enum {
    SILENT_MINUTES = HUB_UPDATE_SILENT_S / 60 + 1,
    STEP_S = 240, /* between two questions in a test of days: not yet a pause of the hub */
    DAY_STEPS = 24 * 3600 / STEP_S,
};

/* The rollout is looked at so often, and no door asks. */
static void silence(struct store_rig *rig, int looks, int64_t step_s)
{
    for (int i = 0; i < looks; i++) {
        store_rig_now_s += step_s;
        store_rig_fine(hub_rollouts_look(&rig->store, &rollout_fault), &rollout_fault);
    }
}

static void minutes_of_silence(struct store_rig *rig, int minutes)
{
    silence(rig, minutes, 60);
}

static void ask_without_words(struct store_rig *rig, struct player *p)
{
    p->door.health = NULL;
    store_rig_fine(played_door_ask(&p->door, &rig->store, &rollout_fault), &rollout_fault);
}

/* A zone of two doors: the first one is healthy, the second one was told and is silent. */
static struct player *last_stage_without_a_door(struct store_rig *rig, uint32_t stop_after)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    rollout_rig_join(rig, 0, &zone);
    rollout_rig_join(rig, 1, &zone);
    rollout_rig_start(rig, 2, stop_after, 0);
    for (int i = 0; i < 4; i++) {
        rollout_rig_step(rig, &rollout_players[0]);
    }
    rollout_rig_ask(rig, &rollout_players[1]);
    assert_true(rollout_players[1].door.is_ordered);
    minutes_of_silence(rig, SILENT_MINUTES);
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
    return &rollout_players[1];
}

/* ---- doors that come and go ---- */

/* Each time it is told again, for two days. */
static void a_door_that_comes_and_goes_fails_for_good(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    int returns = 0;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 0);
    rollout_rig_ask(rig, p);
    for (; p->door.is_ordered && returns < 200; returns++) {
        minutes_of_silence(rig, SILENT_MINUTES);
        rollout_rig_ask(rig, p);
    }
    /* Half an hour and a minute each. */
    assert_in_range(returns, HUB_UPDATE_STILL_S / 60 / SILENT_MINUTES - 1,
                    HUB_UPDATE_STILL_S / 60 / SILENT_MINUTES + 2);
    rollout_rig_expect_first(rig, "door00 failed it was told for too long");
    rollout_rig_ask(rig, p);
    assert_false(p->door.is_ordered);
}

/* The time in which it was away does not count, once the hub has given it up. */
static void a_door_that_was_away_for_days_has_its_time(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 7 * 24 * 3600);
    rollout_rig_ask(rig, p);
    silence(rig, 4 * DAY_STEPS, STEP_S);
    rollout_rig_ask(rig, p);
    assert_true(p->door.is_ordered);
    for (int i = 0; i < HUB_UPDATE_STILL_S / STEP_S - SILENT_MINUTES * 60 / STEP_S - 1; i++) {
        store_rig_now_s += STEP_S;
        rollout_rig_ask(rig, p);
    }
    assert_true(p->door.is_ordered);
}

/* The next stage comes an hour after both doors have come to an end for the first time. */
static void a_door_that_comes_and_goes_does_not_delay_a_stage(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[1];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 5, 3600);
    for (int i = 0; i < 4; i++) {
        rollout_rig_step(rig, &rollout_players[0]);
    }
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
    rollout_rig_ask(rig, p);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(rollout_rig_now(rig).stage.stage, 1);
        minutes_of_silence(rig, SILENT_MINUTES);
        assert_int_equal(rollout_rig_count(rig, "failed"), 1);
        if (i < 2) {
            rollout_rig_ask(rig, p);
            assert_true(p->door.is_ordered);
        }
    }
    assert_int_equal(rollout_rig_now(rig).stage.stage, 2);
}

/* ---- pauses of the hub ---- */

/* It is switched off for ten minutes each day. */
static void pauses_do_not_prolong_the_time_of_a_door(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 5, 0);
    rollout_rig_step(rig, p);
    strcpy(p->state, "installed");
    for (int day = 0; day < 2; day++) {
        for (int i = 0; i < DAY_STEPS; i++) {
            store_rig_now_s += STEP_S;
            rollout_rig_ask(rig, p);
        }
        store_rig_now_s += 600;
        rollout_rig_ask(rig, p);
    }
    /* The pauses themselves do not count. */
    assert_int_equal(rollout_rig_count(rig, "installed"), 1);
    store_rig_now_s += 60;
    rollout_rig_ask(rig, p);
    rollout_rig_expect_first(rig, "door00 failed it was installed for too long");
}

/* ---- a rollout that is done ---- */

static void a_silent_door_of_the_last_stage_is_told_again(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = last_stage_without_a_door(rig, 1);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
    rollout_rig_ask(rig, &rollout_players[0]);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
    ask_without_words(rig, p); /* it does not know yet what it has */
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
    rollout_rig_step(rig, p);
    assert_true(p->door.is_ordered);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_RUNNING);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'update-again'"),
                     1);
    /* People can stop it again, and it comes to its end again. */
    store_rig_fine(hub_rollout_stop(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    rollout_rig_ask(rig, p);
    assert_false(p->door.is_ordered);
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    for (int i = 0; i < 4; i++) {
        store_rig_now_s += 60;
        rollout_rig_step(rig, p);
    }
    assert_int_equal(rollout_rig_count(rig, "healthy"), 2);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
}

static void a_door_of_an_old_rollout_is_not_told(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = last_stage_without_a_door(rig, 1);
    /* It has left the zone. */
    store_rig_fine(hub_db_script(rig->store.db,
                                 "CREATE TABLE kept AS SELECT * FROM door_zone WHERE door = "
                                 "(SELECT id FROM door WHERE name = 'door01'); DELETE FROM "
                                 "door_zone WHERE door IN (SELECT door FROM kept)",
                                 &rollout_fault),
                   &rollout_fault);
    rollout_rig_ask(rig, p);
    assert_false(p->door.is_ordered);
    /* The zone has had another one since. */
    store_rig_now_s += 60;
    rollout_rig_start(rig, 2, 1, 0);
    store_rig_fine(
        hub_db_script(rig->store.db, "INSERT INTO door_zone SELECT * FROM kept", &rollout_fault),
        &rollout_fault);
    rollout_rig_ask(rig, p);
    assert_false(p->door.is_ordered);
    assert_int_equal(rollout_rig_count(rig, "failed"), 1);
}

/* It says so only when the rollout is done. */
static void a_version_that_is_left_later_has_gone_back(void **state)
{
    struct store_rig *rig = *state;
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, ROLLOUT_DOORS, 5, 0);
    for (int i = 0; i < 5; i++) {
        rollout_rig_round(rig);
    }
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
    strcpy(rollout_players[3].state, "went-back");
    strcpy(rollout_players[3].version, "1.1");
    rollout_rig_ask(rig, &rollout_players[3]);
    assert_false(rollout_players[3].door.is_ordered);
    assert_int_equal(rollout_rig_count(rig, "went-back"), 1);
    rollout_rig_expect_first(rig, "door03 went-back ");
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_DONE);
}

/* The same while it runs; it is one of the failures that stop it. */
static void a_healthy_door_that_goes_back_counts(void **state)
{
    struct store_rig *rig = *state;
    struct player *p = &rollout_players[0];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 1, 0, 3600);
    for (int i = 0; i < 4; i++) {
        rollout_rig_step(rig, p);
    }
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
    strcpy(p->state, "went-back");
    strcpy(p->version, "1.1");
    rollout_rig_ask(rig, p);
    assert_int_equal(rollout_rig_count(rig, "went-back"), 1);
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_STOPPED);
}

/* ---- a rollout that goes on ---- */

/* What has failed before is not told again: neither a door that was too slow nor one that has gone
 * back, although it restarts and says nothing at first. */
static void a_restart_does_not_make_a_failed_door_able(void **state)
{
    struct store_rig *rig = *state;
    struct player *slow = &rollout_players[0], *broken = &rollout_players[1];
    (void)rollout_rig_join_all(rig);
    rollout_rig_start(rig, 2, 1, 0);
    rollout_rig_step(rig, slow);
    rollout_rig_ask(rig, broken);
    strcpy(broken->state, "went-back");
    rollout_rig_ask(rig, broken);
    for (int i = 0; i < 2 * DAY_STEPS + 1; i++) {
        store_rig_now_s += STEP_S;
        rollout_rig_ask(rig, slow);
    }
    assert_int_equal(rollout_rig_now(rig).stage.state, HUB_ROLLOUT_STOPPED);
    store_rig_fine(hub_rollout_resume(&rig->store, "office", NULL, &rollout_fault), &rollout_fault);
    strcpy(slow->state, "idle");
    strcpy(broken->state, "idle");
    for (int i = 0; i < 3; i++) {
        ask_without_words(rig, slow);
        ask_without_words(rig, broken);
        assert_int_equal(rollout_rig_count(rig, "unable"), 0);
        rollout_rig_ask(rig, slow);
        rollout_rig_ask(rig, broken);
        assert_false(slow->door.is_ordered);
        assert_false(broken->door.is_ordered);
    }
    rollout_rig_expect_first(rig, "door00 failed it was fetching for too long");
    /* Somebody restarts it by hand, and it has the version. */
    strcpy(slow->version, "1.2");
    rollout_rig_ask(rig, slow);
    assert_int_equal(rollout_rig_count(rig, "healthy"), 1);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, rollout_rig_setup, rollout_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_door_that_comes_and_goes_fails_for_good),
        TEST(a_door_that_was_away_for_days_has_its_time),
        TEST(a_door_that_comes_and_goes_does_not_delay_a_stage),
        TEST(pauses_do_not_prolong_the_time_of_a_door),
        TEST(a_silent_door_of_the_last_stage_is_told_again),
        TEST(a_door_of_an_old_rollout_is_not_told),
        TEST(a_version_that_is_left_later_has_gone_back),
        TEST(a_healthy_door_that_goes_back_counts),
        TEST(a_restart_does_not_make_a_failed_door_able),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
