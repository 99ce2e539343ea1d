/* An enrolment in poses as a person sees it, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const struct fake_status with_poses[] = {
    {"step-begun", false, 1, 5, 0, "frontal", 0},
    {"enroll-stage-passed", false, 1, 3, 0.875, NULL, 0},
    {"step-passed", false, 1, 5, 0, "frontal", 0},
    {"step-begun", false, 2, 5, 0, "left", 0},
    {"step-turn", false, 2, 5, 17.6, "left", 0},
    {"enroll-retry-turn-left", false, 1, 3, 0, NULL, 0},
    {"step-turn", false, 2, 5, 13, "left", 0},
    {"enroll-retry-turn-left", false, 1, 3, 0, NULL, 0}, /* hardly less than before */
    {"step-turn", false, 2, 5, 9, "left", 0},
    {"enroll-retry-turn-left", false, 1, 3, 0, NULL, 0},
    {"enroll-retry-expression", false, 1, 3, 0, NULL, 0}, /* has no angle */
    {"enroll-stage-passed", false, 2, 3, 0.75, NULL, 0},
    {"step-passed", false, 2, 5, 0, "left", 0},
    {"step-begun", false, 4, 5, 0, "down", 0},
    {"step-left-out", false, 4, 5, 0, "down", 0},
    {"step-begun", false, 5, 5, 0, "sideways", 0}, /* of a later daemon */
    {"step-left-out", false, 5, 5, 0, "sideways", 0},
    {"enroll-completed", true, 2, 2, 0.8125, NULL, 0},
};

static void enrolling_guides_through_the_poses(void **state)
{
    const struct fake_script script = {.statuses = with_poses, .n_statuses = COUNT(with_poses)};
    const struct cli_result result = cli_run(&script, "enroll anna");

    (void)state;
    assert_string_equal(result.out,
                        "Enrolling anna: look straight at the camera.\n"
                        "step 1 of 5: look straight at the camera\n"
                        "stage 1/3 done (quality 0.88)\n"
                        "step 2 of 5: turn your head a little to your left\n"
                        "  turn a little to your left, by about 18 degrees\n"
                        "  turn a little to your left, by about 9 degrees\n"
                        "  close your mouth and look calm\n"
                        "stage 2/3 done (quality 0.75)\n"
                        "step 4 of 5: lower your chin a little\n"
                        "step 4 of 5 (down) is left out: too few frames of this pose in "
                        "time, or not of the same face\n"
                        "step 5 of 5: sideways\n"
                        "step 5 of 5 (sideways) is left out: too few frames of this pose in "
                        "time, or not of the same face\n"
                        "anna is enrolled. Poses that are left out: down sideways.\n");
    cli_expect_exit(&result, 0);

    const struct cli_result again = cli_run(&script, "enroll anna --json");
    json_t *document = cli_json(&again);
    const char *poses[2], *left_out[2];
    assert_int_equal(json_unpack(document, "{s:[ss!], s:[ss!]}", "poses", &poses[0], &poses[1],
                                 "left_out", &left_out[0], &left_out[1]),
                     0);
    assert_string_equal(poses[1], "left");
    assert_string_equal(left_out[0], "down");
    json_decref(document);
}

static void a_quick_enrolment_asks_for_no_poses(void **state)
{
    static const struct fake_status completed = {"enroll-completed", true, 4, 4, 0.5, NULL, 0};
    const struct fake_script script = {.statuses = &completed, .n_statuses = 1};
    const struct cli_result result = cli_run(&script, "enroll --quick anna --json");

    (void)state;
    assert_string_equal(result.calls, "Claim;EnrollStart anna;EnrollStop;Release");
    json_t *document = cli_json(&result);
    assert_int_equal(json_array_size(json_object_get(document, "poses")), 0);
    assert_int_equal(json_array_size(json_object_get(document, "left_out")), 0);
    json_decref(document);
}

static void a_person_without_room_is_told_what_makes_room(void **state)
{
    const struct fake_script script = {.fail_method = "EnrollStart",
                                       .fail_error = "org.isotherm.Error.GalleryFull",
                                       .fail_text = "anna has 12 templates"};
    struct cli_result result = cli_run(&script, "enroll anna");

    (void)state;
    cli_expect_exit(&result, 4);
    assert_string_equal(result.err,
                        "isotherm: anna has 12 templates; --quick adds one template and not five, "
                        "isotherm remove NAME makes room\n");
    result = cli_run(&script, "enroll --quick anna");
    assert_string_equal(result.err,
                        "isotherm: anna has 12 templates; isotherm remove NAME makes room\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(enrolling_guides_through_the_poses),
        cmocka_unit_test(a_quick_enrolment_asks_for_no_poses),
        cmocka_unit_test(a_person_without_room_is_told_what_makes_room),
    };

    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
