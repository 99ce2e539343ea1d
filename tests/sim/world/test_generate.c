/* Generated corpora: readable, repeatable, and true to their own ground truth. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "isotherm/landmark.h"
#include "sim/corpus/corpus.h"
#include "sim/lab/methods/anthroface.h"
#include "sim/world/generate/generate.h"
#include "tests/support/scratch.h"

static const char *model_directory(void)
{
    const char *shared = getenv("ISOTHERM_SHARED");
    return scratch_path(shared ? shared : ISOTHERM_SOURCE_DIR "/../shared", "data/ict-face");
}

static struct sim_generate_options small(const char *directory)
{
    struct sim_generate_options options = sim_generate_options_default();
    if (!scratch_exists(model_directory())) {
        skip();
    }
    options.ict_directory = model_directory();
    options.directory = directory;
    options.n_people = 2;
    options.n_probes = 3;
    options.n_strangers = 1;
    options.frames_per_visit = 2;
    return options;
}

static void generate(const struct sim_generate_options *options)
{
    struct iso_fault fault = {.text = ""};
    int error = sim_generate(options, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
}

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
    struct sim_generate_options options = small(scratch_path(*state, "who"));
    struct sim_corpus *corpus = NULL;
    generate(&options);
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

static void same_file(const char *a, const char *b, const char *name, bool same)
{
    size_t n_a, n_b;
    void *bytes_a = scratch_read(scratch_path(a, name), &n_a);
    void *bytes_b = scratch_read(scratch_path(b, name), &n_b);
    assert_int_equal(n_a == n_b && memcmp(bytes_a, bytes_b, n_a) == 0, same);
    free(bytes_a);
    free(bytes_b);
}

static void the_same_options_make_the_same_bytes(void **state)
{
    char first[128], again[128], other[128];
    (void)strcpy(first, scratch_path(*state, "first"));
    (void)strcpy(again, scratch_path(*state, "again"));
    (void)strcpy(other, scratch_path(*state, "other"));
    struct sim_generate_options options = small(first);
    options.n_people = options.n_probes = 1;
    generate(&options);
    options.directory = again;
    generate(&options);
    options.directory = other;
    options.seed = 2;
    generate(&options);
    same_file(first, again, "manifest.csv", true);
    same_file(first, again, "p0000-s1/landmarks.csv", true);
    same_file(first, again, "p0000-s1/depth/000001.png", true);
    same_file(first, other, "p0000-s1/depth/000001.png", false);
    same_file(first, other, "p0000-s1/landmarks.csv", false);
}

/* How far the depth at a landmark's own pixel lies from the landmark. */
static double depth_error(const struct iso_frame *frame, struct iso_vec3 landmark_mm)
{
    double u, v;
    assert_true(iso_camera_project(&frame->camera, landmark_mm, &u, &v));
    double z = (double)iso_frame_depth_at(frame, (int)lrint(u), (int)lrint(v));
    return z > 0.0 ? fabs(z - landmark_mm.z) : 0.0;
}

static void check_landmarks(const struct iso_frame *frame,
                            const struct iso_recording_landmark rows[ISO_LANDMARKS])
{
    for (int k = 0; k < ISO_LANDMARKS; k++) {
        assert_string_equal(rows[k].name, iso_landmark_name((enum iso_landmark)k));
        /* noses and lips have steep sides, and eyeballs bulge out of the corners */
        assert_true(depth_error(frame, rows[k].point_mm) < 8.0);
    }
    assert_true(depth_error(frame, rows[ISO_LM_NASION].point_mm) < 3.0);
    assert_true(rows[ISO_LM_EYE_OUT_R].point_mm.x < rows[ISO_LM_EYE_IN_R].point_mm.x);
    assert_true(rows[ISO_LM_EYE_IN_R].point_mm.x < rows[ISO_LM_EYE_IN_L].point_mm.x);
    assert_true(rows[ISO_LM_NASION].point_mm.y < rows[ISO_LM_LIP_UPPER].point_mm.y);
    assert_true(rows[ISO_LM_NOSE_TIP].point_mm.z < rows[ISO_LM_NASION].point_mm.z);
}

static void every_sensor_sees_the_landmarks(void **state)
{
    for (int s = 0; sim_sensors[s]; s++) {
        struct sim_generate_options options = small(scratch_path(*state, sim_sensors[s]->name));
        struct iso_recording *recording = NULL;
        struct iso_recording_landmark *rows = NULL;
        struct iso_frame *frame = NULL;
        size_t n_rows;
        options.n_people = 1;
        options.n_probes = options.n_strangers = 0;
        options.sensor = sim_sensors[s];
        generate(&options);
        const char *path = scratch_path(options.directory, "p0000-s0");
        assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
        assert_int_equal(iso_recording_frames(recording), 2);
        assert_int_equal(iso_recording_landmarks(recording, &rows, &n_rows, NULL), 0);
        assert_int_equal(n_rows, 2 * ISO_LANDMARKS);
        assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        for (size_t i = 0; i < 2; i++) {
            assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
            check_landmarks(frame, rows + i * ISO_LANDMARKS);
        }
        iso_frame_free(frame);
        free(rows);
        iso_recording_close(recording);
    }
}

