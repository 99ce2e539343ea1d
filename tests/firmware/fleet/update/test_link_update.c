/* Updates at a door: from the order to the restart and what is told afterwards. The image's own
 * install-update takes the file. A script answers as isotherm(1) does with RAUC; test_cli_update
 * has the program itself with a stand-in for RAUC. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/update/update_inner.h"
#include "tests/firmware/fleet/update/update_rig.h"
#include "tests/support/scratch.h"

static void an_order_is_carried_out(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    assert_string_equal(link_update_report(rig->update)->version, "1.1");
    assert_string_equal(link_update_report(rig->update)->board, UPDATE_BOARD);
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
    update_rig_slots(rig, "1.1", true, true);
    rig->is_busy = false;
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_int_equal(rig->server.requests, 3);
    assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
    /* The machine restarts when nobody is there, as long as the order holds. */
    while (!scratch_exists(rig->restart)) {
        update_rig_turn(rig);
    }
    update_rig_stop(rig);
    assert_int_equal(unlink(rig->restart), 0);
    /* The new version runs, and its checks have not ended. */
    update_rig_slots(rig, "1.2", false, false);
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_stop(rig);
    update_rig_slots(rig, "1.2", true, false);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_HEALTHY);
    assert_true(
        iso_fleet_id_is_same(&link_update_report(rig->update)->rollout, &rig->order.rollout));
    /* Nothing begins anew. */
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_HEALTHY));
    assert_int_equal(rig->server.requests, 3);
}

static void a_version_that_goes_back_is_told(void **state)
{
    struct update_rig *rig = *state;
    struct link_update_record record = {
        .rollout = rig->order.rollout, .version = "1.2", .state = ISO_FLEET_UPDATE_INSTALLED};
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    assert_int_equal(link_update_record_write(path, &record, NULL), 0);
    update_rig_slots(rig, "1.1", true, false);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_WENT_BACK);
    /* The same rollout is not tried again, another one is. */
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_WENT_BACK));
    assert_int_equal(rig->server.requests, 0);
    rig->order.rollout = iso_fleet_id_random();
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
}

static void a_machine_without_slots_says_so(void **state)
{
    struct update_rig *rig = *state;
    update_rig_start(rig); /* exit code 3: there is no RAUC */
    update_rig_wait(rig, ISO_FLEET_UPDATE_NONE);
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_NONE));
    update_rig_stop(rig);
    assert_int_equal(unlink(rig->program), 0); /* the program is not there */
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_NONE);
    assert_int_equal(rig->server.requests, 0);
}

static void a_fetch_goes_on_after_a_restart(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    rig->cut_at = ISO_FLEET_UPDATE_PART_BYTES;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    update_rig_run(rig, 2);
    update_rig_stop(rig);
    rig->cut_at = 0;
    rig->tells = 0;
    update_rig_slots(rig, "1.1", true, true);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    update_rig_run(rig, 3);
    assert_int_equal(rig->last_after, ISO_FLEET_UPDATE_PART_BYTES);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_int_equal(rig->server.requests, 4);
}

static void another_file_is_not_installed(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    rig->is_damaged = true;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    assert_non_null(strstr(link_update_report(rig->update)->fault, "not the one"));
    assert_int_equal(rig->begins, 3); /* a line may have damaged the first two */
    assert_false(update_rig_has(rig, "installed"));
    assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
    /* It stays so after a restart. */
    update_rig_stop(rig);
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
}

/* The link is started again while the image has the file. */
static void a_restarted_link_waits_for_the_image(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    rig->has_no_units = true;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    while (!update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb")) {
        update_rig_turn(rig);
    }
    update_rig_stop(rig);
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLING);
    update_rig_slots(rig, "1.1", true, true);
    rig->has_no_units = false;
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_int_equal(rig->server.requests, 3);
}

