/* A daemon whose metric adapts to the people who are enrolled: it says how far it is, records every
 * change, and admits them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"
#include "tests/support/scratch.h"

enum { WAIT_MS = 10000, LOOK_MS = 50 };

/* Expects this state of the site, which comes some time after a change of people. Returns the
 * status, which the caller releases. */
static json_t *expect_site(const struct appliance *appliance, const char *site, int people)
{
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    json_t *status = NULL;
    for (int waited_ms = 0; waited_ms < WAIT_MS; waited_ms += LOOK_MS) {
        json_decref(status);
        status = appliance_run_json(appliance, "status", NULL, 0);
        if (strcmp(answer_text(status, "site"), site) == 0 &&
            answer_number(status, "site-people") == people) {
            return status;
        }
        (void)nanosleep(&look, NULL);
    }
    fail_msg("site: %s, learned from %d, not %s from %d", answer_text(status, "site"),
             (int)answer_number(status, "site-people"), site, people);
    return status;
}

static double number_of(const json_t *status, const char *key)
{
    const json_t *number = json_object_get(status, key);
    assert_true(json_is_real(number));
    return json_real_value(number);
}

static void expect_state(const struct appliance *appliance, const char *site, int people,
                         double threshold)
{
    json_t *status = expect_site(appliance, site, people);
    assert_true(number_of(status, "threshold") == threshold);
    json_decref(status);
}

static void the_metric_adapts_to_three_people(void **state)
{
    struct appliance *appliance = *state;
    appliance_end_daemon(appliance, SIGTERM);
    appliance->keys = "[match]\nadapt = yes\n";
    appliance_configure(appliance);
    appliance_start_daemon(appliance);
    expect_state(appliance, "provisional", 0, 4);
    appliance_expect(appliance_run(appliance, "enroll --quick p01", "p01-enrol"), 0);
    appliance_expect(appliance_run(appliance, "enroll --quick p02", "p02-enrol"), 0);
    expect_state(appliance, "provisional", 2, 4);
    appliance_expect(appliance_run(appliance, "enroll --quick p03", "p03-enrol"), 0);
    json_t *status = expect_site(appliance, "adapted", 3);
    assert_true(number_of(status, "threshold") == 3);
    assert_true(number_of(status, "site-offset") > 0 && number_of(status, "site-expected") > 0);
    json_decref(status);
    const struct appliance_result *log = appliance_run(appliance, "log --event site", NULL);
    appliance_expect(log, 0);
    assert_non_null(strstr(log->out, "adapted"));
    assert_non_null(strstr(log->out, "3 people, offset "));
}

/* Returns the document of `isotherm site` once the thread has compared the people; the caller
 * releases it. */
static json_t *expect_estimate(const struct appliance *appliance, int people)
{
    const struct timespec look = {.tv_nsec = LOOK_MS * 1000000L};
    json_t *document = NULL;
    for (int waited_ms = 0; waited_ms < WAIT_MS; waited_ms += LOOK_MS) {
        json_decref(document);
        document = appliance_run_json(appliance, "site", NULL, 0);
        if (answer_number(document, "estimate-people") == people) {
            return document;
        }
        (void)nanosleep(&look, NULL);
    }
    fail_msg("there is no estimate of %d people", people);
    return document;
}

/* Each of the three has one template: three pairs are compared in both directions, and nobody with
 * another template of the same person. */
static void it_shows_what_the_templates_say(void **state)
{
    struct appliance *appliance = *state;
    json_t *document = expect_estimate(appliance, 3);
    assert_string_equal(answer_text(document, "site"), "adapted");
    assert_int_equal(answer_number(document, "estimate-others"), 6);
    assert_int_equal(answer_number(document, "estimate-same"), 0);
    assert_true(number_of(document, "balanced-score") == 3);
    assert_true(number_of(document, "balanced-fmr") == 0);
    assert_true(number_of(document, "balanced-fmr-high") > 0.5);
    assert_null(json_object_get(document, "balanced-fnmr"));
    assert_true(number_of(document, "look-alike-score") == 2);
    assert_int_equal(json_array_size(json_object_get(document, "look-alike-pairs")),
                     answer_number(document, "look-alikes"));
    assert_int_equal(json_array_size(json_object_get(document, "advice")), 3);
    json_decref(document);
    const struct appliance_result *text = appliance_run(appliance, "site show", NULL);
    appliance_expect(text, 0);
    assert_non_null(strstr(text->out, "enrol p02 in poses"));
}

static void it_recognises_them(void **state)
{
    static const char *const recordings[] = {"p01-v1", "x01-v1", "p02-v1", NULL};
    struct appliance *appliance = *state;
    const struct appliance_result *visits = appliance_visit(appliance, recordings);
    appliance_expect(visits, 0);
    assert_non_null(strstr(visits->out, "2 of 2 enrolled people admitted"));
    json_t *document = appliance_run_json(appliance, "identify", "p03-v1", 0);
    assert_string_equal(answer_text(document, "person"), "p03");
    json_decref(document);
    appliance_expect(appliance_run(appliance, "verify p02", "p02-v1"), 0);
    appliance_expect(appliance_run(appliance, "verify p02", "p01-v1"), 1);
}

static void it_adapts_again_after_a_start(void **state)
{
    struct appliance *appliance = *state;
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    expect_state(appliance, "adapted", 3, 3);
}

