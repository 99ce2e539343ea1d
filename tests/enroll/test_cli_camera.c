/* enroll, identify and verify as a person sees them, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void enrolling_guides_the_person(void **state)
{
    static const struct fake_status statuses[] = {
        {"enroll-retry-no-face", false, 0, 2, 0, NULL, 0},
        {"enroll-retry-too-far", false, 0, 2, 0, NULL, 0},
        {"enroll-retry-too-far", false, 0, 2, 0, NULL, 0}, /* not printed twice */
        {"enroll-stage-passed", false, 1, 2, 0.875, NULL, 0},
        {"enroll-retry-turn-left", false, 1, 2, 0, NULL, 0},
        {"enroll-stage-misfit", false, 1, 2, 0, NULL, 0},
        {"enroll-retry-turn-left", false, 1, 2, 0, NULL, 0}, /* printed again after other hints */
        {"enroll-stage-passed", false, 2, 2, 0.75, NULL, 0},
        {"enroll-completed", true, 2, 2, 0.8125, NULL, 0},
    };
    const struct fake_script script = {.statuses = statuses, .n_statuses = COUNT(statuses)};
    const struct cli_result result = cli_run(&script, "enroll anna");

    (void)state;
    assert_string_equal(result.out, "Enrolling anna: look straight at the camera.\n"
                                    "  no face to be seen: stand in front of the camera\n"
                                    "  come closer\n"
                                    "stage 1/2 done (quality 0.88)\n"
                                    "  turn a little to your left\n"
                                    "this capture does not match the earlier ones: only one "
                                    "person can be enrolled\n"
                                    "  turn a little to your left\n"
                                    "stage 2/2 done (quality 0.75)\n"
                                    "anna is enrolled.\n");
    assert_string_equal(result.err, "");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "Claim;EnrollStart anna poses=1;EnrollStop;Release");
}

static void enrolling_hands_the_options_on(void **state)
{
    static const struct fake_status completed = {"enroll-completed", true, 4, 4, 0.5, NULL, 0};
    const struct fake_script script = {.statuses = &completed, .n_statuses = 1};
    const struct cli_result result = cli_run(
        &script, "enroll --allow-duplicate anna --valid-from 2026-12-01Z --valid-until "
                 "@1798675200 --json");

    (void)state;
    assert_string_equal(result.calls,
                        "Claim;EnrollStart anna poses=1 allow-duplicate=1 valid-from=1796083200 "
                        "valid-until=1798675200;EnrollStop;Release");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "person")), "anna");
    assert_string_equal(json_string_value(json_object_get(document, "result")), "enroll-completed");
    assert_int_equal(json_integer_value(json_object_get(document, "stages")), 4);
    assert_true(json_real_value(json_object_get(document, "quality")) == 0.5);
    json_decref(document);
    assert_string_equal(result.err, "Enrolling anna: look straight at the camera.\n");
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(cli_run(&script, "enroll anna --valid-until none --expired").calls,
                           "EnrollStart anna poses=1 valid-until=0 expired=1;"));
}

static const struct fake_person ada = {"Ada", 1795248000, 0, 0, 1};
static const struct fake_person gone = {"Ada", 1795248000, 0, 1767225599, 3};

static void a_used_name_is_told_at_the_beginning(void **state)
{
    static const struct fake_status completed = {"enroll-completed", true, 4, 4, 0.5, NULL, 0};
    struct fake_script script = {
        .statuses = &completed, .n_statuses = 1, .people = &ada, .n_people = 1};
    struct cli_result result = cli_run(&script, "enroll ada");

    (void)state;
    assert_string_equal(result.out, "Ada has 1 template since 2026-11-21 08:00; this adds to it.\n"
                                    "Enrolling Ada: look straight at the camera.\n"
                                    "Ada is enrolled.\n");
    script.people = &gone;
    result = cli_run(&script, "enroll ada --json");
    assert_string_equal(result.err,
                        "Ada has 3 templates since 2026-11-21 08:00; this adds to them.\n"
                        "The door has not opened to Ada since 2025-12-31 23:59 (see isotherm "
                        "validity).\n"
                        "Enrolling Ada: look straight at the camera.\n");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "person")), "Ada");
    assert_int_equal(json_integer_value(json_object_get(document, "templates_before")), 3);
    assert_true(json_is_null(json_object_get(document, "duplicate_of")));
    json_decref(document);
}