static void results_that_are_not_of_the_hub_are_none(void **state)
{
    static const char *const bad[] = {
        "",
        "{\"from\":\"page\",\"at_s\":1,\"result\":{\"installed\":true}}",
        "{\"from\":\"hub\",\"at_s\":1,\"result\":{\"installed\":false}}",
        "{\"from\":\"hub\",\"at_s\":1,\"result\":{\"error\":{\"code\":\"x\"}}}",
        "{\"from\":\"hub\"}",
    };
    struct update_rig *rig = *state;
    char path[400];
    struct link_update_result result = {.why = "untouched"};
    (void)snprintf(path, sizeof path, "%s/result-hub.json", rig->state);
    assert_int_equal(link_update_result_read(path, &result), -EBADMSG);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scratch_write_text(path, bad[i]);
        assert_int_equal(link_update_result_read(path, &result), -EBADMSG);
        assert_string_equal(result.why, "untouched");
    }
}

static void an_order_that_holds_no_more_is_left(void **state)
{
    struct update_rig *rig = *state;
    update_rig_slots(rig, "1.1", true, false);
    rig->order.spread_s = 3600;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
    /* Two answers without the order, of which one may have lost it: the third one shows that it
     * does not come again. */
    for (int i = 0; i < 2; i++) {
        link_update_answered(rig->update);
        assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
    }
    link_update_answered(rig->update);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_IDLE));
    /* The hub refuses a part. */
    rig->order.spread_s = 0;
    rig->status = 403;
    update_rig_order(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    assert_int_equal(rig->server.requests, 1);
}

/* The line between hub and door loses one order in two. */
static void a_lost_order_cancels_nothing(void **state)
{
    struct update_rig *rig = *state;
    rig->cut_at = ISO_FLEET_UPDATE_PART_BYTES;
    update_rig_begin(rig, "\n");
    update_rig_run(rig, 2);
    for (int i = 0; i < 3; i++) {
        link_update_answered(rig->update);
        update_rig_order(rig);
        assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
        assert_true(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
    }
    rig->cut_at = 0;
    update_rig_slots(rig, "1.1", true, true);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    assert_int_equal(rig->begins, 1);
}

/* The hub has stopped a rollout and orders the version that runs. */
static void an_order_for_the_running_version_takes_the_place_of_another(void **state)
{
    struct update_rig *rig = *state;
    struct link_update_record record = {
        .rollout = rig->order.rollout, .version = "1.2", .state = ISO_FLEET_UPDATE_INSTALLED};
    const struct iso_fleet_update first = rig->order;
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    assert_int_equal(link_update_record_write(path, &record, NULL), 0);
    update_rig_slots(rig, "1.1", true, true);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_order(rig);
    rig->order.rollout = iso_fleet_id_random();
    strcpy(rig->order.version, "1.1");
    update_rig_order(rig);
    for (unsigned tells = rig->tells; rig->tells < tells + 2;) {
        update_rig_turn(rig);
    }
    assert_false(scratch_exists(rig->restart));
    rig->order = first;
    update_rig_order(rig);
    while (!scratch_exists(rig->restart)) {
        update_rig_turn(rig);
    }
    /* What is being fetched is left. */
    update_rig_stop(rig);
    assert_int_equal(unlink(path), 0);
    rig->order.spread_s = 3600;
    rig->tells = 0;
    update_rig_begin(rig, "\n");
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
    rig->order.rollout = iso_fleet_id_random();
    strcpy(rig->order.version, "1.1");
    update_rig_order(rig);
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_IDLE));
    assert_int_equal(rig->server.requests, 0);
}

/* A part of the file is there, and the order holds no more. */
static void the_file_goes_with_its_order(void **state)
{
    struct update_rig *rig = *state;
    static const char part[] = "var/lib/isotherm-update/hub/bundle.part";
    for (int i = 0; i < 3; i++) {
        rig->cut_at = ISO_FLEET_UPDATE_PART_BYTES;
        update_rig_begin(rig, "\n");
        update_rig_run(rig, rig->server.requests + 2);
        assert_true(update_rig_has(rig, part));
        if (i == 0) { /* the link is told */
            link_update_answered(rig->update);
            link_update_answered(rig->update);
            assert_true(update_rig_has(rig, part));
            link_update_answered(rig->update);
        } else if (i == 1) { /* it did not run then */
            update_rig_stop(rig);
            rig->tells = 0;
            update_rig_start(rig);
            link_update_answered(rig->update);
            update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
            link_update_answered(rig->update);
            assert_true(update_rig_has(rig, part)); /* the order may come behind the answer */
            link_update_answered(rig->update);
        } else { /* the door leaves its fleet */
            update_rig_stop(rig);
            link_update_forget(rig->folder, rig->state);
            assert_false(update_rig_has(rig, "update.record"));
            update_rig_start(rig);
        }
        assert_false(update_rig_has(rig, part));
        update_rig_stop(rig);
        rig->tells = 0;
    }
}

