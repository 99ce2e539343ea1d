/* A version that runs and is on trial: the boot loader may still leave it, so it is not healthy
 * before it has passed its checks; and the former version that runs again. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/update/update_inner.h"
#include "tests/firmware/fleet/update/update_rig.h"
#include "tests/support/scratch.h"

/* What the door has stored of the rollout of version 1.2, and the link is started. */
static void start_with(struct update_rig *rig, enum iso_fleet_update_state state,
                       const char *former)
{
    struct link_update_record record = {
        .rollout = rig->order.rollout, .version = "1.2", .state = state};
    char path[320];
    (void)snprintf(record.former, sizeof record.former, "%s", former);
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    assert_int_equal(link_update_record_write(path, &record, NULL), 0);
    rig->tells = 0;
    update_rig_start(rig);
}

static void end_of_look(struct update_rig *rig)
{
    while (rig->update->step == LINK_UPDATE_LOOK) {
        update_rig_turn(rig);
    }
}

/* The door looks at the slots again now, and not only in a quarter of a minute. */
static void look_again(struct update_rig *rig)
{
    assert_int_equal(rig->update->step, LINK_UPDATE_INSTALLED);
    rig->tells = 0;
    link_update_in(rig->update, 0);
}

static void restart(struct update_rig *rig)
{
    update_rig_stop(rig);
    rig->tells = 0;
    update_rig_start(rig);
}

/* RAUC says that the slot is good: it can be started (isotherm-b+2-1.efi). */
static void a_version_on_trial_is_not_healthy(void **state)
{
    struct update_rig *rig = *state;
    rig->is_on_trial = true;
    update_rig_slots(rig, "1.2", true, false);
    start_with(rig, ISO_FLEET_UPDATE_INSTALLED, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    look_again(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    end_of_look(rig);
    /* It is not restarted, and no other order begins. */
    update_rig_order(rig);
    const struct iso_fleet_id rollout = rig->order.rollout;
    rig->order.rollout = iso_fleet_id_random();
    strcpy(rig->order.version, "1.3");
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_INSTALLED));
    assert_true(iso_fleet_id_is_same(&link_update_report(rig->update)->rollout, &rollout));
    assert_false(scratch_exists(rig->restart));
    /* Then it is marked as good. */
    rig->is_on_trial = false;
    update_rig_slots(rig, "1.2", true, false);
    look_again(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_HEALTHY);
    assert_true(iso_fleet_id_is_same(&link_update_report(rig->update)->rollout, &rollout));
}

/* Three attempts did not pass the checks. */
static void a_version_that_ends_on_trial_has_gone_back(void **state)
{
    struct update_rig *rig = *state;
    rig->is_on_trial = true;
    update_rig_slots(rig, "1.2", true, false);
    start_with(rig, ISO_FLEET_UPDATE_INSTALLED, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    rig->is_on_trial = false;
    update_rig_slots(rig, "1.1", true, false);
    restart(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_WENT_BACK);
    assert_string_equal(link_update_report(rig->update)->fault,
                        "the new version did not pass its checks");
}

/* It was healthy, and the former version runs; a third version is another matter. */
static void a_healthy_version_that_is_left_has_gone_back(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    start_with(rig, ISO_FLEET_UPDATE_HEALTHY, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_WENT_BACK);
    assert_non_null(strstr(link_update_report(rig->update)->fault, "former version runs again"));
    update_rig_order(rig); /* the same is not tried again */
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_WENT_BACK));
    assert_int_equal(rig->server.requests, 0);
    restart(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_WENT_BACK);
    update_rig_stop(rig);
    update_rig_slots(rig, "1.3", true, false);
    start_with(rig, ISO_FLEET_UPDATE_HEALTHY, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
}

/* A start in which nobody has said yet that the version is proven takes nothing back. */
static void a_healthy_version_stays_so_over_a_restart(void **state)
{
    struct update_rig *rig = *state;
    rig->is_on_trial = true;
    update_rig_slots(rig, "1.2", true, false);
    start_with(rig, ISO_FLEET_UPDATE_HEALTHY, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_HEALTHY);
    rig->is_on_trial = false;
    update_rig_slots(rig, "1.2", true, false);
    look_again(rig);
    while (rig->update->step != LINK_UPDATE_IDLE) {
        update_rig_turn(rig);
    }
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_HEALTHY));
}

/* A stick has brought the version on trial; for the hub a door that does nothing and runs the
 * version of its rollout is healthy, so it does not say that it does nothing. */
static void a_version_on_trial_of_another_way_is_being_checked(void **state)
{
    static const struct iso_fleet_id none = {.bytes = {0}};
    struct update_rig *rig = *state;
    rig->is_on_trial = true;
    update_rig_slots(rig, "1.2", true, false);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    assert_true(iso_fleet_id_is_same(&link_update_report(rig->update)->rollout, &none));
    strcpy(rig->order.version, "1.3");
    update_rig_order(rig); /* RAUC would refuse it */
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_INSTALLED));
    rig->is_on_trial = false;
    update_rig_slots(rig, "1.2", true, false);
    look_again(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
}

/* A rollout has failed, and the version of a stick is on trial: it is no success yet. */
static void a_failure_is_not_forgotten_on_trial(void **state)
{
    struct update_rig *rig = *state;
    rig->is_on_trial = true;
    update_rig_slots(rig, "1.2", true, false);
    start_with(rig, ISO_FLEET_UPDATE_FAILED, "1.1");
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    rig->is_on_trial = false;
    update_rig_slots(rig, "1.2", true, false);
    look_again(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_HEALTHY);
}

/* What `isotherm update --json` does not say is not true. */
static void nothing_is_proven_unless_it_is_said(void **state)
{
    static const char *const said[] = {"", "\"proven\":null,", "\"proven\":\"yes\",",
                                       "\"proven\":false,", "\"proven\":true,"};
    (void)state;
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        struct link_update_slots slots = {.proven = true};
        char text[200];
        (void)snprintf(text, sizeof text,
                       "{%s\"version\":\"1.2\",\"board\":\"b\",\"slots\":[{\"running\":true,"
                       "\"good\":true}]}",
                       said[i]);
        assert_int_equal(link_update_slots_read(text, &slots), 0);
        assert_true(slots.good);
        assert_int_equal(slots.proven, i == 4);
    }
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, update_rig_setup, update_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_version_on_trial_is_not_healthy),
        TEST(a_version_that_ends_on_trial_has_gone_back),
        TEST(a_healthy_version_that_is_left_has_gone_back),
        TEST(a_healthy_version_stays_so_over_a_restart),
        TEST(a_version_on_trial_of_another_way_is_being_checked),
        TEST(a_failure_is_not_forgotten_on_trial),
        cmocka_unit_test(nothing_is_proven_unless_it_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
