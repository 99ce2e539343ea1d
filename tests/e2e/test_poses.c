/* A person is enrolled in five poses: the recordings of sim/stored/poses turn as the tool asks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"

/* What the tool prints, and the recording that answers it. */
static const struct answer {
    const char *asked, *recording;
} answers[] = {
    {"step 1 of 5: look straight at the camera", "p0000-s0"},
    {"step 2 of 5: turn your head a little to your left", "p0000-s0-left"},
    {"step 3 of 5: turn your head a little to your right", "p0000-s0-right"},
    {"step 4 of 5: lower your chin a little", "p0000-s0-down"},
    {"step 5 of 5: lift your chin a little", "p0000-s0-up"},
};

enum { N_ANSWERS = sizeof answers / sizeof *answers };

static int setup(void **state)
{
    const int error = appliance_setup(state);
    if (!error) {
        struct appliance *appliance = *state;
        (void)snprintf(appliance->people, sizeof appliance->people, "%s/poses", APPLIANCE_CORPUS);
    }
    return error;
}

/* Starts to enrol p01, and answers the first n questions. */
static void answer_questions(const struct appliance *appliance, int n, struct run *run)
{
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address,
                                "enroll",           "p01",   NULL};
    run_start(run, argv);
    for (int i = 0; i < n; i++) {
        run_until(run, answers[i].asked);
        appliance_show(appliance, answers[i].recording);
    }
}

static unsigned templates_of_p01(const struct appliance *appliance)
{
    json_t *document = appliance_run_json(appliance, "list", NULL, 0);
    const json_t *people = json_object_get(document, "people");
    assert_int_equal(json_array_size(people), 1);
    const unsigned n = (unsigned)json_integer_value(
        json_object_get(json_array_get(people, 0), "templates"));
    json_decref(document);
    return n;
}

static void a_person_who_turns_as_asked_is_enrolled_in_five_poses(void **state)
{
    const struct appliance *appliance = *state;
    struct run run;

    answer_questions(appliance, N_ANSWERS, &run);
    run_finish(&run);
    appliance_show(appliance, NULL);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "\np01 is enrolled.\n"));
    assert_non_null(strstr(run.out, "stage 12/12 done"));
    run_free(&run);
    assert_int_equal(templates_of_p01(appliance), 5);
    appliance_expect(appliance_run(appliance, "verify p01", "p0000-s0-left"), 0);
    appliance_expect(appliance_run(appliance, "verify p01", "p0000-s0-down"), 0);
}

/* The person turns to the wrong side. The tool says how far to turn back, and at the end which
 * poses are left out. */
static void a_person_who_does_not_turn_as_asked_is_enrolled_frontally(void **state)
{
    struct appliance *appliance = *state;
    struct run run;

    appliance_expect(appliance_run(appliance, "remove p01", NULL), 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance->keys = "[enroll]\npose_timeout_ms = 3000\n";
    appliance_configure(appliance);
    appliance_start_daemon(appliance);
    answer_questions(appliance, 1, &run);
    run_until(&run, answers[1].asked);
    appliance_show(appliance, answers[2].recording);
    run_until(&run, "  turn a little to your left, by about 3");
    run_until(&run, "step 2 of 5 (left) is left out");
    run_finish(&run);
    appliance_show(appliance, NULL);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "Poses that are left out: left"));
    run_free(&run);
    assert_int_equal(templates_of_p01(appliance), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_who_turns_as_asked_is_enrolled_in_five_poses),
        cmocka_unit_test(a_person_who_does_not_turn_as_asked_is_enrolled_frontally),
    };

    return appliance_find() ? cmocka_run_group_tests(tests, setup, appliance_teardown)
                            : TEST_SKIPPED;
}
