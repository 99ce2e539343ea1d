/* Generated corpora can be read and repeated, and agree with their own ground truth. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "isotherm/landmark.h"
#include "sim/corpus/corpus.h"
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

static void the_manifest_says_who_is_where(void **state)
{
    static const struct {
        const char *recording, *subject;
        enum sim_role role;
    } expected[] = {
        {"p0000-s0", "p0000", SIM_ROLE_GALLERY}, {"p0001-s0", "p0001", SIM_ROLE_GALLERY},
        {"p0000-s1", "p0000", SIM_ROLE_PROBE},   {"p0001-s1", "p0001", SIM_ROLE_PROBE},
        {"p0000-s2", "p0000", SIM_ROLE_PROBE},   {"x0002-s1", "x0002", SIM_ROLE_IMPOSTOR},
    };
    struct sim_generate_options options = generated_small(scratch_path(*state, "who"));
    struct sim_corpus *corpus = NULL;
    generated_write(&options);
    assert_int_equal(sim_corpus_read(options.directory, &corpus, NULL), 0);
    assert_int_equal(corpus->n_rows, sizeof expected / sizeof *expected);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        assert_string_equal(corpus->rows[i].recording, expected[i].recording);
        assert_string_equal(corpus->rows[i].subject, expected[i].subject);
        assert_int_equal(corpus->rows[i].role, expected[i].role);
        assert_int_equal(corpus->rows[i].first, 0);
        assert_int_equal(corpus->rows[i].count, 2);
        bool gallery = expected[i].role == SIM_ROLE_GALLERY;
        assert_string_equal(corpus->rows[i].expression, gallery ? "neutral" : "mild");
    }
    sim_corpus_free(corpus);
}

static void the_same_options_make_the_same_bytes(void **state)
{
    char first[128], again[128], other[128];
    (void)strcpy(first, scratch_path(*state, "first"));
    (void)strcpy(again, scratch_path(*state, "again"));
    (void)strcpy(other, scratch_path(*state, "other"));
    struct sim_generate_options options = generated_small(first);
    options.n_people = options.n_probes = 1;
    generated_write(&options);
    options.directory = again;
    generated_write(&options);
    options.directory = other;
    options.seed = 2;
    generated_write(&options);
    assert_true(generated_same(first, again, "manifest.csv"));
    assert_true(generated_same(first, again, "p0000-s1/landmarks.csv"));
    assert_true(generated_same(first, again, "p0000-s1/depth/000001.png"));
    assert_false(generated_same(first, other, "p0000-s1/depth/000001.png"));
    assert_false(generated_same(first, other, "p0000-s1/landmarks.csv"));
}

/* Returns the distance between a landmark and the depth at its own pixel. */
static double depth_error(const struct iso_frame *frame, struct iso_vec3 landmark_mm)
{
    double u, v;
    assert_true(iso_camera_project(&frame->camera, landmark_mm, &u, &v));
    double z = (double)iso_frame_depth_at(frame, (int)lrint(u), (int)lrint(v));
    return z > 0.0 ? fabs(z - landmark_mm.z) : 0.0;
}

/* `smooth_mm`: the greatest error of the sensor on a smooth place. */
static void check_landmarks(const struct iso_frame *frame, double smooth_mm,
                            const struct iso_recording_landmark rows[ISO_LANDMARKS])
{
    for (int k = 0; k < ISO_LANDMARKS; k++) {
        assert_string_equal(rows[k].name, iso_landmark_name((enum iso_landmark)k));
        /* noses and lips have steep sides, and eyeballs bulge out of the corners */
        assert_true(depth_error(frame, rows[k].point_mm) < smooth_mm + 5.0);
    }
    assert_true(depth_error(frame, rows[ISO_LM_NASION].point_mm) < smooth_mm);
    assert_true(rows[ISO_LM_EYE_OUT_R].point_mm.x < rows[ISO_LM_EYE_IN_R].point_mm.x);
    assert_true(rows[ISO_LM_EYE_IN_R].point_mm.x < rows[ISO_LM_EYE_IN_L].point_mm.x);
    assert_true(rows[ISO_LM_NASION].point_mm.y < rows[ISO_LM_LIP_UPPER].point_mm.y);
    assert_true(rows[ISO_LM_NOSE_TIP].point_mm.z < rows[ISO_LM_NASION].point_mm.z);
}

