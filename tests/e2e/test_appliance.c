/* The whole product: the daemon on stored frames, the command line tool, and visitors at the door.
 * The tests are one story and run in this order. */
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

#include "tests/e2e/appliance.h"
#include "tests/support/scratch.h"

static const char *text_of(const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));

    return text ? text : "(none)";
}

static json_int_t number_of(const json_t *object, const char *name)
{
    return json_integer_value(json_object_get(object, name));
}

static size_t count_people(const struct appliance *appliance)
{
    json_t *document = appliance_run_json(appliance, "list", NULL, 0);
    const size_t count = json_array_size(json_object_get(document, "people"));

    json_decref(document);
    return count;
}

static void expect_error(const struct appliance *appliance, const char *words, int exit,
                         const char *code)
{
    json_t *document = appliance_run_json(appliance, words, NULL, exit);

    assert_string_equal(text_of(json_object_get(document, "error"), "code"), code);
    json_decref(document);
}

static void a_fresh_appliance_knows_nobody_and_is_well(void **state)
{
    json_t *status = appliance_run_json(*state, "status", NULL, 0);

    assert_string_equal(text_of(status, "mode"), "watch");
    assert_string_equal(text_of(status, "sensor-state"), "started");
    assert_string_equal(text_of(status, "door-state"), "locked");
    assert_string_equal(text_of(status, "version"), ISOTHERM_VERSION);
    assert_int_equal(number_of(status, "people"), 0);
    json_decref(status);
    assert_int_equal(count_people(*state), 0);

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

static void people_are_enrolled(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "enroll p01", "p01-enrol");

    appliance_expect(result, 0);
    assert_non_null(strstr(result->out, "\nstage 1/"));
    assert_non_null(strstr(result->out, "\np01 is enrolled.\n"));

    json_t *document = appliance_run_json(*state, "enroll p02", "p02-enrol", 0);
    assert_string_equal(text_of(document, "result"), "enroll-completed");
    assert_int_equal(number_of(document, "stage"), number_of(document, "stages"));
    const double quality = json_real_value(json_object_get(document, "quality"));
    assert_true(quality > 0 && quality <= 1);
    json_decref(document);
    appliance_expect(appliance_run(*state, "enroll p03", "p03-enrol"), 0);
    assert_int_equal(count_people(*state), 3);
}

static void a_known_face_is_refused_under_another_name(void **state)
{
    json_t *document = appliance_run_json(*state, "enroll double", "p01-enrol", 1);

    assert_string_equal(text_of(document, "result"), "enroll-duplicate");
    assert_string_equal(text_of(document, "duplicate_of"), "p01");
    json_decref(document);
    assert_int_equal(count_people(*state), 3);

    appliance_expect(appliance_run(*state, "enroll double --allow-duplicate", "p01-enrol"), 0);
    assert_int_equal(count_people(*state), 4);
    appliance_expect(appliance_run(*state, "remove double", NULL), 0);
    assert_int_equal(count_people(*state), 3);
}

static void a_used_name_is_for_its_owner_only(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "enroll P03", "p03-enrol");

    assert_int_equal(result->exit, 0);
    assert_non_null(strstr(result->out, "p03 has 1 template since "));
    assert_non_null(strstr(result->out, "; this adds to it.\n"));
    assert_non_null(strstr(result->out, "\np03 is enrolled.\n"));
    assert_int_equal(count_people(*state), 3);

    json_t *document = appliance_run_json(*state, "enroll p03", "p04-enrol", 1);
    assert_string_equal(text_of(document, "result"), "enroll-other-face");
    assert_int_equal(number_of(document, "templates_before"), 2);
    json_decref(document);
}

static void names_are_checked(void **state)
{
    char words[128] = "enroll ";

    memset(words + strlen(words), 'x', 65);
    expect_error(*state, words, 2, "invalid-name");
    expect_error(*state, "remove zoe", 3, "no-such-person");
    expect_error(*state, "verify zoe", 3, "no-such-person");
}

