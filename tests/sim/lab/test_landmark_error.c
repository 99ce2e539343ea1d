/* Figures about landmarks, on artificial errors. Every figure is calculated by hand. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/eval/landmark_error.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

static struct sim_corpus_row rows[] = {
    {.recording = "b", .first = 1, .count = 1, .subject = "bob", .session = "s1"},
    {.recording = "a", .first = 1, .count = 2, .subject = "ann", .session = "s1"},
    {.recording = "c", .first = 0, .count = 1, .subject = "ann", .session = "s2"},
};
static const struct sim_corpus corpus = {3, rows};

static struct sim_deviation deviation(size_t row, enum iso_landmark l, double x, double y, double z)
{
    struct sim_deviation d = {.row = row};
    d.known[l] = true;
    d.error_mm[l] = iso_vec3(x, y, z);
    return d;
}

static void expect_spread(const struct sim_spread *s, size_t n, double mean, double median,
                          double p95, double max)
{
    assert_int_equal(s->n, n);
    assert_near(s->mean, mean, 1e-12);
    assert_near(s->median, median, 1e-12);
    assert_near(s->p95, p95, 1e-12);
    assert_near(s->max, max, 1e-12);
}

static void test_spread(void **state)
{
    (void)state;
    double values[40];
    for (int i = 0; i < 40; i++) {
        values[i] = (i * 7) % 40 + 1; /* 1..40, shuffled */
    }
    struct sim_spread s = sim_spread_of(values, 40);
    expect_spread(&s, 40, 20.5, 20.0, 38.0, 40.0);
    s = sim_spread_of(NULL, 0);
    expect_spread(&s, 0, 0.0, 0.0, 0.0, 0.0);
}

/* Ann is in two sessions, with two frames and one frame. Bob is in one. */
static void test_figures(void **state)
{
    (void)state;
    struct sim_deviation d[] = {
        deviation(0, ISO_LM_NOSE_TIP, 0, 0, 5),
        deviation(1, ISO_LM_NOSE_TIP, 1, 0, 0),
        deviation(1, ISO_LM_NOSE_TIP, 3, 0, 0),
        deviation(2, ISO_LM_NOSE_TIP, 0, 4, 0),
    };
    d[0].known[ISO_LM_MOUTH_L] = true;
    d[0].error_mm[ISO_LM_MOUTH_L] = iso_vec3(0, -2, 0);
    const struct iso_vec3 offset_mm[ISO_LANDMARKS] = {[ISO_LM_NOSE_TIP] = {1, 0, 0}};
    struct sim_landmark_error out[ISO_LANDMARKS + 1];
    assert_int_equal(sim_landmark_errors(&corpus, d, 4, offset_mm, out), 0);

    const struct sim_landmark_error *nose = &out[ISO_LM_NOSE_TIP];
    expect_spread(&nose->error_mm, 4, 13.0 / 4.0, 3.0, 5.0, 5.0);
    expect_spread(&nose->centred_error_mm, 4, (2.0 + sqrt(17) + sqrt(26)) / 4.0, 2.0, sqrt(26),
                  sqrt(26));
    assert_near(nose->offset_mm.x, 1.0, 0.0);
    /* Ann's mean is the mean of (2, 0, 0) and (0, 4, 0). Bob has only one session. */
    expect_spread(&nose->repeat_mm, 3, (2.0 + sqrt(8) + sqrt(5)) / 3.0, sqrt(5), sqrt(8), sqrt(8));
    /* Ann's two frames of one row are no pair. */
    expect_spread(&nose->slip_mm, 2, (sqrt(17) + 5.0) / 2.0, sqrt(17), 5.0, 5.0);

    expect_spread(&out[ISO_LM_MOUTH_L].error_mm, 1, 2.0, 2.0, 2.0, 2.0);
    expect_spread(&out[ISO_LM_MOUTH_L].repeat_mm, 0, 0.0, 0.0, 0.0, 0.0);
    expect_spread(&out[ISO_LM_NASION].error_mm, 0, 0.0, 0.0, 0.0, 0.0);
    expect_spread(&out[ISO_LANDMARKS].error_mm, 5, 15.0 / 5.0, 3.0, 5.0, 5.0);
    assert_int_equal(out[ISO_LANDMARKS].slip_mm.n, 2);
}

