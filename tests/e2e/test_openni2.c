/* The whole product with a camera: the daemon opens the virtual camera through OpenNI2's own
 * runtime. Each test continues from the state that the test before it leaves. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"
#include "tests/support/devices/camera_bench.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

static void expect_status(const struct appliance *appliance, const char *key, const char *wanted)
{
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);

    assert_string_equal(answer_text(status, key), wanted);
    json_decref(status);
}

static void the_camera_is_seen_and_runs(void **state)
{
    const struct appliance *appliance = *state;
    char devices[256];

    (void)snprintf(devices, sizeof devices, "bench:%s (Isotherm astra)", appliance->bench);
    expect_status(appliance, "sensor", "openni2");
    expect_status(appliance, "sensor-state", "started");
    expect_status(appliance, "sensor-devices", devices);
    const struct appliance_result *doctor = appliance_run(appliance, "doctor", NULL);
    appliance_expect(doctor, 0);
    assert_non_null(strstr(doctor->out, devices));
}

/* `isotherm setup` runs this command. It works while the daemon has the camera, and does not
 * disturb the daemon. */
static void the_camera_is_listed_for_programs(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {ISOTHERM_BINARY_DIR "/firmware/isothermd", "--list-devices", NULL};
    char line[256];
    struct run run;

    (void)snprintf(line, sizeof line,
                   "{\"sensor\":\"openni2\",\"id\":\"bench:%s\",\"label\":\"Isotherm "
                   "astra\",\"kind\":\"depth\"}\n",
                   appliance->bench);
    run_start(&run, argv);
    run_finish(&run);
    if (run.exit != 0 || !strstr(run.out, line)) {
        fail_msg("exit %d, '%s' is not in '%s'; %s", run.exit, line, run.out, run.err);
    }
    run_free(&run);
    expect_status(appliance, "sensor-state", "started");
}

static void people_are_enrolled(void **state)
{
    appliance_expect(appliance_run(*state, "enroll --quick p01", "p01-enrol"), 0);
    appliance_expect(appliance_run(*state, "enroll --quick p02", "p02-enrol"), 0);
    expect_status(*state, "sensor-model", "astra");
}

static void people_are_identified(void **state)
{
    json_t *document = appliance_run_json(*state, "identify", "p02-v1", 0);

    assert_string_equal(answer_text(document, "person"), "p02");
    json_decref(document);
    appliance_expect(appliance_run(*state, "identify", "x02-v1"), 1);
}

/* Expects one line of visits.csv: the recording, the verdict, and the recognised person. */
static void expect_visit(const char *csv, const char *recording, const char *verdict,
                         const char *person)
{
    char begin[64], decided[64];

    (void)snprintf(begin, sizeof begin, "\n%s,", recording);
    (void)snprintf(decided, sizeof decided, ",%s,%s,", verdict, person);
    const char *line = strstr(csv, begin);
    assert_non_null(line);
    line++;
    const char *found = strstr(line, decided);
    if (!found || found > strchrnul(line, '\n')) {
        fail_msg("%s is not '%s': %.*s", recording, decided, (int)strcspn(line, "\n"), line);
    }
}

static char *visit(const struct appliance *appliance, const char *const recordings[])
{
    const struct appliance_result *result = appliance_visit(appliance, recordings);
    size_t size;

    appliance_expect(result, 0);
    char *csv = scratch_read(scratch_path(appliance->directory, "visits.csv"), &size);
    char *text = strndup(csv, size);
    free(csv);
    return text;
}

static void the_door_opens_to_the_enrolled_and_to_no_stranger(void **state)
{
    static const char *const recordings[] = {"p01-v1", "x01-v1", "p02-v1", "x02-v2", NULL};
    char *csv = visit(*state, recordings);

    expect_visit(csv, "p01-v1", "allow", "p01");
    expect_visit(csv, "p02-v1", "allow", "p02");
    expect_visit(csv, "x01-v1", "deny", "");
    expect_visit(csv, "x02-v2", "deny", "");
    free(csv);
}

/* Asks until the sensor is in this state, no faster than the daemon permits a client. */
static void await_sensor(const struct appliance *appliance, const char *wanted)
{
    static const struct timespec between = {.tv_nsec = 100 * 1000 * 1000};

    for (int tries = 0; tries < 300; tries++) {
        json_t *status = appliance_run_json(appliance, "status", NULL, 0);
        const bool there = strcmp(answer_text(status, "sensor-state"), wanted) == 0;
        json_decref(status);
        if (there) {
            return;
        }
        (void)nanosleep(&between, NULL);
    }
    fail_msg("the sensor does not become '%s'", wanted);
}

static void a_pulled_cable_is_reported_and_survived(void **state)
{
    static const char *const recordings[] = {"p01-v2", NULL};
    const struct appliance *appliance = *state;

    camera_bench_plug(appliance->bench, false);
    await_sensor(appliance, "lost");
    const struct appliance_result *doctor = appliance_run(appliance, "doctor", NULL);
    appliance_expect(doctor, 4);
    assert_non_null(strstr(doctor->out, "fault    sensor"));
    assert_non_null(strstr(doctor->out, "sensor openni2: "));
    appliance_expect(appliance_run(appliance, "identify --timeout 0.5", NULL), 4);
    camera_bench_plug(appliance->bench, true);
    await_sensor(appliance, "started");
    char *csv = visit(appliance, recordings);
    expect_visit(csv, "p01-v2", "allow", "p01");
    free(csv);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_camera_is_seen_and_runs),
        cmocka_unit_test(the_camera_is_listed_for_programs),
        cmocka_unit_test(people_are_enrolled),
        cmocka_unit_test(people_are_identified),
        cmocka_unit_test(the_door_opens_to_the_enrolled_and_to_no_stranger),
        cmocka_unit_test(a_pulled_cable_is_reported_and_survived),
    };

    return appliance_find()
               ? cmocka_run_group_tests(tests, appliance_setup_openni2, appliance_teardown)
               : TEST_SKIPPED;
}