/* Sessions of the preset `landmarks`: on the disc of yaw and pitch, in both bands of pose, with
 * strong expressions. */
static void landmark_sessions_cover_the_disc(void **state)
{
    struct sim_generate_options options = small(scratch_path(*state, "disc"));
    struct sim_corpus *corpus = NULL;
    int near = 0, far = 0, left = 0, up = 0;
    options.preset = "landmarks";
    options.n_people = 3;
    options.n_sessions = 8;
    options.frames_per_visit = 1;
    generate(&options);
    assert_int_equal(sim_corpus_read(options.directory, &corpus, NULL), 0);
    assert_int_equal(corpus->n_rows, 24);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        char recording[32];
        int yaw, pitch, roll;
        (void)snprintf(recording, sizeof recording, "p%04zu-s%zu", i / 8, 1 + i % 8);
        assert_string_equal(row->recording, recording);
        assert_int_equal(row->role, SIM_ROLE_PROBE);
        assert_string_not_equal(row->expression, "neutral");
        assert_string_not_equal(row->expression, "mild");
        assert_int_equal(sscanf(row->pose, "y%dp%dr%d", &yaw, &pitch, &roll), 3);
        assert_true(hypot(yaw / 35.5, pitch / (0.7 * 35.0 + 0.5)) <= 1.001);
        assert_in_range(roll + 15, 0, 30);
        near += hypot(yaw, pitch) <= 25.0;
        far += hypot(yaw, pitch) > 25.0;
        left += yaw > 0;
        up += pitch > 0;
    }
    print_message("%d sessions to 25 degrees, %d beyond; %d to the left, %d up\n", near, far, left,
                  up);
    assert_true(near >= 6 && far >= 3);
    assert_true(left >= 3 && left <= 21 && up >= 3 && up <= 21);
    sim_corpus_free(corpus);
}

static void landmark_sessions_are_noisy_and_limited(void **state)
{
    char own[128], given[128], narrow[128];
    (void)strcpy(own, scratch_path(*state, "own"));
    (void)strcpy(given, scratch_path(*state, "given"));
    (void)strcpy(narrow, scratch_path(*state, "narrow"));
    struct sim_generate_options options = small(own);
    options.preset = "landmarks";
    options.n_people = 1;
    options.n_sessions = 2;
    options.frames_per_visit = 1;
    generate(&options);
    options.directory = given;
    options.noise_scale = 2.5;
    options.pose_limit_rad = 35.0 * 3.14159265358979324 / 180.0;
    generate(&options);
    same_file(own, given, "p0000-s2/depth/000000.png", true);
    options.directory = narrow;
    options.pose_limit_rad = 0.01;
    generate(&options);
    struct sim_corpus *corpus = NULL;
    assert_int_equal(sim_corpus_read(narrow, &corpus, NULL), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        int yaw, pitch;
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_true(abs(yaw) <= 1 && abs(pitch) <= 1);
    }
    sim_corpus_free(corpus);
}

static void bad_options_are_refused(void **state)
{
    struct sim_generate_options options = small(scratch_path(*state, "bad"));
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
    bad.directory = scratch_path(*state, "no/such/parent");
    assert_int_equal(sim_generate(&bad, &fault), -ENOENT);
}

static void recordings_are_not_overwritten(void **state)
{
    struct sim_generate_options options = small(scratch_path(*state, "twice"));
    struct iso_fault fault = {.text = ""};
    options.n_people = 1;
    options.n_probes = options.n_strangers = 0;
    generate(&options);
    assert_int_equal(sim_generate(&options, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "p0000-s0"));
}

/* With --ir the depths are the same to the bit, and every frame has an image that shows the person.
 */