static void a_duplicate_is_named(void **state)
{
    static const struct fake_status duplicate = {"enroll-duplicate", true, 4, 4, 0.5, "Ada", 0};
    const struct fake_script script = {.statuses = &duplicate, .n_statuses = 1};
    struct cli_result result = cli_run(&script, "enroll bob");

    (void)state;
    assert_int_equal(result.exit, 1);
    assert_string_equal(result.err, "bob is not enrolled: this face is enrolled as Ada (see "
                                    "--allow-duplicate).\n");
    result = cli_run(&script, "enroll bob --json");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "duplicate_of")), "Ada");
    json_decref(document);
    const struct fake_status nameless = {"enroll-duplicate", true, 4, 4, 0.5, NULL, 0};
    const struct fake_script before = {.statuses = &nameless, .n_statuses = 1};
    result = cli_run(&before, "enroll bob");
    assert_non_null(strstr(result.err, "this face is enrolled under another name (see"));
}

/* How an action may end: the word of the daemon, the exit code, and the text for the person. */
static const struct ending {
    const char *words, *result;
    int exit;
    const char *text; /* on stdout or stderr */
} endings[] = {
    {"enroll anna", "enroll-duplicate", 1, "this face is enrolled as bob"},
    {"enroll anna", "enroll-failed", 1, "the captures did not agree with each other"},
    {"enroll anna", "enroll-not-stored", 4, "anna is not enrolled: bob."},
    {"enroll anna", "enroll-other-face", 1, "another face is enrolled under this name"},
    {"enroll anna", "enroll-attack", 1, "this looks like a picture, a screen or a mask"},
    {"enroll anna", "enroll-timed-out", 5, "no usable face in time"},
    {"enroll anna", "enroll-disconnected", 4, "the sensor has gone away"},
    {"identify", "identify-match", 0, "bob (score 3.50, threshold 2.25)"},
    {"identify", "identify-no-match", 1, "not known (best score 3.50, threshold 2.25)"},
    {"identify", "identify-attack", 1, "refused: this looks like a picture, a screen or a mask"},
    {"identify", "identify-timed-out", 5, "no usable face in time"},
    {"identify", "identify-disconnected", 4, "the sensor has gone away"},
    {"verify bob", "verify-match", 0, "bob (score 3.50, threshold 2.25)"},
    {"verify bob", "verify-no-match", 1, "this is not bob (best score 3.50, threshold 2.25)"},
    {"verify bob", "verify-attack", 1, "refused: this looks like a picture, a screen or a mask"},
    {"verify bob", "verify-timed-out", 5, "no usable face in time"},
    {"verify bob", "verify-disconnected", 4, "the sensor has gone away"},
};

static void every_ending_has_its_words_and_exit_code(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(endings); i++) {
        const struct fake_status status = {endings[i].result, true, 1, 4, 3.5, "bob", 2.25};
        const struct fake_script script = {.statuses = &status, .n_statuses = 1};
        struct cli_result result = cli_run(&script, endings[i].words);
        cli_expect_exit(&result, endings[i].exit);
        if (!strstr(result.out, endings[i].text) && !strstr(result.err, endings[i].text)) {
            fail_msg("%s: '%s' is not in '%s%s'", endings[i].result, endings[i].text, result.out,
                     result.err);
        }

        char words[64];
        (void)snprintf(words, sizeof words, "%s --json", endings[i].words);
        result = cli_run(&script, words);
        cli_expect_exit(&result, endings[i].exit);
        json_t *document = cli_json(&result);
        assert_string_equal(json_string_value(json_object_get(document, "result")),
                            endings[i].result);
        json_decref(document);
    }
}

static void a_missing_score_is_null(void **state)
{
    static const struct fake_status status = {"identify-timed-out", true, 0, 0, 7, NULL, 2};
    const struct fake_script script = {.statuses = &status, .n_statuses = 1};
    const struct cli_result result = cli_run(&script, "identify --json");
    json_t *document = cli_json(&result);

    (void)state;
    assert_true(json_is_null(json_object_get(document, "person")));
    assert_true(json_is_null(json_object_get(document, "score")));
    assert_true(json_is_null(json_object_get(document, "threshold")));
    json_decref(document);
}