static void people_are_identified(void **state)
{
    json_t *document = appliance_run_json(*state, "identify", "p02-v1", 0);

    assert_string_equal(text_of(document, "result"), "identify-match");
    assert_string_equal(text_of(document, "person"), "p02");
    assert_true(json_real_value(json_object_get(document, "score")) >=
                json_real_value(json_object_get(document, "threshold")));
    json_decref(document);

    document = appliance_run_json(*state, "identify", "x02-v1", 1);
    assert_string_equal(text_of(document, "result"), "identify-no-match");
    json_decref(document);
}

static void people_are_verified(void **state)
{
    appliance_expect(appliance_run(*state, "verify p01", "p01-v1"), 0);
    appliance_expect(appliance_run(*state, "verify p02", "p01-v2"), 1);
}

static void nobody_before_the_camera_times_out(void **state)
{
    appliance_expect(appliance_run(*state, "identify --timeout 0.3", NULL), 5);
    appliance_expect(appliance_run(*state, "enroll zoe --timeout 0.3", "none-nobody1"), 5);
    assert_int_equal(count_people(*state), 3);
}

static void who_stands_badly_is_told_so(void **state)
{
    json_t *document = appliance_run_json(*state, "identify --timeout 4", "none-cut4", 5);

    assert_string_equal(text_of(document, "result"), "identify-timed-out");
    assert_string_equal(json_string_value(json_array_get(json_object_get(document, "hints"), 0)),
                        "move-right");
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(text_of(document, "capture"), "move-right");
    json_decref(document);
}

/* An empty room with a wall in it: nobody is told to look at the camera. */
static void an_empty_room_is_told_nothing(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "aim", NULL};
    struct run aim;
    json_t *document = appliance_run_json(*state, "status", NULL, 0);
    const json_int_t denied = number_of(document, "visits-denied");

    json_decref(document);
    document = appliance_run_json(*state, "identify --timeout 3", "none-nobody1", 5);
    assert_string_equal(text_of(document, "result"), "identify-timed-out");
    assert_int_equal(json_array_size(json_object_get(document, "hints")), 0);
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(text_of(document, "capture"), "nobody");
    assert_int_equal(number_of(document, "visits-denied"), denied);
    json_decref(document);
    run_start(&aim, argv);
    run_until(&aim, "capture ");
    appliance_show(appliance, "none-nobody1");
    run_until(&aim, "nobody is there");
    kill(aim.pid, SIGINT);
    run_finish(&aim);
    appliance_show(appliance, NULL);
    assert_null(strstr(aim.out, "look straight"));
    run_free(&aim);
}

/* A chair within reach looks like a visitor without a face to one frame; but it does not move. The
 * recording is short: it is played until whoever was there before is forgotten. */
static void a_room_with_a_chair_is_told_nothing(void **state)
{
    static const struct timespec half_a_second = {0, 500000000};
    bool empty = false;

    for (int i = 0; i < 60 && !empty; i++) {
        appliance_show(*state, "none-nobody2");
        nanosleep(&half_a_second, NULL);
        json_t *status = appliance_run_json(*state, "status", NULL, 0);
        empty = strcmp(text_of(status, "capture"), "nobody") == 0;
        json_decref(status);
    }
    assert_true(empty);
    json_t *document = appliance_run_json(*state, "identify --timeout 3", "none-nobody2", 5);
    assert_string_equal(text_of(document, "result"), "identify-timed-out");
    assert_int_equal(json_array_size(json_object_get(document, "hints")), 0);
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(text_of(document, "capture"), "nobody");
    json_decref(document);
}

/* Placing the camera while the door is in service: what it sees, and no more than that. */
static void the_camera_can_be_aimed(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "aim", NULL};
    struct run aim;

    run_start(&aim, argv);
    run_until(&aim, "capture ");
    appliance_show(appliance, "p01-v1");
    run_until(&aim, "good, hold still");
    kill(aim.pid, SIGINT);
    run_finish(&aim);
    appliance_show(appliance, NULL);
    run_expect(&aim, 0);
    run_free(&aim);

    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    const double distance_mm = json_real_value(json_object_get(status, "distance-mm"));
    const double coverage = json_real_value(json_object_get(status, "fit-coverage"));
    assert_string_equal(text_of(status, "mode"), "watch");
    assert_true(distance_mm > 400 && distance_mm < 1200);
    assert_true(coverage > 0.8 && coverage <= 1);
    json_decref(status);
}

