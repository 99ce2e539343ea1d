/* Presets of generated corpora: people in the visits stand, turn and look as the preset says. */
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
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

/* Returns the marks of the first frame of a recording. Free them with free(). */
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
    struct sim_generate_options options = generated_small(directory);
    options.preset = preset;
    options.frames_per_visit = 1;
    return options;
}

/* People enrol at the usual distance, and stand farther away at their visits. Every marked point is
 * written. */
static void far_visits_are_far(void **state)
{
    struct sim_generate_options options = one_frame("far", scratch_path(*state, "far"));
    options.marks = true;
    generated_write(&options);
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

/* near_mm and far_mm apply to every preset. */
static void visits_stand_where_they_are_told_to(void **state)
{
    struct sim_generate_options options = one_frame("mild", scratch_path(*state, "placed"));
    options.near_mm = 1500.0;
    options.far_mm = 1600.0;
    generated_write(&options);
    struct iso_recording_landmark *rows = marks_of(options.directory, "p0001-s0", ISO_LANDMARKS);
    assert_true(rows[ISO_LM_NOSE_TIP].point_mm.z < 880.0); /* enrolment */
    free(rows);
    rows = marks_of(options.directory, "p0001-s1", ISO_LANDMARKS);
    assert_in_range((int)rows[ISO_LM_NOSE_TIP].point_mm.z, 1480, 1620);
    free(rows);
}

/* Returns the distance between the corners of the eyes. */
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
    generated_write(&options);
    options.directory = wide;
    options.identity_variance = 1.0;
    generated_write(&options);
    options.directory = mean;
    options.identity_variance = 0.0;
    generated_write(&options);
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
    generated_write(&options);
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

/* Heads of the preset `bowed` are bent down and up by up to 35 degrees, and turned by no more than
 * those of `mild`. */
static void bowed_visits_bend_both_ways(void **state)
{
    struct sim_generate_options options = one_frame("bowed", scratch_path(*state, "bowed"));
    int lowest = 0, highest = 0;
    options.n_people = 1;
    options.n_probes = 10;
    options.n_strangers = 0;
    struct sim_corpus *corpus = generated_corpus(&options);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const bool gallery = corpus->rows[i].role == SIM_ROLE_GALLERY;
        int yaw, pitch;
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_true(abs(yaw) <= (gallery ? 15 : 10) && abs(pitch) <= (gallery ? 15 : 35));
        lowest = pitch < lowest ? pitch : lowest;
        highest = pitch > highest ? pitch : highest;
    }
    assert_true(lowest < -15 && highest > 15);
    sim_corpus_free(corpus);
}

/* pitch_limit_rad sets the disc's radius in pitch. */
static void training_sessions_bend_as_far_as_they_are_told_to(void **state)
{
    struct sim_generate_options options = one_frame("training", scratch_path(*state, "bent"));
    int farthest = 0;
    options.n_people = 2;
    options.n_sessions = 6;
    options.pose_limit_rad = 5.0 * 3.14159265358979324 / 180.0;
    options.pitch_limit_rad = 35.0 * 3.14159265358979324 / 180.0;
    struct sim_corpus *corpus = generated_corpus(&options);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        int yaw, pitch;
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_true(abs(yaw) <= 5 && abs(pitch) <= 35);
        farthest = abs(pitch) > farthest ? abs(pitch) : farthest;
    }
    assert_true(farthest > 15);
    sim_corpus_free(corpus);
}

/* Sessions of the preset `landmarks` are on the disc of yaw and pitch, in both bands of pose, and
 * have strong expressions. */
static void landmark_sessions_cover_the_disc(void **state)
{
    struct sim_generate_options options = generated_small(scratch_path(*state, "disc"));
    struct sim_corpus *corpus = NULL;
    int near = 0, far = 0, left = 0, up = 0;
    options.preset = "landmarks";
    options.n_people = 3;
    options.n_sessions = 8;
    options.frames_per_visit = 1;
    generated_write(&options);
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
    struct sim_generate_options options = generated_small(own);
    options.preset = "landmarks";
    options.n_people = 1;
    options.n_sessions = 2;
    options.frames_per_visit = 1;
    generated_write(&options);
    options.directory = given;
    options.noise_scale = 2.5;
    options.pose_limit_rad = 35.0 * 3.14159265358979324 / 180.0;
    generated_write(&options);
    assert_true(generated_same(own, given, "p0000-s2/depth/000000.png"));
    options.directory = narrow;
    options.pose_limit_rad = 0.01;
    generated_write(&options);
    struct sim_corpus *corpus = NULL;
    assert_int_equal(sim_corpus_read(narrow, &corpus, NULL), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        int yaw, pitch;
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_true(abs(yaw) <= 1 && abs(pitch) <= 1);
    }
    sim_corpus_free(corpus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(far_visits_are_far),
        cmocka_unit_test(visits_stand_where_they_are_told_to),
        cmocka_unit_test(hard_people_look_alike),
        cmocka_unit_test(turned_visits_stay_on_the_disc),
        cmocka_unit_test(bowed_visits_bend_both_ways),
        cmocka_unit_test(training_sessions_bend_as_far_as_they_are_told_to),
        cmocka_unit_test(landmark_sessions_cover_the_disc),
        cmocka_unit_test(landmark_sessions_are_noisy_and_limited),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
