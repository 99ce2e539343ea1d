/* Refusals of an update, which are tried again or are not, and what the slots say when the image
 * has said nothing. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/update/update_inner.h"
#include "tests/firmware/fleet/update/update_rig.h"
#include "tests/support/scratch.h"

static char *read_text(const struct update_rig *rig, const char *name)
{
    char path[340];
    size_t size = 0;
    (void)snprintf(path, sizeof path, "%s/%s", rig->folder, name);
    uint8_t *bytes = scratch_read(path, &size);
    char *text = strndup((const char *)bytes, size);
    free(bytes);
    assert_non_null(text);
    return text;
}

static void what_cannot_succeed_is_not_tried_again(void **state)
{
    static const char *const codes[] = {"other-board", "not-newer", "foreign-key", "bad-file"};
    struct update_rig *rig = *state;
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        char line[80], path[340];
        assert_int_equal(link_update_tries(codes[i]), 1);
        rig->order.rollout = iso_fleet_id_random();
        (void)snprintf(line, sizeof line, "%s\n", codes[i]);
        update_rig_begin(rig, line);
        update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
        (void)snprintf(line, sizeof line, "refused: %s", codes[i]);
        assert_string_equal(link_update_report(rig->update)->fault, line);
        assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
        (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
        update_rig_stop(rig);
        assert_int_equal(unlink(path), 0);
        rig->tells = 0;
    }
    char *asked = read_text(rig, "asked");
    assert_string_equal(asked, "other-board\nnot-newer\nforeign-key\nbad-file\n");
    free(asked);
}

/* RAUC works for another way, and then the running version is on trial. */
static void what_passes_by_itself_is_tried_again(void **state)
{
    struct update_rig *rig = *state;
    update_rig_begin(rig, "busy\non-trial\n\n");
    while (!strstr(link_update_report(rig->update)->fault, "refused: on-trial")) {
        update_rig_turn(rig);
    }
    assert_true(update_rig_is_told(rig, ISO_FLEET_UPDATE_FETCHING));
    rig->has_no_units = true;
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLING);
    assert_string_equal(link_update_report(rig->update)->fault, "refused: on-trial");
    rig->has_no_units = false;
    update_rig_slots(rig, "1.1", true, true);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_string_equal(link_update_report(rig->update)->fault, "");
    char *asked = read_text(rig, "asked");
    assert_string_equal(asked, "busy\non-trial\n\n");
    free(asked);
    assert_int_equal(rig->server.requests, 3); /* the file was not fetched again */
    assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
}