/* Makes a copy of the recording p01-v1 as if another model of camera had made it. */
static void copy_before_another_sensor(const char *people)
{
    char recording[600];
    (void)snprintf(recording, sizeof recording, "%s/p01-v1", people);
    scratch_mkdir(people);
    const char *const argv[] = {"/bin/cp", "-r", APPLIANCE_CORPUS "/p01-v1", recording, NULL};
    struct run copy;
    run_start(&copy, argv);
    run_finish(&copy);
    run_expect(&copy, 0);
    run_free(&copy);
    char *text = scratch_read_text(scratch_path(recording, "recording.ini"));
    char *at = strstr(text, "sensor = astra");
    assert_non_null(at);
    memcpy(at, "sensor = other", strlen("sensor = other"));
    scratch_write_text(scratch_path(recording, "recording.ini"), text);
    free(text);
}

/* Nobody was enrolled before the other model. So the metric is the shipped one, which needs a
 * higher score, and people are still identified. Before the first model all is as it was. */
static void another_camera_learns_from_its_own_people(void **state)
{
    struct appliance *appliance = *state;
    char before[sizeof appliance->people];
    memcpy(before, appliance->people, sizeof before);
    (void)snprintf(appliance->people, sizeof appliance->people, "%s/other", appliance->directory);
    copy_before_another_sensor(appliance->people);
    json_t *document = appliance_run_json(appliance, "identify", "p01-v1", 0);
    assert_string_equal(answer_text(document, "person"), "p01");
    json_decref(document);
    expect_state(appliance, "provisional", 0, 4);
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(answer_text(status, "sensor-model"), "other");
    assert_int_equal(answer_number(status, "site-other-sensor"), 3);
    json_decref(status);
    const struct appliance_result *text = appliance_run(appliance, "site", NULL);
    assert_non_null(strstr(text->out, "enrol p02 again before this camera"));
    memcpy(appliance->people, before, sizeof before);
    document = appliance_run_json(appliance, "identify", "p01-v1", 0);
    json_decref(document);
    status = expect_site(appliance, "adapted", 3);
    assert_int_equal(answer_number(status, "site-other-sensor"), 0);
    json_decref(status);
}

static void it_forgets_people_who_are_removed(void **state)
{
    struct appliance *appliance = *state;
    appliance_expect(appliance_run(appliance, "remove p02", NULL), 0);
    expect_state(appliance, "provisional", 2, 4);
    const struct appliance_result *log = appliance_run(appliance, "log --event site", NULL);
    assert_non_null(strstr(log->out, "shipped"));
    json_t *document = appliance_run_json(appliance, "identify", "p01-v1", 0);
    assert_string_equal(answer_text(document, "person"), "p01");
    json_decref(document);
}

static void expect_taken_back(const struct appliance *appliance, const char *words, int templates)
{
    json_t *document = appliance_run_json(appliance, words, NULL, 0);
    assert_int_equal(answer_number(document, "excluded"), templates);
    json_decref(document);
}

/* The last enrolment teaches no longer, but its person is identified. */
static void it_rolls_back(void **state)
{
    struct appliance *appliance = *state;
    appliance_expect(appliance_run(appliance, "enroll --quick p02", "p02-enrol"), 0);
    expect_state(appliance, "adapted", 3, 3);
    expect_taken_back(appliance, "site rollback", 1);
    expect_state(appliance, "provisional", 2, 4);
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_int_equal(answer_number(status, "site-excluded"), 1);
    json_decref(status);
    json_t *document = appliance_run_json(appliance, "identify", "p02-v1", 0);
    assert_string_equal(answer_text(document, "person"), "p02");
    json_decref(document);
    const struct appliance_result *log = appliance_run(appliance, "log --event site --full", NULL);
    assert_non_null(strstr(log->out, "rollback"));
    assert_non_null(strstr(log->out, "asked by user "));
    assert_non_null(strstr(log->out, "1 template no longer teaches the metric"));
}

/* The daemon keeps what was taken back. A removed person, enrolled again, teaches again. */
static void it_stays_rolled_back_over_a_start(void **state)
{
    struct appliance *appliance = *state;
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    expect_state(appliance, "provisional", 2, 4);
    appliance_expect(appliance_run(appliance, "remove p02", NULL), 0);
    appliance_expect(appliance_run(appliance, "enroll --quick p02", "p02-enrol"), 0);
    expect_state(appliance, "adapted", 3, 3);
}

static void it_resets(void **state)
{
    struct appliance *appliance = *state;
    expect_taken_back(appliance, "site reset", 3);
    expect_state(appliance, "provisional", 0, 4);
    expect_taken_back(appliance, "site reset", 0);
    expect_taken_back(appliance, "site rollback", 0);
    appliance_expect(appliance_run(appliance, "key rotate", NULL), 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    expect_state(appliance, "provisional", 0, 4);
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
    const struct appliance_result *log = appliance_run(appliance, "log --event site", NULL);
    assert_non_null(strstr(log->out, "3 templates no longer teach the metric"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_metric_adapts_to_three_people),
        cmocka_unit_test(it_shows_what_the_templates_say),
        cmocka_unit_test(it_recognises_them),
        cmocka_unit_test(it_adapts_again_after_a_start),
        cmocka_unit_test(another_camera_learns_from_its_own_people),
        cmocka_unit_test(it_forgets_people_who_are_removed),
        cmocka_unit_test(it_rolls_back),
        cmocka_unit_test(it_stays_rolled_back_over_a_start),
        cmocka_unit_test(it_resets),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, appliance_setup, appliance_teardown);
}
