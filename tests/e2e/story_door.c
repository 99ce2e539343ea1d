#include "tests/e2e/story.h"

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
#include "tests/support/scratch.h"

void the_door_opens_to_the_enrolled_and_to_nobody_else(void **state)
{
    static const char *const recordings[] = {"p01-v1",     "p02-v1",       "p03-v1",
                                             "x01-v1",     "x02-v2",       "none-photo1",
                                             "none-back1", "none-nobody1", NULL};
    const struct appliance *appliance = *state;
    const struct appliance_result *result = appliance_visit(appliance, recordings);
    size_t size;

    appliance_expect(result, 0);
    char *csv = scratch_read(scratch_path(appliance->directory, "visits.csv"), &size);
    char *text = strndup(csv, size);
    for (size_t i = 0; i < 3; i++) {
        char line[64];
        (void)snprintf(line, sizeof line, "\n%s,%.3s,probe,,allow,%.3s,", recordings[i],
                       recordings[i], recordings[i]);
        assert_non_null(strstr(text, line));
    }
    assert_non_null(strstr(text, "\nnone-nobody1,none,impostor,nobody,none,,,,,,locked,\n"));
    free(text);
    free(csv);
}

/* The grant was recorded before the lock was switched, and the visit with the door's answer after
 * it.
 */
static void expect_entry(const json_t *records, const json_t *visit)
{
    const json_int_t grant = answer_number(visit, "grant");
    const json_t *before = json_array_get(records, (size_t)grant - 1);

    assert_string_equal(answer_text(visit, "door"), "unlocked");
    assert_in_range(grant, 1, answer_number(visit, "sequence") - 1);
    assert_string_equal(answer_text(before, "event"), "grant");
    assert_string_equal(answer_text(before, "person"), answer_text(visit, "person"));
}

void visits_and_grants_are_in_the_log(void **state)
{
    json_t *document = appliance_run_json(*state, "log --count 1000", NULL, 0), *record;
    const json_t *records = json_object_get(document, "records");
    bool allowed = false, denied = false;
    size_t i;

    json_array_foreach(records, i, record)
    {
        const char *verdict = answer_text(record, "verdict");
        assert_int_equal(answer_number(record, "sequence"), i + 1);
        if (strcmp(answer_text(record, "event"), "visit") == 0 && strcmp(verdict, "allow") == 0) {
            expect_entry(records, record);
        }
        allowed |= strcmp(verdict, "allow") == 0 &&
                   strcmp(answer_text(record, "person"), "p02") == 0;
        denied |= strcmp(verdict, "deny") == 0;
    }
    assert_true(allowed);
    assert_true(denied);
    json_decref(document);
}

void removed_and_expired_people_are_refused(void **state)
{
    static const char *const recordings[] = {"p03-v1", "p04-v1", NULL};

    appliance_expect(appliance_run(*state, "remove p03", NULL), 0);
    answer_expect_error(*state, "enroll --quick p04 --valid-until 2026-01-01", 2,
                        "invalid-argument");
    appliance_expect(
        appliance_run(*state, "enroll --quick p04 --valid-until 2026-01-01 --expired", "p04-enrol"),
        0);
    const struct appliance_result *result = appliance_visit(*state, recordings);
    appliance_expect(result, 1);
    assert_non_null(strstr(result->out, "0 of 2 enrolled people admitted"));
    assert_null(strstr(result->out, "unlocked"));
}

/* Returns the values of the last record of an event as "BEFORE -> AFTER"; the caller frees the
 * text.
 */
static char *last_change(const struct appliance *appliance, const char *event)
{
    json_t *document = appliance_run_json(appliance, "log --count 1000", NULL, 0), *record;
    char *text = NULL;
    size_t i;

    json_array_foreach(json_object_get(document, "records"), i, record)
    {
        if (strcmp(answer_text(record, "event"), event) == 0) {
            free(text);
            assert_true(asprintf(&text, "%s -> %s", answer_text(record, "before"),
                                 answer_text(record, "after")) > 0);
        }
    }
    json_decref(document);
    assert_non_null(text);
    return text;
}

void limits_and_names_are_changed_on_record(void **state)
{
    static const char *const recordings[] = {"p04-v1", NULL};
    struct appliance *appliance = *state;
    const struct appliance_result *result = appliance_run(appliance, "enroll --quick p04",
                                                          "p04-enrol");

    assert_int_equal(result->exit, 0); /* again, and the limit stays */
    assert_non_null(strstr(result->out, "The door has not opened to p04 since "));
    assert_int_equal(appliance_visit(appliance, recordings)->exit, 1);

    assert_int_equal(appliance_run(appliance, "validity p04 --none", NULL)->exit, 0);
    char *change = last_change(appliance, "validity");
    assert_non_null(strstr(change, "until 2026-01-"));
    assert_non_null(strstr(change, " -> no limits"));
    free(change);

    answer_expect_error(appliance, "rename p04 P01", 1, "name-in-use");
    assert_int_equal(appliance_run(appliance, "rename p04 Zoe", NULL)->exit, 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    assert_int_equal(appliance_run(appliance, "verify zoe", "p04-v1")->exit, 0);
    answer_expect_error(appliance, "verify p04", 3, "no-such-person");
    assert_int_equal(appliance_run(appliance, "rename ZOE p04", NULL)->exit, 0);
    change = last_change(appliance, "rename");
    assert_string_equal(change, "Zoe -> p04");
    free(change);

    assert_int_equal(appliance_visit(appliance, recordings)->exit, 0);
    result = appliance_run(appliance, "log --count 20", NULL);
    assert_non_null(strstr(result->out, "allow"));
    assert_non_null(strstr(result->out, "unlocked"));
}

/* A camera delivers earlier frames again: the first visit opens the door, the same frames do not
 * open it again, and the daemon reports the fault. */
void a_repeated_recording_opens_nothing(void **state)
{
    static const char *const recordings[] = {"p01-v1", NULL};
    static const char *const others[] = {"p02-v1", "p02-v2", "p04-v1", "p04-v2",
                                         "p05-v1", "p05-v2", NULL};
    struct appliance *appliance = *state;

    appliance_end_daemon(appliance, SIGTERM);
    appliance->strict = true;
    appliance_configure(appliance);
    appliance_start_daemon(appliance);
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
    /* A match needs two frames of the three. At most one of them was not shown yet. */
    assert_int_not_equal(appliance_run(appliance, "verify p01 --timeout 2", "p01-v1")->exit, 0);
    appliance_expect(appliance_visit(appliance, recordings), 1);

    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(answer_text(status, "sensor-state"), "repeats");
    json_decref(status);
    const struct appliance_result *result = appliance_run(appliance, "doctor", NULL);
    assert_int_equal(result->exit, 4);
    assert_non_null(strstr(result->out, "the camera is stuck"));
    result = appliance_run(appliance, "log --count 20", NULL);
    assert_non_null(strstr(result->out, "its frames repeat earlier ones"));

    appliance_expect(appliance_run(appliance, "verify p01", "p01-v2"), 0); /* new frames */
    status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(answer_text(status, "sensor-state"), "repeats"); /* three are too few */
    json_decref(status);
    (void)appliance_visit(appliance, others);
    status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(answer_text(status, "sensor-state"), "started");
    json_decref(status);
}
