/* `isotherm doctor` on a running daemon: whatever keeps people out is a finding with a remedy. The
 * tests are one story and run in this order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "tests/e2e/appliance.h"

/* Runs the doctor, and looks for a finding of this state whose text has these words in it. */
static void expect_finding(const struct appliance *appliance, int exit, const char *subject,
                           const char *state, const char *words, const char *remedy)
{
    json_t *document = appliance_run_json(appliance, "doctor", NULL, exit);
    const json_t *check = NULL;
    size_t i;

    json_array_foreach(json_object_get(document, "checks"), i, check)
    {
        if (strcmp(json_string_value(json_object_get(check, "subject")), subject) == 0) {
            break;
        }
    }
    assert_non_null(check);
    const char *found = json_string_value(json_object_get(check, "found"));
    const char *told = json_string_value(json_object_get(check, "remedy"));
    if (strcmp(json_string_value(json_object_get(check, "state")), state) != 0 ||
        !strstr(found, words) || (remedy && (!told || !strstr(told, remedy)))) {
        fail_msg("%s: %s -> %s", subject, found, told ? told : "(no remedy)");
    }
    assert_int_equal(json_is_true(json_object_get(document, "healthy")), exit == 0);
    json_decref(document);
}

static void a_replay_of_nothing_is_found(void **state)
{
    expect_finding(*state, 0, "sensor", "warning",
                   "started: there is no recording at its path, and there never was a frame",
                   "[sensor] path");
}

static void an_empty_gallery_is_found(void **state)
{
    expect_finding(*state, 0, "gallery", "warning", "0 people", "isotherm enroll NAME");
}

static void people_whose_time_has_not_come_are_found(void **state)
{
    assert_int_equal(appliance_run(*state, "enroll p01 --valid-from 2037-01-01", "p01-enrol")->exit,
                     0);
    expect_finding(*state, 4, "gallery", "fault", "1 people, none of whom may come in at this time",
                   "isotherm list");
    assert_int_equal(appliance_run(*state, "enroll p02", "p02-enrol")->exit, 0);
    expect_finding(*state, 0, "gallery", "ok", "2 people", NULL);
}

static void a_lockdown_is_found(void **state)
{
    assert_int_equal(appliance_run(*state, "lockdown on", NULL)->exit, 0);
    expect_finding(*state, 4, "service", "fault", "lockdown: nobody is let in",
                   "isotherm lockdown off");
    assert_int_equal(appliance_run(*state, "lockdown off", NULL)->exit, 0);
    expect_finding(*state, 0, "door", "ok", "locked", NULL);
}

static void a_lockout_is_found(void **state)
{
    const char *const strangers[] = {"x01-v1", "x02-v1", "x03-v1", "x04-v1",
                                     "x05-v1", "x06-v1", "x07-v1", NULL};

    assert_int_equal(appliance_visit(*state, strangers)->exit, 0);
    expect_finding(*state, 4, "service", "fault", "locked out: nobody is let in for ",
                   "isotherm lockout clear");
    assert_int_equal(appliance_run(*state, "lockout clear", NULL)->exit, 0);
    expect_finding(*state, 0, "door", "ok", "locked", NULL);
}

/* The one call that opens the door. Without a terminal nobody can be asked. */
static void the_relay_is_tested_on_record(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "door test", NULL);

    assert_int_equal(result->exit, 2);
    assert_non_null(strstr(result->err, "confirm with --yes"));
    assert_int_equal(appliance_run(*state, "door open --yes", NULL)->exit, 2);
    assert_null(strstr(appliance_run(*state, "log --json -n 3", NULL)->out, "door-test"));
    result = appliance_run(*state, "door test --yes", NULL);
    assert_int_equal(result->exit, 0);
    assert_non_null(strstr(result->out, "The relay was switched"));
    result = appliance_run(*state, "log --json -n 4", NULL);
    const char *before = strstr(result->out, "door-test"), *relay = strstr(result->out, "unlocked");
    assert_true(before && relay && before < relay);
    assert_int_equal(appliance_run(*state, "lockdown on", NULL)->exit, 0);
    result = appliance_run(*state, "door test --yes", NULL);
    assert_int_not_equal(result->exit, 0);
    assert_non_null(strstr(result->err, "lockdown: nobody is let in"));
    assert_int_equal(appliance_run(*state, "lockdown off", NULL)->exit, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_replay_of_nothing_is_found),
        cmocka_unit_test(an_empty_gallery_is_found),
        cmocka_unit_test(people_whose_time_has_not_come_are_found),
        cmocka_unit_test(a_lockdown_is_found),
        cmocka_unit_test(a_lockout_is_found),
        cmocka_unit_test(the_relay_is_tested_on_record),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, appliance_setup, appliance_teardown);
}
