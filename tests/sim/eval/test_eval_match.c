/* Enrolment and searches with artificial templates. */
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

#include "core/match/cohort.h"
#include "sim/base/random.h"
#include "sim/lab/match/match.h"
#include "sim/lab/match/parallel.h"

/* The working memory of registrations. */
static struct iso_icp_workspace registration;

/* The working memory of the functions under test. */
static struct iso_rerank_workspace work;

/* A template of random points. A person always has the same points; `noise_mm` moves them. */
static struct iso_template person_template(uint64_t person, double noise_mm, uint64_t take)
{
    struct iso_template t = {.algorithm = 7, .n_radii = 1, .n_points = 8, .n_frames = 1};
    struct sim_random shape = sim_random_seeded(1, person, 0);
    struct sim_random noise = sim_random_seeded(2, person, take);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < t.n_points; i++) {
            for (int k = 0; k < 3; k++) {
                t.points_mm[0][l][i][k] = (float)(20.0 * sim_random_normal(&shape) +
                                                  noise_mm * sim_random_normal(&noise));
            }
            t.weight[0][l][i] = 1.0f;
        }
    }
    return t;
}

/* Person 0 enrols twice, person 1 once, and person 2 is not acquired. Two probes follow, of 1 and
 * of 0. */
enum { ROWS = 6 };
static struct sim_corpus_row rows[ROWS] = {
    {.subject = "zoe", .role = SIM_ROLE_GALLERY}, {.subject = "adam", .role = SIM_ROLE_GALLERY},
    {.subject = "zoe", .role = SIM_ROLE_GALLERY}, {.subject = "ben", .role = SIM_ROLE_GALLERY},
    {.subject = "adam", .role = SIM_ROLE_PROBE},  {.subject = "zoe", .role = SIM_ROLE_PROBE},
};
static struct sim_corpus corpus = {ROWS, rows};
static struct sim_sample samples[ROWS];
static struct sim_acquisition acquisition = {0, ROWS, NULL, samples, {7, "astra"}};

static int setup(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROWS; i++) {
        samples[i] = (struct sim_sample){.row = i, .acquired = i != 3, .reason = ISO_CAPTURE_OK};
    }
    samples[0].tmpl = person_template(0, 3.0, 0);
    samples[1].tmpl = person_template(1, 1.0, 0);
    samples[2].tmpl = person_template(0, 0.5, 1);
    samples[4].tmpl = person_template(1, 1.0, 1);
    samples[5].tmpl = person_template(0, 0.5, 2);
    return 0;
}

static struct sim_gallery *enrol(size_t limit)
{
    struct sim_gallery *gallery = NULL;
    assert_int_equal(sim_gallery_new(&corpus, &acquisition, limit, &gallery), 0);
    return gallery;
}

static void test_gallery(void **state)
{
    (void)state;
    struct sim_gallery *gallery = enrol(0);
    assert_int_equal(gallery->n_people, 3);
    assert_int_equal(gallery->n_templates, 3);
    assert_int_equal(sim_gallery_find(gallery, "adam"), 1);
    assert_true(sim_gallery_find(gallery, "eve") == SIM_NOBODY);
    assert_int_equal(gallery->n_templates_of[0], 2);
    assert_int_equal(gallery->n_templates_of[2], 0);
    sim_gallery_free(gallery);
}

static void test_gallery_limit(void **state)
{
    (void)state;
    struct sim_gallery *gallery = enrol(1);
    assert_int_equal(gallery->n_people, 1);
    assert_int_equal(gallery->n_templates, 2); /* also of zoe's second recording */
    assert_true(sim_gallery_find(gallery, "adam") == SIM_NOBODY);
    sim_gallery_free(gallery);
}

static struct sim_matches *match(const struct sim_gallery *gallery, const struct iso_cohort *cohort,
                                 int threads)
{
    const struct sim_scoring scoring = {.cohort = cohort, .match = iso_match_options_default()};
    struct sim_matches *matches = NULL;
    assert_int_equal(sim_match(&corpus, &acquisition, gallery, &scoring, threads, &matches), 0);
    return matches;
}

static void test_best_template_counts(void **state)
{
    (void)state;
    struct sim_gallery *gallery = enrol(0);
    struct sim_matches *m = match(gallery, NULL, 1);
    struct iso_match_options options = iso_match_options_default();
    double far, near;
    assert_int_equal(m->n_probes, 2);
    assert_int_equal(m->sample[1], 5);
    assert_int_equal(
        iso_match_distance(&registration, &samples[5].tmpl, &samples[0].tmpl, &options, &far), 0);
    assert_int_equal(
        iso_match_distance(&registration, &samples[5].tmpl, &samples[2].tmpl, &options, &near), 0);
    assert_true(near < far);
    assert_float_equal(m->distance_mm[3], near, 0.0);
    assert_float_equal(m->score[3], -near, 0.0); /* without a cohort */
    assert_true(m->distance_mm[3] < m->distance_mm[4]);
    assert_true(m->distance_mm[1] < m->distance_mm[0]);          /* the other probe is adam's */
    assert_true(isinf(m->distance_mm[5]) && isinf(m->score[5])); /* ben is not enrolled */
    sim_matches_free(m);
    sim_gallery_free(gallery);
}