static void every_sensor_sees_the_landmarks(void **state)
{
    for (int s = 0; sim_sensors[s]; s++) {
        struct sim_generate_options options = generated_small(
            scratch_path(*state, sim_sensors[s]->name));
        struct iso_recording *recording = NULL;
        struct iso_recording_landmark *rows = NULL;
        struct iso_frame *frame = NULL;
        size_t n_rows;
        /* Half a step of up to 8 mm, an offset, wiggling and multipath add up. */
        const double smooth_mm = sim_sensors[s] == &sim_sensor_kinect2_coarse ? 8.0 : 3.0;
        options.n_people = 1;
        options.n_probes = options.n_strangers = 0;
        options.sensor = sim_sensors[s];
        generated_write(&options);
        const char *path = scratch_path(options.directory, "p0000-s0");
        assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
        assert_int_equal(iso_recording_frames(recording), 2);
        assert_int_equal(iso_recording_landmarks(recording, &rows, &n_rows, NULL), 0);
        assert_int_equal(n_rows, 2 * ISO_LANDMARKS);
        assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        for (size_t i = 0; i < 2; i++) {
            assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
            check_landmarks(frame, smooth_mm, rows + i * ISO_LANDMARKS);
        }
        iso_frame_free(frame);
        free(rows);
        iso_recording_close(recording);
    }
}

static void bad_options_are_refused(void **state)
{
    struct sim_generate_options options = generated_small(scratch_path(*state, "bad"));
    struct sim_generate_options bad = options;
    struct iso_fault fault = {.text = ""};
    bad.preset = "wild";
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "wild"));
    bad = options;
    bad.n_people = 0;
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    bad = options;
    bad.noise_scale = NAN;
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    bad = options;
    bad.identity_variance = 101.0;
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    bad = options;
    bad.pose_limit_rad = 0.0;
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    static const double ranges[][2] = {
        {700.0, 0.0}, {0.0, 700.0}, {700.0, 600.0}, {700.0, NAN}, {700.0, 1e5}};
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        bad = options;
        bad.near_mm = ranges[i][0];
        bad.far_mm = ranges[i][1];
        assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    }
    bad = options;
    bad.n_sessions = 0;
    assert_int_equal(sim_generate(&bad, &fault), -EINVAL);
    bad = options;
    bad.ict_directory = scratch_path(*state, "no-model");
    assert_int_equal(sim_generate(&bad, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "no-model"));
    bad = options;
    scratch_write_text(scratch_path(*state, "a-file"), "text");
    bad.directory = scratch_path(*state, "a-file/corpus");
    assert_int_equal(sim_generate(&bad, &fault), -ENOTDIR);
    assert_non_null(strstr(fault.text, "a-file"));
}

static void recordings_are_not_overwritten(void **state)
{
    struct sim_generate_options options = generated_small(scratch_path(*state, "twice"));
    struct iso_fault fault = {.text = ""};
    options.n_people = 1;
    options.n_probes = options.n_strangers = 0;
    generated_write(&options);
    assert_int_equal(sim_generate(&options, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "p0000-s0"));
}

/* With --ir the depths do not change by a bit, and every frame has an image that shows the person.
 */
static void infrared_leaves_the_depths(void **state)
{
    const char *plain = scratch_path(*state, "plain"), *with = scratch_path(*state, "with");
    struct sim_generate_options options = generated_small(plain);
    options.n_probes = options.n_strangers = 0;
    generated_write(&options);
    options.directory = with;
    options.infrared = true;
    generated_write(&options);
    for (int person = 0; person < 2; person++) {
        const char *name = person == 0 ? "p0000-s0" : "p0001-s0";
        struct iso_recording *a, *b;
        struct iso_frame *without, *frame;
        assert_int_equal(iso_recording_open(scratch_path(plain, name), &a, NULL), 0);
        assert_int_equal(iso_recording_open(scratch_path(with, name), &b, NULL), 0);
        assert_false(iso_recording_has_intensity(a));
        assert_true(iso_recording_has_intensity(b));
        assert_int_equal(iso_recording_frame_new(a, &without), 0);
        assert_int_equal(iso_recording_frame_new(b, &frame), 0);
        for (size_t i = 0; i < 2; i++) {
            size_t n = (size_t)frame->width_px * (size_t)frame->height_px, lit = 0;
            assert_int_equal(iso_recording_read(a, i, without, NULL), 0);
            assert_int_equal(iso_recording_read(b, i, frame, NULL), 0);
            assert_memory_equal(frame->depth_mm, without->depth_mm, n * sizeof *frame->depth_mm);
            for (size_t k = 0; k < n; k++) {
                lit += frame->intensity[k] > 0.1F;
            }
            assert_true(lit > n / 100 && lit < n / 2);
        }
        iso_frame_free(without);
        iso_frame_free(frame);
        iso_recording_close(a);
        iso_recording_close(b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_manifest_says_who_is_where),
        cmocka_unit_test(the_same_options_make_the_same_bytes),
        cmocka_unit_test(every_sensor_sees_the_landmarks),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(recordings_are_not_overwritten),
        cmocka_unit_test_setup_teardown(infrared_leaves_the_depths, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
