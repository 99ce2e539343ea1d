/* The complete computation from a frame to a template: outcomes and hints on rendered heads, whose
 * truth is known, and on the stored frames. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/core/extract/extract_rig.h"
#include "tests/core/surfaces/rendered_head.h"

static void the_mean_head_gives_its_pose_landmarks_and_template(void **state)
{
    struct extract_rig *f = *state;
    struct iso_rigid truth = rendered_head_pose(14.0, -8.0, iso_vec3(-30, 20, 640));
    assert_int_equal(extract_rig_outcome(f, 14.0, -8.0, iso_vec3(-30, 20, 640)), ISO_CAPTURE_OK);
    const struct iso_extraction *out = &f->out;
    rendered_head_assert_pose(&out->camera_from_face, &truth, 1.0, 1.0);
    assert_true(fabs(out->yaw_rad * 180.0 / M_PI - 14.0) < 1.0);
    assert_true(fabs(out->pitch_rad * 180.0 / M_PI + 8.0) < 1.0);
    assert_true(fabs(out->roll_rad) * 180.0 / M_PI < 3.0);
    assert_true(fabs(out->distance_mm - 640.0) < 1.0);
    assert_true(out->residual_mm >= 0.0 && out->residual_mm < 2.0);
    assert_true(out->coverage > 0.8 && out->coverage <= 1.0);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 at = iso_head_point_on(f->model, f->model->mean_mm,
                                               f->model->landmarks[iso_landmark_ibug[l]]);
        at = iso_rigid_apply(&truth, at);
        assert_true(iso_norm(iso_sub(out->landmark_mm[l], at)) < 3.0);
    }
    assert_int_equal(out->tmpl.algorithm, iso_extractor_algorithm(f->extractor));
    assert_int_equal(out->tmpl.n_radii, 4);
    assert_int_equal(out->tmpl.n_points, 16);
    assert_int_equal(out->tmpl.n_frames, 1);
    assert_true(out->tmpl.radius_mm[0] == 12.0f && out->tmpl.radius_mm[3] == 36.0f);
    assert_true(out->tmpl.quality > 0.8f && out->tmpl.quality <= 1.0f);
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    assert_true(iso_template_serialise(&out->tmpl, bytes, sizeof bytes) > 0);
}

static void hints_say_where_to_stand(void **state)
{
    struct extract_rig *f = *state;
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(10, 0, 1700)), ISO_CAPTURE_TOO_FAR);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, 0, 265)), ISO_CAPTURE_TOO_CLOSE);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, 0, 3000)), ISO_CAPTURE_NOBODY);
    /* Half out of the image at the right, at the top, at the left and at the bottom. */
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(344, 0, 600)), ISO_CAPTURE_MOVE_RIGHT);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, -263, 600)), ISO_CAPTURE_MOVE_DOWN);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(-344, 0, 600)), ISO_CAPTURE_MOVE_LEFT);
    assert_int_equal(extract_rig_outcome(f, 0, 0, iso_vec3(0, 263, 600)), ISO_CAPTURE_MOVE_UP);
}

/* A person who is turned to the left should turn to the right, and so on. The test lowers the
 * limits, because the search finds no face that is turned by more than 60 degrees. */
static void hints_say_where_to_look(void **state)
{
    struct extract_rig *f = *state;
    struct iso_vec3 at = {0, 0, 600};
    f->options.yaw_max_rad = 20.0 * M_PI / 180.0;
    f->options.pitch_max_rad = 15.0 * M_PI / 180.0;
    extract_rig_renew(f);
    assert_int_equal(extract_rig_outcome(f, 17, -12, at), ISO_CAPTURE_OK);
    assert_int_equal(extract_rig_outcome(f, -17, 12, at), ISO_CAPTURE_OK);
    assert_int_equal(extract_rig_outcome(f, 30, 0, at), ISO_CAPTURE_TURN_RIGHT);
    assert_true(f->out.yaw_rad > 0.0);
    assert_int_equal(extract_rig_outcome(f, -30, 0, at), ISO_CAPTURE_TURN_LEFT);
    assert_true(f->out.yaw_rad < 0.0);
    assert_int_equal(extract_rig_outcome(f, 0, 25, at), ISO_CAPTURE_LOOK_DOWN);
    assert_true(f->out.pitch_rad > 0.0);
    assert_int_equal(extract_rig_outcome(f, 0, -25, at), ISO_CAPTURE_LOOK_UP);
    assert_true(f->out.pitch_rad < 0.0);
}

static enum iso_capture way_back(double yaw_deg, double pitch_deg)
{
    if (yaw_deg != 0.0) {
        return yaw_deg > 0.0 ? ISO_CAPTURE_TURN_RIGHT : ISO_CAPTURE_TURN_LEFT;
    }
    return pitch_deg > 0.0 ? ISO_CAPTURE_LOOK_DOWN : ISO_CAPTURE_LOOK_UP;
}