static void test_threads_do_not_matter(void **state)
{
    (void)state;
    struct sim_gallery *gallery = enrol(0);
    struct sim_matches *one = match(gallery, NULL, 1), *three = match(gallery, NULL, 3);
    assert_memory_equal(one->score, three->score, 6 * sizeof(double));
    sim_matches_free(one);
    sim_matches_free(three);
    sim_gallery_free(gallery);
}

static void test_missing_points(void **state)
{
    (void)state;
    /* The probe has only a quarter of the landmarks, too few points for a comparison. */
    for (int l = 3; l < ISO_LANDMARKS; l++) {
        memset(samples[4].tmpl.weight[0][l], 0, sizeof samples[4].tmpl.weight[0][l]);
    }
    struct sim_gallery *gallery = enrol(0);
    struct sim_matches *m = match(gallery, NULL, 1);
    assert_true(isinf(m->distance_mm[0]) && m->score[0] < 0.0);
    assert_true(isfinite(m->distance_mm[3]));
    sim_matches_free(m);
    sim_gallery_free(gallery);
}

static struct iso_cohort *new_cohort(void)
{
    struct iso_template people[ISO_COHORT_MIN];
    const struct iso_template *pointers[ISO_COHORT_MIN];
    for (uint64_t i = 0; i < ISO_COHORT_MIN; i++) {
        people[i] = person_template(100 + i, 0.0, 0);
        pointers[i] = &people[i];
    }
    void *bytes;
    size_t size;
    struct iso_cohort *cohort = NULL;
    assert_int_equal(iso_cohort_serialise(pointers, ISO_COHORT_MIN, &bytes, &size), 0);
    assert_int_equal(iso_cohort_parse(bytes, size, &cohort, NULL), 0);
    free(bytes);
    return cohort;
}

static void test_cohort_normalises(void **state)
{
    (void)state;
    struct sim_gallery *gallery = enrol(0);
    struct iso_cohort *cohort = new_cohort();
    struct sim_matches *m = match(gallery, cohort, 1);
    assert_true(m->score[3] > 0.8); /* zoe herself: nearly a perfect match */
    assert_true(m->score[4] < 0.5); /* adam: like any person of the cohort */
    sim_matches_free(m);

    memset(samples[4].tmpl.weight, 0, sizeof samples[4].tmpl.weight);
    m = match(gallery, cohort, 1);
    assert_false(samples[4].acquired);
    assert_int_equal(samples[4].reason, ISO_CAPTURE_TOO_FEW_POINTS);
    sim_matches_free(m);
    iso_cohort_free(cohort);
    sim_gallery_free(gallery);
}

