/* The whole product: the daemon on stored frames, the command line tool, and visitors at the door.
 * Each test continues from the state that the test before it leaves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"
#include "tests/e2e/story.h"
#include "tests/support/scratch.h"

static void a_fresh_appliance_knows_nobody_and_is_well(void **state)
{
    json_t *status = appliance_run_json(*state, "status", NULL, 0);

    assert_string_equal(answer_text(status, "mode"), "watch");
    assert_string_equal(answer_text(status, "sensor-state"), "started");
    assert_string_equal(answer_text(status, "door-state"), "locked");
    assert_string_equal(answer_text(status, "version"), ISOTHERM_VERSION);
    assert_int_equal(answer_number(status, "people"), 0);
    json_decref(status);
    assert_int_equal(answer_people(*state), 0);

    json_t *diagnosis = appliance_run_json(*state, "doctor", NULL, 0);
    assert_true(json_is_true(json_object_get(diagnosis, "healthy")));
    json_decref(diagnosis);
}

static void nobody_is_let_in_while_nobody_is_enrolled(void **state)
{
    const char *const recordings[] = {"x01-v1", NULL};
    const struct appliance_result *result = appliance_visit(*state, recordings);

    appliance_expect(result, 0);
    assert_null(strstr(result->out, "unlocked"));
}

/* Runs the command BEFORE FILE AFTER, where FILE is the path of `file` in the appliance's
 * directory. Returns the exit code. */
static int run_with_file(const struct appliance *appliance, const char *before, const char *file,
                         const char *after)
{
    char words[1200];

    (void)snprintf(words, sizeof words, "%s %s%s", before, scratch_path(appliance->directory, file),
                   after);
    return appliance_run(appliance, words, NULL)->exit;
}

static void people_are_carried_in_a_sealed_file(void **state)
{
    struct appliance *appliance = *state;
    char option[512];
    size_t size;

    scratch_write_text(scratch_path(appliance->directory, "phrase"), "horse battery staple\n");
    scratch_write_text(scratch_path(appliance->directory, "wrong"), "horse battery stable\n");
    (void)snprintf(option, sizeof option, " --passphrase-file %s",
                   scratch_path(appliance->directory, "phrase"));
    assert_int_equal(run_with_file(appliance, "export", "people", option), 0);
    assert_int_equal(run_with_file(appliance, "export", "people", option), 4); /* the file exists */
    char *file = scratch_read(scratch_path(appliance->directory, "people"), &size);
    assert_null(memmem(file, size, "p01", 3));
    free(file);
    appliance_expect(appliance_run(appliance, "remove p01", NULL), 0);
    assert_int_equal(run_with_file(appliance, "import", "people", option), 0);
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
    (void)snprintf(option, sizeof option, " --passphrase-file %s",
                   scratch_path(appliance->directory, "wrong"));
    assert_int_equal(run_with_file(appliance, "import", "people", option), 4);
    appliance_expect(appliance_run(appliance, "key address", NULL), 0);
}

/* `log verify --head` accepts the head that `log verify` has printed, and no other. */
static void keys_are_rotated_and_the_log_is_sound(void **state)
{
    struct appliance *appliance = *state;
    json_t *report = appliance_run_json(appliance, "log verify", NULL, 0);
    char words[256];

    assert_true(json_is_true(json_object_get(report, "sound")));
    (void)snprintf(words, sizeof words, "log verify --head %lld:%s",
                   (long long)answer_number(report, "last"), answer_text(report, "head"));
    appliance_expect(appliance_run(appliance, "key rotate", NULL), 0);
    appliance_expect(appliance_run(appliance, words, NULL), 0);
    char *digit = strchr(words, ':') + 1;
    *digit = *digit == '0' ? '1' : '0';
    appliance_expect(appliance_run(appliance, words, NULL), 1);
    json_decref(report);
}

static void a_killed_daemon_forgets_nobody(void **state)
{
    struct appliance *appliance = *state;

    appliance_end_daemon(appliance, SIGKILL);
    answer_expect_error(appliance, "list", 4, "no-daemon");
    appliance_start_daemon(appliance);
    assert_int_equal(answer_people(appliance), 3); /* p01, p02, p04 */
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
}

static void an_end_by_signal_is_a_clean_one(void **state)
{
    struct appliance *appliance = *state;

    appliance_end_daemon(appliance, SIGTERM);
    run_expect(&appliance->daemon, 0);
    appliance_start_daemon(appliance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fresh_appliance_knows_nobody_and_is_well),
        cmocka_unit_test(nobody_is_let_in_while_nobody_is_enrolled),
        cmocka_unit_test(people_are_enrolled),
        cmocka_unit_test(a_known_face_is_refused_under_another_name),
        cmocka_unit_test(a_used_name_is_for_its_owner_only),
        cmocka_unit_test(names_are_checked),
        cmocka_unit_test(people_are_identified),
        cmocka_unit_test(people_are_verified),
        cmocka_unit_test(nobody_before_the_camera_times_out),
        cmocka_unit_test(a_person_who_stands_badly_gets_a_hint),
        cmocka_unit_test(an_empty_room_gets_no_hint),
        cmocka_unit_test(a_room_with_a_chair_gets_no_hint),
        cmocka_unit_test(the_camera_can_be_aimed),
        cmocka_unit_test(a_camera_in_use_is_refused_and_freed_by_an_interrupt),
        cmocka_unit_test(a_client_that_dies_frees_the_camera),
        cmocka_unit_test(the_door_opens_to_the_enrolled_and_to_nobody_else),
        cmocka_unit_test(visits_and_grants_are_in_the_log),
        cmocka_unit_test(removed_and_expired_people_are_refused),
        cmocka_unit_test(limits_and_names_are_changed_on_record),
        cmocka_unit_test(people_are_carried_in_a_sealed_file),
        cmocka_unit_test(keys_are_rotated_and_the_log_is_sound),
        cmocka_unit_test(a_killed_daemon_forgets_nobody),
        cmocka_unit_test(a_repeated_recording_opens_nothing),
        cmocka_unit_test(an_end_by_signal_is_a_clean_one),
    };

    return appliance_find() ? cmocka_run_group_tests(tests, appliance_setup, appliance_teardown)
                            : TEST_SKIPPED;
}