/* The answer of an appliance with an empty gallery. */
static void a_score_that_is_no_number_is_left_out(void **state)
{
    const struct fake_status status = {"identify-no-match", true, 0, 0, NAN, NULL, 2};
    const struct fake_script script = {.statuses = &status, .n_statuses = 1};
    struct cli_result result = cli_run(&script, "identify");

    (void)state;
    assert_string_equal(result.out, "Look straight at the camera.\nnot known\n");
    cli_expect_exit(&result, 1);
    result = cli_run(&script, "identify --json");
    json_t *document = cli_json(&result);
    assert_true(json_is_null(json_object_get(document, "score")));
    assert_true(json_real_value(json_object_get(document, "threshold")) == 2);
    json_decref(document);
}

static void verify_says_hints_and_asks_for_the_person(void **state)
{
    static const struct fake_status statuses[] = {
        {"verify-retry-moving", false, 0, 0, 0, NULL, 0},
        {"verify-match", true, 0, 0, 4, "anna", 2},
    };
    const struct fake_script script = {.statuses = statuses, .n_statuses = COUNT(statuses)};
    const struct cli_result result = cli_run(&script, "verify anna");

    (void)state;
    assert_string_equal(result.out, "Look straight at the camera.\n  hold still\n"
                                    "anna (score 4.00, threshold 2.00)\n");
    assert_string_equal(result.calls, "Claim;VerifyStart anna;VerifyStop;Release");
}

/* Hints are printed at once. The document has the words of all of them. */
static void hints_are_in_the_document(void **state)
{
    static const struct fake_status identify[] = {
        {"identify-retry-too-far", false, 0, 0, 0, NULL, 0},
        {"identify-retry-too-far", false, 0, 0, 0, NULL, 0},
        {"identify-retry-covered-mouth", false, 0, 0, 0, NULL, 0},
        {"identify-retry-too-far", false, 0, 0, 0, NULL, 0},
        {"identify-no-match", true, 0, 0, 1, NULL, 2},
    };
    static const struct fake_status enrol[] = {
        {"enroll-retry-expression", false, 0, 4, 0, NULL, 0},
        {"enroll-timed-out", true, 0, 4, 0, NULL, 0},
    };
    const struct fake_script identifying = {.statuses = identify, .n_statuses = COUNT(identify)};
    const struct fake_script enrolling = {.statuses = enrol, .n_statuses = COUNT(enrol)};
    const char *first, *second, *third;
    struct cli_result result = cli_run(&identifying, "identify --json");
    json_t *document = cli_json(&result);

    (void)state;
    assert_int_equal(json_unpack(document, "{s:[sss!]}", "hints", &first, &second, &third), 0);
    assert_string_equal(first, "too-far");
    assert_string_equal(second, "covered-mouth");
    assert_string_equal(third, "too-far");
    assert_non_null(strstr(result.err, "  take your scarf, mask or hand from your mouth\n"));
    json_decref(document);
    result = cli_run(&enrolling, "enroll anna --json");
    document = cli_json(&result);
    assert_int_equal(json_unpack(document, "{s:[s!]}", "hints", &first), 0);
    assert_string_equal(first, "expression");
    json_decref(document);
}

static void a_silent_daemon_times_out_and_is_released(void **state)
{
    static const char *const words[] = {"enroll anna --timeout 0.05", "identify --timeout 0.05",
                                        "verify anna --timeout 0.05"};
    static const char *const calls[] = {"Claim;EnrollStart anna poses=1;EnrollStop;Release",
                                        "Claim;IdentifyStart;IdentifyStop;Release",
                                        "Claim;VerifyStart anna;VerifyStop;Release"};
    const struct fake_script script = {0};

    (void)state;
    for (size_t i = 0; i < COUNT(words); i++) {
        const struct cli_result result = cli_run(&script, words[i]);
        cli_expect_exit(&result, 5);
        assert_non_null(strstr(result.err, "no usable face in time"));
        assert_string_equal(result.calls, calls[i]);
    }
}