/* Makes a metric with two dimensions over all points. */
static struct iso_metric *new_metric(void)
{
    const struct iso_metric shape = {
        .algorithm = 7,
        .landmarks = (1U << ISO_LANDMARKS) - 1,
        .n_radii = 1,
        .n_points = 8,
        .n_dimensions = 2,
        .weight_min = 0.3f,
        .gain = 1.0f,
        .rerank = {.metric = 0.5f, .upper = 2.0f, .bias = 0.25f},
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    for (int v = 0; v < m->n_values; v++) {
        m->curve_mm[v] = 20.0f * (float)sin(1.7 * v);
        m->axis[2 * v] = 0.01f * (float)cos(0.3 * v);
        m->axis[2 * v + 1] = 0.01f * (float)cos(0.7 * v);
    }
    m->between[0] = m->between[1] = 4.0f;
    return m;
}

static void add_upper_face(uint64_t person, struct iso_template *tmpl)
{
    for (int v = 2; v < ISO_UPPER_ROWS; v++) {
        for (int u = 2; u < ISO_UPPER_COLUMNS - 2; u++) {
            tmpl->upper.kind[v][u] = ISO_UPPER_MEASURED;
            tmpl->upper.z_mm[v][u] = (float)(-0.02 * (u - 24) * (u - 24) +
                                             3.0 * sin(0.2 * u + 0.5 * (double)person) *
                                                 cos(0.15 * v * (double)(person % 3 + 1)));
        }
    }
}

/* Thirteen people, and a probe of number 4. */
enum { PEOPLE = 13 };

static void fill_crowd(struct sim_corpus_row crowd[PEOPLE + 1], struct sim_sample seen[PEOPLE + 1])
{
    for (size_t i = 0; i <= PEOPLE; i++) {
        const uint64_t person = i < PEOPLE ? i : 4;
        crowd[i] = (struct sim_corpus_row){.role = i < PEOPLE ? SIM_ROLE_GALLERY : SIM_ROLE_PROBE};
        (void)snprintf(crowd[i].subject, sizeof crowd[i].subject, "p%02d", (int)person);
        seen[i] = (struct sim_sample){.row = i, .acquired = true, .reason = ISO_CAPTURE_OK};
        seen[i].tmpl = person_template(person, 1.0, i);
        add_upper_face(person, &seen[i].tmpl);
    }
}

static void test_the_best_are_looked_at_again(void **state)
{
    (void)state;
    static struct sim_corpus_row crowd[PEOPLE + 1];
    static struct sim_sample seen[PEOPLE + 1];
    const struct sim_corpus many = {PEOPLE + 1, crowd};
    struct sim_acquisition all = {0, PEOPLE + 1, NULL, seen, {7, "astra"}};
    fill_crowd(crowd, seen);
    struct sim_gallery *gallery = NULL;
    struct sim_matches *plain = NULL, *fused = NULL;
    struct iso_metric *metric = new_metric();
    struct sim_scoring scoring = {.metric = metric, .match = iso_match_options_default()};
    assert_int_equal(sim_gallery_new(&many, &all, 0, &gallery), 0);
    assert_int_equal(sim_match(&many, &all, gallery, &scoring, 1, &plain), 0);
    scoring.rerank = true;
    assert_int_equal(sim_match(&many, &all, gallery, &scoring, 1, &fused), 0);
    assert_int_equal(plain->n_probes, 1);
    double least = INFINITY;
    int again = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t p = 0; p < PEOPLE; p++) {
            int better = 0;
            for (size_t q = 0; q < PEOPLE; q++) {
                better += plain->score[q] > plain->score[p];
            }
            if (better < ISO_RERANK_CANDIDATES && pass == 0) {
                const struct iso_upper_face *own = &seen[p].tmpl.upper;
                assert_float_equal(fused->score[p],
                                   iso_rerank(&work, metric, &seen[PEOPLE].tmpl.upper, &own, 1, 0,
                                              plain->score[p]),
                                   0.0);
                least = fmin(least, fused->score[p]);
                again++;
            } else if (better >= ISO_RERANK_CANDIDATES && pass == 1) {
                assert_float_equal(fused->score[p], fmin(plain->score[p], least), 0.0);
            }
        }
    }
    assert_int_equal(again, ISO_RERANK_CANDIDATES);
    sim_matches_free(plain);
    sim_matches_free(fused);
    sim_gallery_free(gallery);
    iso_metric_free(metric);
}

static int mark(void *context, int worker, size_t job)
{
    int *marks = context;
    assert_in_range((uintmax_t)worker, 0, 2);
    marks[job]++;
    return 0;
}

static int refuse_seventh(void *context, int worker, size_t job)
{
    (void)context;
    (void)worker;
    return job == 7 ? -EDOM : 0;
}

static void test_parallel(void **state)
{
    (void)state;
    int marks[50] = {0};
    assert_int_equal(sim_parallel(3, "test", 50, mark, marks), 0);
    for (int i = 0; i < 50; i++) {
        assert_int_equal(marks[i], 1);
    }
    assert_int_equal(sim_parallel(2, "test", 0, mark, marks), 0);
    assert_int_equal(sim_parallel(2, "test", 50, refuse_seventh, NULL), -EDOM);
    assert_int_equal(sim_parallel(0, "test", 50, mark, marks), -EINVAL);
    assert_int_equal(sim_parallel(65, "test", 50, mark, marks), -EINVAL);
}

static void the_first_score_that_is_no_number_is_found(void **state)
{
    double score[] = {1.0, -INFINITY, 2.0, NAN}, stranger_score[] = {1.0, 2.0, NAN, 3.0};
    struct sim_matches matches = {.n_probes = 2, .n_people = 2, .score = score};
    size_t probe = 9, person = 9;
    (void)state;
    assert_true(sim_matches_find_nan(&matches, &probe, &person));
    assert_true(probe == 1 && person == 1);
    matches.stranger_score = stranger_score;
    assert_true(sim_matches_find_nan(&matches, &probe, &person));
    assert_true(probe == 1 && person == 0);
    score[3] = stranger_score[2] = INFINITY;
    assert_false(sim_matches_find_nan(&matches, &probe, &person));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_gallery, setup),
        cmocka_unit_test_setup(test_gallery_limit, setup),
        cmocka_unit_test_setup(test_best_template_counts, setup),
        cmocka_unit_test_setup(test_threads_do_not_matter, setup),
        cmocka_unit_test_setup(test_missing_points, setup),
        cmocka_unit_test_setup(test_cohort_normalises, setup),
        cmocka_unit_test(test_the_best_are_looked_at_again),
        cmocka_unit_test(test_parallel),
        cmocka_unit_test(the_first_score_that_is_no_number_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