/* With the default limits, a head that is turned or bowed by 25 to 50 degrees is either accepted,
 * or the person is told which way to turn back to the camera. From 50 degrees on no head is
 * accepted.
 */
static void a_turned_head_is_told_to_turn(void **state)
{
    struct extract_rig *f = *state;
    for (int deg = 25; deg <= 50; deg += 5) {
        for (int way = 0; way < 4; way++) {
            const double sign = way % 2 ? -1.0 : 1.0;
            const double yaw = way < 2 ? sign * deg : 0.0, pitch = way < 2 ? 0.0 : sign * deg;
            const enum iso_capture outcome = extract_rig_outcome(f, yaw, pitch,
                                                                 iso_vec3(0, 0, 600));
            print_message("yaw %.0f, pitch %.0f: %s\n", yaw, pitch, iso_capture_name(outcome));
            assert_true(outcome == way_back(yaw, pitch) ||
                        (outcome == ISO_CAPTURE_OK && deg <= 45));
        }
    }
}

/* A head of a wrong size is refused for its size if it looks into the camera. If it is turned by 35
 * degrees, the person is told to turn instead. Such a head is never accepted. */
static void a_turned_head_of_a_wrong_size_is_told_to_turn(void **state)
{
    struct extract_rig *f = *state;
    for (int yaw = -35; yaw <= 35; yaw += 35) {
        const struct iso_rigid pose = rendered_head_pose(yaw, 0.0, iso_vec3(0, 0, 600));
        rendered_head_clear(f->frame);
        rendered_head_draw(f->frame, f->model, NULL, 1.3, &pose);
        const enum iso_capture outcome = extract_rig_run(f);
        print_message("size 1.3, yaw %d: %s\n", yaw, iso_capture_name(outcome));
        assert_int_equal(outcome, yaw ? way_back(yaw, 0.0) : ISO_CAPTURE_WRONG_SIZE);
        assert_int_equal(f->out.cue, yaw ? ISO_CAPTURE_WRONG_SIZE : ISO_CAPTURE_NO_FACE);
    }
}

/* The left of the subject is the right of the image. This test checks it without the convention of
 * the pose. */
