/* The conditions that a frame must meet for an enrolment, and the view of the face. */
#include <math.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/recognise/enroll_gate.h"
#include "firmware/sensor/view.h"
#include "tests/firmware/rigs/puppets.h"

static const struct iso_enroll_gate gate = {
    .angles = {.yaw_max_rad = 15 * ISO_RAD_PER_DEG, .pitch_max_rad = 12 * ISO_RAD_PER_DEG},
    .coverage_min = 0.8,
    .pose_coverage_min = 0.7,
    .landmark_coverage_min = 0.5,
    .expression_max = 1,
    .mouth_max_mm = 8,
};

static struct iso_extraction extraction;

static int setup(void **state)
{
    (void)state;
    extraction = (struct iso_extraction){
        .outcome = ISO_CAPTURE_OK,
        .fitted = true,
        .coverage = 0.85,
        .expression_norm = 0.9,
        .tmpl = puppet_template(50, PUPPET_ALGORITHM),
    };
    return 0;
}

static const char *judge(void)
{
    return iso_capture_name(iso_enroll_gate_judge(&gate, &extraction));
}

static void uncover(enum iso_landmark landmark, float weight)
{
    for (int i = 0; i < extraction.tmpl.n_points; i++) {
        extraction.tmpl.weight[0][landmark][i] =
            i % 2 ? 0 : 2 * weight; /* the mean counts, not each weight */
    }
}

static void a_good_frame_passes(void **state)
{
    (void)state;
    assert_string_equal(judge(), "ok");
}

static void the_pose_is_named_by_what_to_do(void **state)
{
    (void)state;
    extraction.yaw_rad = 15.1 * ISO_RAD_PER_DEG; /* to the subject's left */
    assert_string_equal(judge(), "turn-right");
    extraction.yaw_rad = -15.1 * ISO_RAD_PER_DEG;
    assert_string_equal(judge(), "turn-left");
    extraction.yaw_rad = -14.9 * ISO_RAD_PER_DEG;
    assert_string_equal(judge(), "ok");
    extraction.pitch_rad = 12.1 * ISO_RAD_PER_DEG; /* up */
    assert_string_equal(judge(), "look-down");
    extraction.pitch_rad = -12.1 * ISO_RAD_PER_DEG;
    assert_string_equal(judge(), "look-up");
}

/* A turned head hides a part of its face, so less of it has to be measured. */
static void a_turned_head_may_show_less(void **state)
{
    struct iso_enroll_gate turned = gate;
    (void)state;
    turned.pose = ISO_ENROLL_LEFT;
    turned.angles.yaw_rad = 18 * ISO_RAD_PER_DEG;
    turned.angles.within_rad = 6 * ISO_RAD_PER_DEG;
    assert_int_equal(iso_enroll_gate_judge(&turned, &extraction), ISO_CAPTURE_TURN_LEFT);
    extraction.yaw_rad = 18 * ISO_RAD_PER_DEG;
    extraction.coverage = 0.71;
    assert_int_equal(iso_enroll_gate_judge(&turned, &extraction), ISO_CAPTURE_OK);
    extraction.coverage = 0.69;
    assert_int_equal(iso_enroll_gate_judge(&turned, &extraction), ISO_CAPTURE_TOO_FEW_POINTS);
    extraction.yaw_rad = 0;
    extraction.coverage = 0.79;
    assert_string_equal(judge(), "too-few-points");
}

