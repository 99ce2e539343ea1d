/* Which attitudes of a head count as a pose of an enrolment, and which way to turn. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include <math.h>
#include <string.h>

#include "drivers/base/times.h"
#include "firmware/contract/contract.h"
#include "firmware/recognise/enroll_pose.h"

/* Values that differ, so that an exchange of two of them shows. */
static const struct iso_enroll_angles angles = {
    .yaw_max_rad = 14 * ISO_RAD_PER_DEG,
    .pitch_max_rad = 11 * ISO_RAD_PER_DEG,
    .yaw_rad = 18 * ISO_RAD_PER_DEG,
    .pitch_rad = 15 * ISO_RAD_PER_DEG,
    .within_rad = 6 * ISO_RAD_PER_DEG,
};

static void expect(enum iso_enroll_pose pose, double yaw_deg, double pitch_deg, const char *word,
                   double turn_deg)
{
    double turn_rad = -1;
    const enum iso_capture capture = iso_enroll_pose_judge(pose, &angles, yaw_deg * ISO_RAD_PER_DEG,
                                                           pitch_deg * ISO_RAD_PER_DEG, &turn_rad);
    assert_string_equal(iso_capture_name(capture), word);
    assert_true(fabs(turn_rad / ISO_RAD_PER_DEG - turn_deg) < 1e-9);
}

static void the_frontal_pose_is_straight_ahead(void **state)
{
    (void)state;
    expect(ISO_ENROLL_FRONTAL, 0, 0, "ok", 0);
    expect(ISO_ENROLL_FRONTAL, 13.9, -10.9, "ok", 0);
    expect(ISO_ENROLL_FRONTAL, 14.1, 0, "turn-right", 14.1);
    expect(ISO_ENROLL_FRONTAL, -14.1, 0, "turn-left", 14.1);
    expect(ISO_ENROLL_FRONTAL, 0, 11.1, "look-down", 11.1);
    expect(ISO_ENROLL_FRONTAL, 0, -11.1, "look-up", 11.1);
}

static void a_turned_head_is_within_its_range(void **state)
{
    (void)state;
    expect(ISO_ENROLL_LEFT, 0, 0, "turn-left", 18);
    expect(ISO_ENROLL_LEFT, 11.9, 0, "turn-left", 6.1);
    expect(ISO_ENROLL_LEFT, 12.1, 0, "ok", 0);
    expect(ISO_ENROLL_LEFT, 23.9, -11.9, "ok", 0);
    expect(ISO_ENROLL_LEFT, 24.1, 0, "turn-right", 6.1);
    expect(ISO_ENROLL_LEFT, -18, 0, "turn-left", 36);
    expect(ISO_ENROLL_RIGHT, 0, 0, "turn-right", 18);
    expect(ISO_ENROLL_RIGHT, -12.1, 11.9, "ok", 0);
    expect(ISO_ENROLL_RIGHT, -24.1, 0, "turn-left", 6.1);
}

static void a_bowed_or_lifted_head_is_within_its_range(void **state)
{
    (void)state;
    expect(ISO_ENROLL_DOWN, 0, 0, "look-down", 15);
    expect(ISO_ENROLL_DOWN, -11.9, -9.1, "ok", 0);
    expect(ISO_ENROLL_DOWN, 0, -21.1, "look-up", 6.1);
    expect(ISO_ENROLL_UP, 0, 0, "look-up", 15);
    expect(ISO_ENROLL_UP, 11.9, 20.9, "ok", 0);
    expect(ISO_ENROLL_UP, 0, 21.1, "look-down", 6.1);
}

static void the_axis_that_is_further_off_is_named(void **state)
{
    (void)state;
    expect(ISO_ENROLL_LEFT, 11, 20, "look-down", 20); /* exceeds by 8, the yaw by 1 */
    expect(ISO_ENROLL_LEFT, 0, 13, "turn-left", 18);
    expect(ISO_ENROLL_DOWN, 20, -8, "turn-right", 20);
    expect(ISO_ENROLL_UP, 13, 0, "look-up", 15);
}

static void poses_have_the_words_of_the_contract(void **state)
{
    static const char *const words[ISO_ENROLL_POSES] = {"frontal", "left", "right", "down", "up"};
    (void)state;
    for (int i = 0; i < ISO_ENROLL_POSES; i++) {
        assert_string_equal(iso_enroll_pose_name((enum iso_enroll_pose)i), words[i]);
    }
    assert_null(iso_enroll_pose_name(ISO_ENROLL_POSES));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_frontal_pose_is_straight_ahead),
        cmocka_unit_test(a_turned_head_is_within_its_range),
        cmocka_unit_test(a_bowed_or_lifted_head_is_within_its_range),
        cmocka_unit_test(the_axis_that_is_further_off_is_named),
        cmocka_unit_test(poses_have_the_words_of_the_contract),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