static void the_subjects_left_is_the_images_right(void **state)
{
    struct extract_rig *f = *state;
    assert_int_equal(extract_rig_outcome(f, 25, 0, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    const struct iso_vec3 *at = f->out.landmark_mm;
    assert_true(at[ISO_LM_EYE_OUT_L].x > at[ISO_LM_EYE_OUT_R].x);
    assert_true(at[ISO_LM_MOUTH_L].y > at[ISO_LM_EYE_OUT_L].y); /* y points down */
    /* Turned to the left, the left eye is the farther one. */
    assert_true(at[ISO_LM_EYE_OUT_L].z > at[ISO_LM_EYE_OUT_R].z + 10.0);
}

/* An empty frame, a wall in front of the camera, and a wall behind the range of use. */
static void an_empty_scene_is_nobody(void **state)
{
    struct extract_rig *f = *state;
    assert_int_equal(extract_rig_run(f), ISO_CAPTURE_NOBODY);
    rendered_head_wall(f->frame, 800.0f);
    assert_int_equal(extract_rig_run(f), ISO_CAPTURE_NOBODY);
    rendered_head_wall(f->frame, 1700.0f);
    assert_int_equal(extract_rig_run(f), ISO_CAPTURE_NOBODY);
    assert_int_equal(f->out.tmpl.n_points, 0);
}

/* The right half of the face and the nose are hidden. The search needs the nose tip, so that it
 * finds no face, or only half of one. */
static void a_hidden_half_has_no_template(void **state)
{
    struct extract_rig *f = *state;
    extract_rig_draw(f, 0, 0, iso_vec3(0, 0, 600));
    for (int row = 0; row < 480; row++) {
        memset(&f->frame->depth_mm[row * 640], 0, 320 * sizeof(float)); /* the nose: column 310 */
    }
    enum iso_capture outcome = extract_rig_run(f);
    assert_true(outcome == ISO_CAPTURE_TOO_FEW_POINTS || outcome == ISO_CAPTURE_COVERED_RIGHT ||
                outcome == ISO_CAPTURE_NOT_A_FACE);
    assert_int_equal(f->out.tmpl.n_points, 0);
}

static void the_same_frame_gives_the_same_template(void **state)
{
    struct extract_rig *f = *state;
    assert_int_equal(extract_rig_outcome(f, 5, 5, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    struct iso_extraction first = f->out;
    assert_int_equal(extract_rig_run(f), ISO_CAPTURE_OK);
    assert_memory_equal(&first, &f->out, sizeof first);
    /* Neither other people in between nor another extractor change the template. */
    assert_int_equal(extract_rig_outcome(f, -20, 0, iso_vec3(60, 0, 900)), ISO_CAPTURE_OK);
    assert_memory_not_equal(&first.tmpl, &f->out.tmpl, sizeof first.tmpl);
    rendered_head_wall(f->frame, 250.0f);
    (void)extract_rig_run(f);
    assert_int_equal(extract_rig_outcome(f, 5, 5, iso_vec3(0, 0, 600)), ISO_CAPTURE_OK);
    assert_memory_equal(&first, &f->out, sizeof first);
    struct iso_extractor *other = NULL;
    assert_int_equal(iso_extractor_new(f->model, &f->options, &other), 0);
    assert_int_equal(iso_extractor_run(other, f->frame, &f->out), 0);
    assert_memory_equal(&first, &f->out, sizeof first);
    iso_extractor_free(other);
}

/* Runs the frames of a stored recording in turn, and returns the outcome of each. */
static void run_stored(struct extract_rig *f, const char *name, size_t n_frames,
                       enum iso_capture *outcome)
{
    char path[256];
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_true(iso_recording_frames(recording) >= n_frames);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    for (size_t i = 0; i < n_frames; i++) {
        assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
        assert_int_equal(iso_extractor_run(f->extractor, frame, &f->out), 0);
        outcome[i] = f->out.outcome;
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void stored_people_are_captured(void **state)
{
    struct extract_rig *f = *state;
    enum { PEOPLE = 24 };
    for (int person = 1; person <= PEOPLE; person++) {
        char name[16];
        enum iso_capture outcome;
        (void)snprintf(name, sizeof name, "p%02d-enrol", person);
        run_stored(f, name, 1, &outcome);
        assert_int_equal(outcome, ISO_CAPTURE_OK);
        assert_true(f->out.tmpl.quality > 0.8f);
        assert_true(f->out.distance_mm > 400.0 && f->out.distance_mm < 1000.0);
    }
}

/* Recordings without a usable face. The outcome must be one of the listed ones. */
static void an_unusable_face_has_a_reason(void **state)
{
    struct extract_rig *f = *state;
    static const struct {
        const char *recording;
        unsigned reasons; /* bits */
    } rows[] = {
        {"none-nobody1", 1u << ISO_CAPTURE_NOBODY},
        /* a chair within reach: one frame cannot tell it from a visitor */
        {"none-nobody2", 1u << ISO_CAPTURE_NOBODY | 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back1", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back2", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-back3", 1u << ISO_CAPTURE_NOT_A_FACE},
        {"none-cut4", 1u << ISO_CAPTURE_MOVE_LEFT | 1u << ISO_CAPTURE_MOVE_RIGHT},
        {"none-cut5", 1u << ISO_CAPTURE_MOVE_LEFT | 1u << ISO_CAPTURE_MOVE_RIGHT},
        {"none-photo1",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_FLAT},
        {"none-photo2",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_FLAT},
        {"none-photo3",
         1u << ISO_CAPTURE_NO_FACE | 1u << ISO_CAPTURE_NOT_A_FACE | 1u << ISO_CAPTURE_BENT},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        enum iso_capture outcome[3];
        run_stored(f, rows[i].recording, 3, outcome);
        for (int k = 0; k < 3; k++) {
            if (!(rows[i].reasons >> outcome[k] & 1u)) {
                fail_msg("%s, frame %d: %s", rows[i].recording, k, iso_capture_name(outcome[k]));
            }
        }
        assert_int_equal(f->out.tmpl.n_points, 0);
    }
}

/* Rounds all depths of the frame to multiples of a step. */
static void come_in_steps(struct iso_frame *frame, double step_mm)
{
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        frame->depth_mm[i] = (float)(step_mm * nearbyint((double)frame->depth_mm[i] / step_mm));
    }
}

static void a_face_whose_depths_come_in_coarse_steps_is_measured(void **state)
{
    struct extract_rig *f = *state;
    for (double step_mm = 1.0; step_mm <= 9.0; step_mm += 1.0) {
        for (double yaw_deg = -20.0; yaw_deg <= 20.0; yaw_deg += 20.0) {
            extract_rig_draw(f, yaw_deg, 0.0, iso_vec3(20, 10, 950));
            come_in_steps(f->frame, step_mm);
            assert_int_equal(extract_rig_run(f), ISO_CAPTURE_OK);
            assert_true(f->out.coverage > 0.86);
            assert_true(f->out.occlusion.covered[ISO_PART_NOSE] < 0.06);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_mean_head_gives_its_pose_landmarks_and_template,
                                        extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(hints_say_where_to_stand, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_turned_head_is_told_to_turn, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_turned_head_of_a_wrong_size_is_told_to_turn,
                                        extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(hints_say_where_to_look, extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(the_subjects_left_is_the_images_right, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(an_empty_scene_is_nobody, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_hidden_half_has_no_template, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(the_same_frame_gives_the_same_template, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(stored_people_are_captured, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_face_whose_depths_come_in_coarse_steps_is_measured,
                                        extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(an_unusable_face_has_a_reason, extract_rig_new,
                                        extract_rig_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
