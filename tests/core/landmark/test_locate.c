/* Landmarks of a frame without a template: covered faces, several faces, faces that are followed,
 * and the uncertainty of the landmarks. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/core/extract/extract_rig.h"
#include "tests/core/surfaces/rendered_head.h"

static const struct iso_vec3 middle = {0, 0, 600};
enum { FRAME_NS = 33333333 };

static void draw(struct extract_rig *f, struct iso_vec3 nose_mm)
{
    struct iso_rigid pose = rendered_head_pose(0, 0, nose_mm);
    rendered_head_draw(f->frame, f->model, NULL, 1.0, &pose);
}

static enum iso_capture locate(struct extract_rig *f)
{
    assert_int_equal(iso_extractor_locate(f->extractor, f->frame, &f->out), 0);
    return f->out.outcome;
}

/* Covers a rectangle in the face frame of a head at `middle`. `depth_mm` is the depth of an object
 * in front of the head, or 0 for a hole. */
static void cover(struct extract_rig *f, double left_mm, double right_mm, double low_mm,
                  double high_mm, float depth_mm)
{
    for (int v = 0; v < 480; v++) {
        for (int u = 0; u < 640; u++) {
            struct iso_vec3 p = iso_camera_back_project(&f->frame->camera, u, v, middle.z);
            bool inside = p.x >= left_mm && p.x <= right_mm && -p.y >= low_mm && -p.y <= high_mm;
            float *z = &f->frame->depth_mm[v * 640 + u];
            if (inside && *z > 0.0f) {
                *z = depth_mm;
            }
        }
    }
}

/* x points to the subject's left, which is the right of the image. */
static const struct {
    double left, right, low, high;
    enum iso_face_part part;
    enum iso_capture outcome;
} covers[] = {
    {-60, 60, 48, 90, ISO_PART_BROW, ISO_CAPTURE_COVERED_BROW},
    {-65, 65, 8, 48, ISO_PART_EYES, ISO_CAPTURE_COVERED_EYES},
    {-45, 45, -70, -22, ISO_PART_MOUTH, ISO_CAPTURE_COVERED_MOUTH},
    {8, 90, -100, 90, ISO_PART_LEFT, ISO_CAPTURE_COVERED_LEFT},
    {-90, -8, -100, 90, ISO_PART_RIGHT, ISO_CAPTURE_COVERED_RIGHT},
};

static void covered_parts_are_named(void **state)
{
    struct extract_rig *f = *state;
    const float depths[] = {0.0f, 560.0f}; /* a hole; a hand 40 mm before the nose */
    for (size_t i = 0; i < sizeof covers / sizeof *covers; i++) {
        /* A board in front of half of the face is the nearest object, and it is flat. So a side of
         * the face is covered only by a hole. */
        bool side = covers[i].part == ISO_PART_LEFT || covers[i].part == ISO_PART_RIGHT;
        for (int k = 0; k < (side ? 1 : 2); k++) {
            rendered_head_clear(f->frame);
            draw(f, middle);
            cover(f, covers[i].left, covers[i].right, covers[i].low, covers[i].high, depths[k]);
            enum iso_capture outcome = locate(f);
            if (outcome != covers[i].outcome) {
                fail_msg("%s covered at %g: %s", iso_face_part_name(covers[i].part),
                         (double)depths[k], iso_capture_name(outcome));
            }
            assert_true(f->out.fitted && f->out.occlusion.covered[covers[i].part] > 0.6);
        }
    }
}

static void nothing_is_covered_of_a_bare_face(void **state)
{
    struct extract_rig *f = *state;
    draw(f, middle);
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    for (int part = 0; part < ISO_FACE_PARTS; part++) {
        assert_true(f->out.occlusion.covered[part] < 0.05);
        assert_non_null(iso_face_part_name((enum iso_face_part)part));
    }
    assert_null(iso_face_part_name(ISO_FACE_PARTS));
}

static void two_people_side_by_side_are_several_faces(void **state)
{
    struct extract_rig *f = *state;
    draw(f, iso_vec3(-110, 0, 620));
    draw(f, iso_vec3(110, 0, 640));
    assert_int_equal(locate(f), ISO_CAPTURE_SEVERAL_FACES);
    rendered_head_clear(f->frame);
    draw(f, iso_vec3(-110, 0, 620));
    draw(f, iso_vec3(140, 0, 1000));
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    assert_true(fabs(f->out.distance_mm - 620.0) < 5.0);
}

static void landmarks_are_those_of_a_template(void **state)
{
    struct extract_rig *f = *state;
    draw(f, middle);
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    struct iso_extraction located = f->out;
    assert_int_equal(located.tmpl.n_points, 0);
    assert_int_equal(iso_extractor_run(f->extractor, f->frame, &f->out), 0);
    assert_true(f->out.tmpl.n_points > 0);
    assert_memory_equal(located.landmark_mm, f->out.landmark_mm, sizeof located.landmark_mm);
    assert_memory_equal(located.ibug_mm, f->out.ibug_mm, sizeof located.ibug_mm);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 twin = located.ibug_mm[iso_landmark_ibug[l]];
        assert_memory_equal(&located.landmark_mm[l], &twin, sizeof twin);
    }
}