static void covered_regions_are_named(void **state)
{
    static const struct {
        enum iso_landmark landmark;
        const char *word;
    } cases[] = {
        {ISO_LM_NASION, "covered-eyes"},     {ISO_LM_NOSE_TIP, "covered-nose"},
        {ISO_LM_ALA_R, "covered-nose"},      {ISO_LM_EYE_OUT_L, "covered-eyes"},
        {ISO_LM_LIP_UPPER, "covered-mouth"}, {ISO_LM_MOUTH_L, "covered-mouth"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(setup(NULL), 0);
        uncover(cases[i].landmark, 0.51f);
        assert_string_equal(judge(), "ok");
        uncover(cases[i].landmark, 0.49f);
        assert_string_equal(judge(), cases[i].word);
    }
}

static void half_a_hidden_face_is_named(void **state)
{
    (void)state;
    uncover(ISO_LM_EYE_OUT_L, 0.1f);
    uncover(ISO_LM_MOUTH_L, 0.2f);
    assert_string_equal(judge(), "covered-left");
    uncover(ISO_LM_SUBNASALE, 0.05f); /* the middle is at the edge of the region */
    assert_string_equal(judge(), "covered-left");
    uncover(ISO_LM_MOUTH_R, 0.4f); /* part of the other half, too: not just one half */
    assert_string_equal(judge(), "covered-nose");
    assert_int_equal(setup(NULL), 0);
    uncover(ISO_LM_ALA_R, 0.3f);
    uncover(ISO_LM_MOUTH_R, 0.0f);
    uncover(ISO_LM_EYE_IN_R, 0.2f);
    assert_string_equal(judge(), "covered-right");
}

static void holes_all_over_are_too_few_points(void **state)
{
    (void)state;
    extraction.coverage = 0.79;
    assert_string_equal(judge(), "too-few-points");
}

static void a_grimace_is_not_kept(void **state)
{
    (void)state;
    extraction.expression_norm = 1.01;
    assert_string_equal(judge(), "expression");
    extraction.coverage = 0.7; /* the coverage is checked before the expression */
    assert_string_equal(judge(), "too-few-points");
}

static void an_open_mouth_is_not_kept(void **state)
{
    (void)state;
    extraction.ibug_mm[62] = iso_vec3(3, 40, 700);
    extraction.ibug_mm[66] = iso_vec3(3, 44, 706);
    assert_string_equal(judge(), "ok"); /* 7.2 mm */
    extraction.ibug_mm[66] = iso_vec3(3, 46, 706);
    assert_string_equal(judge(), "expression"); /* 8.5 mm */
}

/* ---- the view ---- */

static void nobody_has_no_pose(void **state)
{
    const struct iso_extraction nobody = {.outcome = ISO_CAPTURE_NO_FACE};
    const struct iso_track_motion none = {0};
    const struct iso_view view = iso_view_of(&nobody, ISO_CAPTURE_NO_FACE, &none);
    (void)state;
    assert_int_equal(view.capture, ISO_CAPTURE_NO_FACE);
    assert_false(view.posed || view.fitted || view.tracked);
}

static void a_face_is_described(void **state)
{
    const struct iso_track_motion motion = {.track = 3, .known = true, .mm_s = 12, .rad_s = 0.25};
    (void)state;
    extraction.camera_from_face.translation_mm = iso_vec3(-30, 45, 810);
    extraction.yaw_rad = 0.1;
    extraction.pitch_rad = -0.2;
    extraction.roll_rad = 0.3;
    extraction.residual_mm = 1.75;
    extraction.fit_coverage = 0.97;
    extraction.sigma_mm[ISO_LM_ALA_L] = 3.5;
    extraction.sigma_mm[ISO_LM_NASION] = 2;
    const struct iso_view view = iso_view_of(&extraction, ISO_CAPTURE_MOVING, &motion);
    assert_int_equal(view.capture, ISO_CAPTURE_MOVING);
    assert_true(view.posed && view.fitted && view.tracked);
    assert_true(view.right_mm == -30 && view.down_mm == 45 && view.distance_mm == 810);
    assert_true(view.yaw_rad == 0.1 && view.pitch_rad == -0.2 && view.roll_rad == 0.3);
    assert_true(view.residual_mm == 1.75 && view.fit_coverage == 0.97 && view.coverage == 0.85);
    assert_true(view.sigma_mm == 3.5 && view.expression == 0.9);
    assert_true(view.mm_s == 12 && view.rad_s == 0.25);
}

/* A face that was found but not fitted has a position and no quality. */
static void a_rough_pose_has_no_quality(void **state)
{
    const struct iso_track_motion none = {0};
    (void)state;
    extraction.fitted = false;
    extraction.outcome = ISO_CAPTURE_TOO_FAR;
    extraction.camera_from_face.translation_mm = iso_vec3(0, 0, 1900);
    const struct iso_view view = iso_view_of(&extraction, ISO_CAPTURE_TOO_FAR, &none);
    assert_true(view.posed && view.distance_mm == 1900);
    assert_false(view.fitted || view.tracked);
    assert_true(view.coverage == 0 && view.expression == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(a_good_frame_passes, setup),
        cmocka_unit_test_setup(the_pose_is_named_by_what_to_do, setup),
        cmocka_unit_test_setup(a_turned_head_may_show_less, setup),
        cmocka_unit_test_setup(covered_regions_are_named, setup),
        cmocka_unit_test_setup(half_a_hidden_face_is_named, setup),
        cmocka_unit_test_setup(holes_all_over_are_too_few_points, setup),
        cmocka_unit_test_setup(a_grimace_is_not_kept, setup),
        cmocka_unit_test_setup(an_open_mouth_is_not_kept, setup),
        cmocka_unit_test_setup(nobody_has_no_pose, setup),
        cmocka_unit_test_setup(a_face_is_described, setup),
        cmocka_unit_test_setup(a_rough_pose_has_no_quality, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