static void an_interrupt_releases_the_camera(void **state)
{
    static const struct fake_status enrol = {"enroll-retry-too-close", false, 0, 4, 0, NULL, 0};
    static const struct fake_status identify = {"identify-retry-flat", false, 0, 0, 0, NULL, 0};
    const struct fake_script enrolling = {.statuses = &enrol, .n_statuses = 1};
    const struct fake_script identifying = {.statuses = &identify, .n_statuses = 1};
    struct cli_result result = cli_run_interrupt(&enrolling, "enroll anna", "step back");

    (void)state;
    cli_expect_exit(&result, 130);
    assert_string_equal(result.err, "anna is not enrolled: interrupted.\n");
    assert_string_equal(result.calls, "Claim;EnrollStart anna poses=1;EnrollStop;Release");

    result = cli_run_interrupt(&identifying, "identify", "picture");
    cli_expect_exit(&result, 130);
    assert_string_equal(result.calls, "Claim;IdentifyStart;IdentifyStop;Release");
}

static void a_daemon_that_vanishes_is_a_fault(void **state)
{
    const struct fake_script script = {.vanish = true};
    const struct cli_result result = cli_run(&script, "enroll anna --json");

    (void)state;
    cli_expect_error(&result, 4, "daemon-gone");
}

static void a_camera_in_use_is_not_released(void **state)
{
    const struct fake_script script = {.fail_method = "Claim",
                                       .fail_error = "org.isotherm.Error.AlreadyInUse"};
    const struct cli_result result = cli_run(&script, "identify --json");

    (void)state;
    cli_expect_error(&result, 4, "already-in-use");
    assert_string_equal(result.calls, "Claim");
}

static void a_refused_start_releases_the_claim(void **state)
{
    const struct fake_script script = {.fail_method = "EnrollStart",
                                       .fail_error = "org.isotherm.Error.GalleryFull"};
    const struct cli_result result = cli_run(&script, "enroll anna --json");

    (void)state;
    cli_expect_error(&result, 4, "gallery-full");
    assert_string_equal(result.calls, "Claim;EnrollStart;Release");
}

/* Any program on the bus may send a signal that looks like one of the daemon. */
static void a_strangers_signal_is_not_believed(void **state)
{
    static const struct fake_status refused = {"identify-no-match", true, 0, 0, 1, NULL, 2};
    const struct fake_script script = {
        .stranger = "identify-match", .statuses = &refused, .n_statuses = 1};
    const struct cli_result result = cli_run(&script, "identify");

    (void)state;
    cli_expect_exit(&result, 1);
}

static void an_unknown_ending_is_a_fault(void **state)
{
    static const struct fake_status unknown = {"enroll-splendid", true, 1, 4, 1, NULL, 0};
    const struct fake_script script = {.statuses = &unknown, .n_statuses = 1};
    const struct cli_result result = cli_run(&script, "enroll anna --json");

    (void)state;
    cli_expect_error(&result, 4, "bad-reply");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(enrolling_guides_the_person),
        cmocka_unit_test(enrolling_hands_the_options_on),
        cmocka_unit_test(a_used_name_is_told_at_the_beginning),
        cmocka_unit_test(a_duplicate_is_named),
        cmocka_unit_test(every_ending_has_its_words_and_exit_code),
        cmocka_unit_test(a_missing_score_is_null),
        cmocka_unit_test(a_score_that_is_no_number_is_left_out),
        cmocka_unit_test(verify_says_hints_and_asks_for_the_person),
        cmocka_unit_test(hints_are_in_the_document),
        cmocka_unit_test(a_silent_daemon_times_out_and_is_released),
        cmocka_unit_test(an_interrupt_releases_the_camera),
        cmocka_unit_test(a_daemon_that_vanishes_is_a_fault),
        cmocka_unit_test(a_camera_in_use_is_not_released),
        cmocka_unit_test(a_refused_start_releases_the_claim),
        cmocka_unit_test(a_strangers_signal_is_not_believed),
        cmocka_unit_test(an_unknown_ending_is_a_fault),
    };

    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