static void a_refusal_that_does_not_pass_is_a_failure_at_last(void **state)
{
    struct update_rig *rig = *state;
    assert_int_equal(link_update_tries("not-installed"), 3);
    update_rig_begin(rig, "not-installed\n");
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    char *asked = read_text(rig, "asked");
    assert_string_equal(asked, "not-installed\nnot-installed\nnot-installed\n");
    free(asked);
    assert_false(update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.part"));
}

static void a_damaged_download_is_fetched_again(void **state)
{
    struct update_rig *rig = *state;
    rig->damaged = 1;
    update_rig_begin(rig, "\n");
    while (rig->begins < 2) {
        update_rig_turn(rig);
    }
    update_rig_slots(rig, "1.1", true, true);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
    assert_int_equal(rig->begins, 2);
}

/* RAUC has made root its owner; here, where the test may be root, it is no file at all. */
static void a_file_that_cannot_be_opened_is_fetched_again(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    (void)snprintf(path, sizeof path, "%s/hub/bundle.part", rig->state);
    assert_int_equal(mkfifo(path, 0600), 0);
    update_rig_begin(rig, "\n");
    update_rig_slots(rig, "1.1", true, true);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
    update_rig_expect_installed(rig);
}

/* How often an order was refused is not forgotten with the link. */
static void tries_are_counted_over_a_restart(void **state)
{
    struct update_rig *rig = *state;
    update_rig_begin(rig, "not-installed\n");
    while (!strstr(link_update_report(rig->update)->fault, "refused")) {
        update_rig_turn(rig);
    }
    update_rig_stop(rig);
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    char *asked = read_text(rig, "asked");
    assert_string_equal(asked, "not-installed\nnot-installed\nnot-installed\n");
    free(asked);
}

/* The hub answers questions, and serves nothing: a refusal. It is away: none. */
static void a_hub_that_is_away_is_no_failure(void **state)
{
    struct update_rig *rig = *state;
    rig->status = 503;
    update_rig_begin(rig, "\n");
    update_rig_run(rig, 1);
    rig->update->backoff.failures = 19; /* the next one is the twentieth in a row */
    rig->update->holds_until_us = 1;
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    rig->status = 200;
    update_rig_slots(rig, "1.1", true, true);
    update_rig_order(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
}

/* Takes the bundle away, as an image does whose program is killed then. */
static void lose_bundle(struct update_rig *rig)
{
    char path[400];
    while (!update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb")) {
        update_rig_turn(rig);
    }
    (void)snprintf(path, sizeof path, "%s/hub/bundle.raucb", rig->state);
    assert_int_equal(unlink(path), 0);
}

/* What the result file said before is not taken for the answer, nor what the slots do not show. */
static void an_image_that_says_nothing_is_asked_again(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    (void)snprintf(path, sizeof path, "%s/result-hub.json", rig->state);
    scratch_write_text(path, "{\"from\":\"hub\",\"at_s\":1,\"result\":{\"installed\": true}}\n");
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    for (int i = 0; i < 3; i++) {
        lose_bundle(rig);
        assert_false(update_rig_is_told(rig, ISO_FLEET_UPDATE_FAILED));
    }
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    assert_string_equal(link_update_report(rig->update)->fault,
                        "the image has not said what became of the update");
    assert_int_equal(rig->server.requests, 3);
}

/* The update is installed, and its result is lost. */
static void the_slots_say_what_was_installed(void **state)
{
    struct update_rig *rig = *state;
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    update_rig_slots_with(rig, "1.1", "1.2", true, true);
    lose_bundle(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_INSTALLED);
}

/* So is it with a link that was started again meanwhile: neither the refusal that the image has
 * left is lost, nor is an old one taken for it. */
static void a_restarted_link_takes_the_result(void **state)
{
    struct update_rig *rig = *state;
    char path[400];
    rig->has_no_units = true;
    update_rig_begin(rig, "\n");
    while (!update_rig_has(rig, "var/lib/isotherm-update/hub/bundle.raucb")) {
        update_rig_turn(rig);
    }
    update_rig_stop(rig);
    (void)snprintf(path, sizeof path, "%s/hub/bundle.raucb", rig->state);
    assert_int_equal(unlink(path), 0);
    (void)snprintf(path, sizeof path, "%s/result-hub.json", rig->state);
    scratch_write_text(path, "{\"from\":\"hub\",\"result\":{\"error\":{\"code\":\"not-newer\","
                             "\"message\":\"older\"}}}\n");
    rig->tells = 0;
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
    assert_string_equal(link_update_report(rig->update)->fault, "older");
}

/* A stick has put another version into the slot meanwhile, or that one runs already. */
static void a_version_of_another_way_is_named(void **state)
{
    struct update_rig *rig = *state;
    struct link_update_record record = {.rollout = rig->order.rollout,
                                        .version = "1.2",
                                        .former = "1.1",
                                        .state = ISO_FLEET_UPDATE_INSTALLED};
    char path[320];
    (void)snprintf(path, sizeof path, "%s/update.record", rig->folder);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(link_update_record_write(path, &record, NULL), 0);
        update_rig_slots_with(rig, i == 0 ? "1.1" : "1.3", i == 0 ? "1.3" : "1.1", true, i == 0);
        update_rig_start(rig);
        update_rig_wait(rig, ISO_FLEET_UPDATE_FAILED);
        assert_string_equal(link_update_report(rig->update)->fault,
                            "another way has installed version 1.3 instead");
        update_rig_stop(rig);
        rig->tells = 0;
    }
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, update_rig_setup, update_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_cannot_succeed_is_not_tried_again),
        TEST(what_passes_by_itself_is_tried_again),
        TEST(a_refusal_that_does_not_pass_is_a_failure_at_last),
        TEST(a_damaged_download_is_fetched_again),
        TEST(a_file_that_cannot_be_opened_is_fetched_again),
        TEST(tries_are_counted_over_a_restart),
        TEST(a_hub_that_is_away_is_no_failure),
        TEST(an_image_that_says_nothing_is_asked_again),
        TEST(the_slots_say_what_was_installed),
        TEST(a_restarted_link_takes_the_result),
        TEST(a_version_of_another_way_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