/* Adds a fixed pattern of mean 0, which is as rough as noise and the same on every machine. */
static void roughen(struct extract_rig *f, float amount_mm)
{
    for (int i = 0; i < 640 * 480; i++) {
        float sign = (i * 7 + i / 640 * 3) % 5 < 2 ? 1.5f : -1.0f;
        if (f->frame->depth_mm[i] > 0.0f) {
            f->frame->depth_mm[i] += sign * amount_mm;
        }
    }
}

static void rough_frames_are_less_sure(void **state)
{
    struct extract_rig *f = *state;
    draw(f, middle);
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    struct iso_extraction smooth = f->out;
    roughen(f, 2.0f);
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        assert_true(smooth.sigma_mm[l] > 0.0 && smooth.sigma_mm[l] < 2.0);
        assert_true(f->out.sigma_mm[l] > 1.5 * smooth.sigma_mm[l]);
    }
    /* The nasion is determined from all sides; the mouth moves with the expression. */
    assert_true(f->out.sigma_mm[ISO_LM_NASION] < f->out.sigma_mm[ISO_LM_MOUTH_R]);
}

/* A head that drifts from frame to frame is found once and then followed. */
static void a_face_is_followed(void **state)
{
    struct extract_rig *f = *state;
    struct iso_extractor *plain = NULL;
    struct iso_extract_options options = iso_extract_options_default();
    assert_int_equal(iso_extractor_new(f->model, &options, &plain), 0);
    f->options.track = true;
    extract_rig_renew(f);
    int followed = 0;
    for (int i = 0; i < 24; i++) {
        struct iso_extraction looked_for;
        rendered_head_clear(f->frame);
        draw(f, iso_vec3(4.0 * i - 40.0, 2.0 * i, 600.0 + i));
        f->frame->t_ns = (int64_t)(i + 1) * FRAME_NS;
        assert_int_equal(locate(f), ISO_CAPTURE_OK);
        assert_int_equal(iso_extractor_locate(plain, f->frame, &looked_for), 0);
        assert_false(looked_for.tracked);
        followed += f->out.tracked;
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            assert_true(iso_norm(iso_sub(f->out.landmark_mm[l], looked_for.landmark_mm[l])) < 0.5);
        }
    }
    assert_int_equal(followed, 24 - 3); /* the first frame, and again after every ten */
    iso_extractor_free(plain);
}

static void a_lost_face_is_looked_for(void **state)
{
    struct extract_rig *f = *state;
    f->options.track = true;
    extract_rig_renew(f);
    draw(f, iso_vec3(-100, 0, 700));
    f->frame->t_ns = FRAME_NS;
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    rendered_head_clear(f->frame);
    draw(f, iso_vec3(120, 20, 600)); /* in another place in the next frame */
    f->frame->t_ns = 2 * FRAME_NS;
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    assert_false(f->out.tracked);
    assert_true(fabs(f->out.distance_mm - 600.0) < 5.0);
    f->frame->t_ns = 3 * FRAME_NS;
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    assert_true(f->out.tracked);
    f->frame->t_ns = 3 * FRAME_NS + 1000000000; /* too long ago */
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    assert_false(f->out.tracked);
    iso_extractor_forget(f->extractor);
    f->frame->t_ns += FRAME_NS;
    assert_int_equal(locate(f), ISO_CAPTURE_OK);
    assert_false(f->out.tracked);
    rendered_head_clear(f->frame);
    f->frame->t_ns += FRAME_NS;
    assert_int_equal(locate(f), ISO_CAPTURE_NOBODY);
}

static void a_nearer_person_is_seen_within_ten_frames(void **state)
{
    struct extract_rig *f = *state;
    f->options.track = true;
    extract_rig_renew(f);
    for (int i = 0; i < 13; i++) {
        rendered_head_clear(f->frame);
        draw(f, iso_vec3(-130, 0, 900));
        if (i > 0) {
            draw(f, iso_vec3(90, 0, 550));
        }
        f->frame->t_ns = (int64_t)(i + 1) * FRAME_NS;
        assert_int_equal(locate(f), ISO_CAPTURE_OK);
        if (i >= 11) {
            assert_true(fabs(f->out.distance_mm - 550.0) < 5.0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(covered_parts_are_named, extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(nothing_is_covered_of_a_bare_face, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(two_people_side_by_side_are_several_faces, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(landmarks_are_those_of_a_template, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(rough_frames_are_less_sure, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_face_is_followed, extract_rig_new, extract_rig_free),
        cmocka_unit_test_setup_teardown(a_lost_face_is_looked_for, extract_rig_new,
                                        extract_rig_free),
        cmocka_unit_test_setup_teardown(a_nearer_person_is_seen_within_ten_frames, extract_rig_new,
                                        extract_rig_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