static void a_camera_in_use_is_refused_and_freed_by_an_interrupt(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "identify",
                                NULL};
    struct run first;

    run_start(&first, argv);
    run_until(&first, "Look straight at the camera.");
    expect_error(appliance, "identify", 4, "already-in-use");
    kill(first.pid, SIGINT);
    run_finish(&first);
    run_expect(&first, 130);
    run_free(&first);
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(text_of(status, "mode"), "watch");
    json_decref(status);
}

static void a_client_that_dies_frees_the_camera(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address,
                                "enroll",           "zoe",   NULL};
    struct run first;

    run_start(&first, argv);
    run_until(&first, "look straight at the camera.");
    kill(first.pid, SIGKILL);
    run_finish(&first);
    run_free(&first);
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
    assert_int_equal(count_people(appliance), 3);
}

static void the_door_opens_to_the_enrolled_and_to_nobody_else(void **state)
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

/* A grant before the lock is switched, and what the door did behind it. */
static void expect_entry(const json_t *records, const json_t *visit)
{
    const json_int_t grant = number_of(visit, "grant");
    const json_t *before = json_array_get(records, (size_t)grant - 1);

    assert_string_equal(text_of(visit, "door"), "unlocked");
    assert_in_range(grant, 1, number_of(visit, "sequence") - 1);
    assert_string_equal(text_of(before, "event"), "grant");
    assert_string_equal(text_of(before, "person"), text_of(visit, "person"));
}

static void what_happened_is_in_the_log(void **state)
{
    json_t *document = appliance_run_json(*state, "log --count 1000", NULL, 0), *record;
    const json_t *records = json_object_get(document, "records");
    bool allowed = false, denied = false;
    size_t i;

    json_array_foreach(records, i, record)
    {
        const char *verdict = text_of(record, "verdict");
        assert_int_equal(number_of(record, "sequence"), i + 1);
        if (strcmp(text_of(record, "event"), "visit") == 0 && strcmp(verdict, "allow") == 0) {
            expect_entry(records, record);
        }
        allowed |= strcmp(verdict, "allow") == 0 && strcmp(text_of(record, "person"), "p02") == 0;
        denied |= strcmp(verdict, "deny") == 0;
    }
    assert_true(allowed);
    assert_true(denied);
    json_decref(document);
}

static void who_is_removed_or_expired_is_refused(void **state)
{
    static const char *const recordings[] = {"p03-v1", "p04-v1", NULL};

    appliance_expect(appliance_run(*state, "remove p03", NULL), 0);
    expect_error(*state, "enroll p04 --valid-until 2026-01-01", 2, "invalid-argument");
    appliance_expect(
        appliance_run(*state, "enroll p04 --valid-until 2026-01-01 --expired", "p04-enrol"), 0);
    const struct appliance_result *result = appliance_visit(*state, recordings);
    appliance_expect(result, 1);
    assert_non_null(strstr(result->out, "0 of 2 enrolled people admitted"));
    assert_null(strstr(result->out, "unlocked"));
}

/* The values before and after of the last record of an event, "BEFORE -> AFTER", to be freed. */
static char *last_change(const struct appliance *appliance, const char *event)
{
    json_t *document = appliance_run_json(appliance, "log --count 1000", NULL, 0), *record;
    char *text = NULL;
    size_t i;

    json_array_foreach(json_object_get(document, "records"), i, record)
    {
        if (strcmp(text_of(record, "event"), event) == 0) {
            free(text);
            assert_true(asprintf(&text, "%s -> %s", text_of(record, "before"),
                                 text_of(record, "after")) > 0);
        }
    }
    json_decref(document);
    assert_non_null(text);
    return text;
}