static void infrared_leaves_the_depths(void **state)
{
    const char *plain = scratch_path(*state, "plain"), *with = scratch_path(*state, "with");
    struct sim_generate_options options = small(plain);
    options.n_probes = options.n_strangers = 0;
    generate(&options);
    options.directory = with;
    options.infrared = true;
    generate(&options);
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

/* The marks of the first frame of a recording; free with free(). */
static struct iso_recording_landmark *marks_of(const char *directory, const char *name,
                                               size_t n_wanted)
{
    struct iso_recording *recording = NULL;
    struct iso_recording_landmark *rows = NULL;
    size_t n_rows;
    assert_int_equal(iso_recording_open(scratch_path(directory, name), &recording, NULL), 0);
    assert_int_equal(iso_recording_landmarks(recording, &rows, &n_rows, NULL), 0);
    assert_int_equal(n_rows, n_wanted);
    iso_recording_close(recording);
    return rows;
}

static struct sim_generate_options one_frame(const char *preset, const char *directory)
{
    struct sim_generate_options options = small(directory);
    options.preset = preset;
    options.frames_per_visit = 1;
    return options;
}

/* Enrolment where the sensor is used, visits from afar; and every marked point written. */
static void far_visits_are_far(void **state)
{
    struct sim_generate_options options = one_frame("far", scratch_path(*state, "far"));
    options.marks = true;
    generate(&options);
    struct iso_recording_landmark *near_by = marks_of(options.directory, "p0000-s0", SIM_MARKS);
    assert_true(near_by[ISO_LM_NOSE_TIP].point_mm.z < 880.0);
    free(near_by);
    static const char *const visits[] = {"p0000-s1", "p0001-s1", "p0000-s2", "x0002-s1"};
    for (size_t i = 0; i < 4; i++) {
        struct iso_recording_landmark *rows = marks_of(options.directory, visits[i], SIM_MARKS);
        assert_in_range((int)rows[ISO_LM_NOSE_TIP].point_mm.z, 880, 1220);
        for (int m = 0; m < SIM_MARKS; m++) {
            assert_true(sim_mark_find(rows[m].name) >= 0);
            for (int k = 0; k < m; k++) {
                assert_string_not_equal(rows[k].name, rows[m].name);
            }
        }
        free(rows);
    }
}

/* Whatever the preset has. */
static void visits_stand_where_they_are_told_to(void **state)
{
    struct sim_generate_options options = one_frame("mild", scratch_path(*state, "placed"));
    options.near_mm = 1500.0;
    options.far_mm = 1600.0;
    generate(&options);
    struct iso_recording_landmark *rows = marks_of(options.directory, "p0001-s0", ISO_LANDMARKS);
    assert_true(rows[ISO_LM_NOSE_TIP].point_mm.z < 880.0); /* enrolment */
    free(rows);
    rows = marks_of(options.directory, "p0001-s1", ISO_LANDMARKS);
    assert_in_range((int)rows[ISO_LM_NOSE_TIP].point_mm.z, 1480, 1620);
    free(rows);
}

/* How far the corners of the eyes are from each other. */
static double eye_distance(const char *directory, const char *name)
{
    struct iso_recording_landmark *rows = marks_of(directory, name, ISO_LANDMARKS);
    double d = iso_norm(iso_sub(rows[ISO_LM_EYE_OUT_R].point_mm, rows[ISO_LM_EYE_OUT_L].point_mm));
    free(rows);
    return d;
}

/* A variance of 0.36 makes every difference from the mean face 0.6 times as large. */
static void hard_people_look_alike(void **state)
{
    char hard[256], wide[256], mean[256];
    (void)strcpy(hard, scratch_path(*state, "hard"));
    (void)strcpy(wide, scratch_path(*state, "wide"));
    (void)strcpy(mean, scratch_path(*state, "mean"));
    struct sim_generate_options options = one_frame("hard", hard);
    options.n_probes = options.n_strangers = 0;
    generate(&options);
    options.directory = wide;
    options.identity_variance = 1.0;
    generate(&options);
    options.directory = mean;
    options.identity_variance = 0.0;
    generate(&options);
    for (int p = 0; p < 2; p++) {
        const char *name = p == 0 ? "p0000-s0" : "p0001-s0";
        double average = eye_distance(mean, name);
        double near_by = eye_distance(hard, name) - average;
        double apart = eye_distance(wide, name) - average;
        assert_true(fabs(apart) > 0.5);
        assert_true(fabs(near_by - 0.6 * apart) < 0.05);
    }
}

static void turned_visits_stay_on_the_disc(void **state)
{
    struct sim_generate_options options = one_frame("pose", scratch_path(*state, "pose"));
    struct sim_corpus *corpus = NULL;
    int farthest = 0;
    options.n_people = 1;
    options.n_probes = 8;
    options.n_strangers = 0;
    generate(&options);
    assert_int_equal(sim_corpus_read(options.directory, &corpus, NULL), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        int yaw, pitch, limit = corpus->rows[i].role == SIM_ROLE_GALLERY ? 15 : 35;
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_true(abs(yaw) <= limit && abs(pitch) <= 25);
        farthest = abs(yaw) > farthest ? abs(yaw) : farthest;
    }
    assert_true(farthest > 15);
    sim_corpus_free(corpus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(far_visits_are_far),
        cmocka_unit_test(visits_stand_where_they_are_told_to),
        cmocka_unit_test(hard_people_look_alike),
        cmocka_unit_test(turned_visits_stay_on_the_disc),
        cmocka_unit_test(the_manifest_says_who_is_where),
        cmocka_unit_test(the_same_options_make_the_same_bytes),
        cmocka_unit_test(every_sensor_sees_the_landmarks),
        cmocka_unit_test(landmark_sessions_cover_the_disc),
        cmocka_unit_test(landmark_sessions_are_noisy_and_limited),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(recordings_are_not_overwritten),
        cmocka_unit_test_setup_teardown(infrared_leaves_the_depths, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