static void test_offset_is_the_median(void **state)
{
    (void)state;
    const struct sim_deviation d[] = {
        deviation(0, ISO_LM_ALA_R, 2, -1, 7),
        deviation(0, ISO_LM_ALA_R, 1, -2, 9),
        deviation(0, ISO_LM_ALA_R, 500, -900, 0), /* far from its place */
        deviation(0, ISO_LM_ALA_L, 4, 0, 0),
    };
    struct iso_vec3 offset_mm[ISO_LANDMARKS];
    assert_int_equal(sim_landmark_offsets(d, 4, offset_mm), 0);
    assert_near(offset_mm[ISO_LM_ALA_R].x, 2.0, 0.0);
    assert_near(offset_mm[ISO_LM_ALA_R].y, -2.0, 0.0);
    assert_near(offset_mm[ISO_LM_ALA_R].z, 7.0, 0.0);
    assert_near(offset_mm[ISO_LM_ALA_L].x, 4.0, 0.0);
    assert_near(offset_mm[ISO_LM_NASION].x, 0.0, 0.0);
}

/* Errors are in the face's own axes: x to the subject's left. */
static void test_deviation_is_in_the_face_frame(void **state)
{
    (void)state;
    struct iso_extraction x = {
        .camera_from_face = {{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}, {5, 6, 700}},
        .landmark_mm = {[ISO_LM_SUBNASALE] = {11, 22, 633}, [ISO_LM_NASION] = {1, 1, 1}},
    };
    struct sim_truth truth = {.known = {[ISO_LM_SUBNASALE] = true},
                              .point_mm = {[ISO_LM_SUBNASALE] = {10, 20, 630}}};
    struct sim_deviation d = sim_deviation_of(&x, &truth, 2);
    assert_int_equal(d.row, 2);
    assert_true(d.known[ISO_LM_SUBNASALE]);
    assert_false(d.known[ISO_LM_NASION]);
    assert_near(d.error_mm[ISO_LM_SUBNASALE].x, 1.0, 0.0);
    assert_near(d.error_mm[ISO_LM_SUBNASALE].y, -2.0, 0.0);
    assert_near(d.error_mm[ISO_LM_SUBNASALE].z, -3.0, 0.0);
}

static void test_truth(void **state)
{
    const char *directory = *state;
    stored_frames_write(scratch_path(directory, "a"), 3);
    stored_frames_write(scratch_path(directory, "b"), 2);
    stored_frames_write(scratch_path(directory, "c"), 1);
    scratch_write_text(scratch_path(directory, "a/landmarks.csv"),
                       "frame,name,x_mm,y_mm,z_mm\n0,nasion,4,5,6\n1,left_ear,7,8,9\n"
                       "2,nose_tip,1,2,3\n");
    struct sim_truth *truth = NULL;
    struct iso_fault fault = {.text = ""};
    if (sim_truth_read(directory, &corpus, &truth, &fault)) {
        fail_msg("%s", fault.text);
    }
    for (size_t i = 0; i < 4; i++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            assert_int_equal(truth[i].known[l], i == 2 && l == ISO_LM_NOSE_TIP);
        }
    }
    assert_near(truth[2].point_mm[ISO_LM_NOSE_TIP].y, 2.0, 0.0);
    free(truth);

    truth = NULL;
    scratch_write_text(scratch_path(directory, "c/landmarks.csv"), "no,such,header\n");
    assert_int_equal(sim_truth_read(directory, &corpus, &truth, &fault), -EBADMSG);
    assert_null(truth);
    assert_non_null(strstr(fault.text, "landmarks.csv"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread),
        cmocka_unit_test(test_figures),
        cmocka_unit_test(test_offset_is_the_median),
        cmocka_unit_test(test_deviation_is_in_the_face_frame),
        cmocka_unit_test_setup_teardown(test_truth, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