static void limits_and_names_are_changed_on_record(void **state)
{
    static const char *const recordings[] = {"p04-v1", NULL};
    struct appliance *appliance = *state;
    const struct appliance_result *result = appliance_run(appliance, "enroll p04", "p04-enrol");

    assert_int_equal(result->exit, 0); /* again, and the limit stays */
    assert_non_null(strstr(result->out, "The door has not opened to p04 since "));
    assert_int_equal(appliance_visit(appliance, recordings)->exit, 1);

    assert_int_equal(appliance_run(appliance, "validity p04 --none", NULL)->exit, 0);
    char *change = last_change(appliance, "validity");
    assert_non_null(strstr(change, "until 2026-01-"));
    assert_non_null(strstr(change, " -> no limits"));
    free(change);

    expect_error(appliance, "rename p04 P01", 1, "name-in-use");
    assert_int_equal(appliance_run(appliance, "rename p04 Zoe", NULL)->exit, 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    assert_int_equal(appliance_run(appliance, "verify zoe", "p04-v1")->exit, 0);
    expect_error(appliance, "verify p04", 3, "no-such-person");
    assert_int_equal(appliance_run(appliance, "rename ZOE p04", NULL)->exit, 0);
    change = last_change(appliance, "rename");
    assert_string_equal(change, "Zoe -> p04");
    free(change);

    assert_int_equal(appliance_visit(appliance, recordings)->exit, 0);
    result = appliance_run(appliance, "log --count 20", NULL);
    assert_non_null(strstr(result->out, "allow"));
    assert_non_null(strstr(result->out, "unlocked"));
}

/* Runs a command whose second word is a file of the appliance's directory. */
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
    assert_int_equal(run_with_file(appliance, "export", "people", option), 4); /* it is there */
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

/* The head of the log as `log verify` prints it. */
static void keys_are_rotated_and_the_log_is_sound(void **state)
{
    struct appliance *appliance = *state;
    json_t *report = appliance_run_json(appliance, "log verify", NULL, 0);
    char words[256];

    assert_true(json_is_true(json_object_get(report, "sound")));
    (void)snprintf(words, sizeof words, "log verify --head %lld:%s",
                   (long long)number_of(report, "last"), text_of(report, "head"));
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
    expect_error(appliance, "list", 4, "no-daemon");
    appliance_start_daemon(appliance);
    assert_int_equal(count_people(appliance), 3); /* p01, p02, p04 */
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
}

/* A camera that delivers what it delivered before: the first visit opens, the same frames again do
 * not, and the fault is told. */
static void a_recording_that_comes_again_opens_nothing(void **state)
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
    /* A match needs two frames of three: one may be left that was not shown yet. */
    assert_int_not_equal(appliance_run(appliance, "verify p01 --timeout 2", "p01-v1")->exit, 0);
    appliance_expect(appliance_visit(appliance, recordings), 1);

    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(text_of(status, "sensor-state"), "repeats");
    json_decref(status);
    const struct appliance_result *result = appliance_run(appliance, "doctor", NULL);
    assert_int_equal(result->exit, 4);
    assert_non_null(strstr(result->out, "the camera is stuck"));
    result = appliance_run(appliance, "log --count 20", NULL);
    assert_non_null(strstr(result->out, "its frames repeat earlier ones"));

    appliance_expect(appliance_run(appliance, "verify p01", "p01-v2"), 0); /* new frames */
    status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(text_of(status, "sensor-state"), "repeats"); /* three of them, not 15 */
    json_decref(status);
    (void)appliance_visit(appliance, others);
    status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(text_of(status, "sensor-state"), "started");
    json_decref(status);
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
        cmocka_unit_test(who_stands_badly_is_told_so),
        cmocka_unit_test(an_empty_room_is_told_nothing),
        cmocka_unit_test(a_room_with_a_chair_is_told_nothing),
        cmocka_unit_test(the_camera_can_be_aimed),
        cmocka_unit_test(a_camera_in_use_is_refused_and_freed_by_an_interrupt),
        cmocka_unit_test(a_client_that_dies_frees_the_camera),
        cmocka_unit_test(the_door_opens_to_the_enrolled_and_to_nobody_else),
        cmocka_unit_test(what_happened_is_in_the_log),
        cmocka_unit_test(who_is_removed_or_expired_is_refused),
        cmocka_unit_test(limits_and_names_are_changed_on_record),
        cmocka_unit_test(people_are_carried_in_a_sealed_file),
        cmocka_unit_test(keys_are_rotated_and_the_log_is_sound),
        cmocka_unit_test(a_killed_daemon_forgets_nobody),
        cmocka_unit_test(a_recording_that_comes_again_opens_nothing),
        cmocka_unit_test(an_end_by_signal_is_a_clean_one),
    };

    return appliance_find() ? cmocka_run_group_tests(tests, appliance_setup, appliance_teardown)
                            : TEST_SKIPPED;
}