/* A rollout has failed, and a stick or the page has brought its version since. */
static void a_version_that_came_another_way_is_no_failure(void **state)
{
    static const enum iso_fleet_update_state failures[] = {ISO_FLEET_UPDATE_FAILED,
                                                           ISO_FLEET_UPDATE_WENT_BACK};
    struct update_rig *rig = *state;
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    for (size_t i = 0; i < sizeof failures / sizeof *failures; i++) {
        struct link_update_record record = {
            .rollout = rig->order.rollout, .version = "1.2", .state = failures[i]};
        assert_int_equal(link_update_record_write(path, &record, NULL), 0);
        update_rig_slots(rig, "1.1", true, false);
        update_rig_start(rig);
        update_rig_wait(rig, failures[i]);
        update_rig_stop(rig);
        update_rig_slots(rig, "1.2", true, false);
        update_rig_start(rig);
        update_rig_wait(rig, ISO_FLEET_UPDATE_HEALTHY);
        update_rig_stop(rig);
    }
}

static void nothing_restarts_while_somebody_is_there(void **state)
{
    struct update_rig *rig = *state;
    struct link_update_record record = {
        .rollout = rig->order.rollout, .version = "1.2", .state = ISO_FLEET_UPDATE_INSTALLED};
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    assert_int_equal(link_update_record_write(path, &record, NULL), 0);
    update_rig_slots(rig, "1.1", true, true);
    rig->is_busy = true;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_order(rig);
    /* Three looks later it has not restarted; nor without a daemon, which could say who is there.
     */
    for (unsigned tells = rig->tells; rig->tells < tells + 2;) {
        update_rig_turn(rig);
    }
    assert_false(scratch_exists(rig->restart));
    rig->is_busy = false;
    /* Nor after a time without answers, in which the hub may have taken the order back. */
    rig->update->holds_until_us = 1;
    for (unsigned tells = rig->tells; rig->tells < tells + 2;) {
        update_rig_turn(rig);
    }
    assert_false(scratch_exists(rig->restart));
    update_rig_order(rig);
    while (!scratch_exists(rig->restart)) {
        update_rig_turn(rig);
    }
}

static void slots_that_cannot_be_read_are_none(void **state)
{
    static const char *const bad[] = {
        "",
        "{}",
        "{\"version\":\"1.1\",\"board\":\"b\",\"slots\":[]}",
        "{\"version\":\"1.1\",\"board\":\"b c\",\"slots\":[{\"running\":true}]}",
        "{\"version\":null,\"board\":\"b\",\"slots\":[{\"running\":true}]}",
    };
    struct link_update_slots slots = {.waiting = true};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(link_update_slots_read(bad[i], &slots), -EBADMSG);
        assert_true(slots.waiting);
    }
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, update_rig_setup, update_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(an_order_is_carried_out),
        TEST(a_version_that_goes_back_is_told),
        TEST(a_machine_without_slots_says_so),
        TEST(a_fetch_goes_on_after_a_restart),
        TEST(another_file_is_not_installed),
        TEST(a_restarted_link_waits_for_the_image),
        TEST(the_file_goes_with_its_order),
        TEST(results_that_are_not_of_the_hub_are_none),
        TEST(an_order_that_holds_no_more_is_left),
        TEST(a_lost_order_cancels_nothing),
        TEST(an_order_for_the_running_version_takes_the_place_of_another),
        TEST(a_version_that_came_another_way_is_no_failure),
        TEST(nothing_restarts_while_somebody_is_there),
        cmocka_unit_test(slots_that_cannot_be_read_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
