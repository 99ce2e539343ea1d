/* The tests of the reranking. They test how a fused score is computed, which templates of a person
 * are registered, and how a search reranks its candidates. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/rerank.h"
#include "core/match/search.h"
#include "tests/core/match/formula_face.h"

/* The working memory of the functions under test. */
static struct iso_rerank_workspace work;

/* Makes a metric of one landmark and two dimensions. By this metric, all templates of this file
 * have nearly the same score. */
static struct iso_metric *new_metric(void)
{
    const struct iso_metric shape = {
        .algorithm = 77,
        .landmarks = 1,
        .n_radii = 1,
        .n_points = 4,
        .n_dimensions = 2,
        .weight_min = 0.3f,
        .gain = 1.0f,
        .rerank = {.metric = 0.5f, .upper = 2.0f, .bias = 0.25f},
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    for (int v = 0; v < m->n_values; v++) {
        m->curve_mm[v] = 20.0f * (float)sin(1.7 * v);
        m->axis[2 * v] = (float)cos(0.3 * v);
        m->axis[2 * v + 1] = (float)cos(0.7 * v);
    }
    m->between[0] = 4.0f;
    m->between[1] = 2.0f;
    m->centre[0] = 2.0f; /* all are about as far from the average, in one direction */
    m->centre[1] = -1.0f;
    return m;
}

static struct iso_template template_of(const struct iso_metric *m, int who, float off_mm)
{
    struct iso_template t = {.algorithm = 77, .n_radii = 1, .n_points = 4, .n_frames = 1};
    for (int i = 0; i < 4; i++) {
        memcpy(t.points_mm[0][0][i], &m->curve_mm[3 * i], sizeof t.points_mm[0][0][i]);
        t.points_mm[0][0][i][2] += off_mm * (float)(i % 2);
        t.weight[0][0][i] = 1.0f;
    }
    t.upper = formula_face(who);
    return t;
}

static void a_fused_score_is_the_weighted_sum(void **state)
{
    (void)state;
    struct iso_metric *m = new_metric();
    const struct iso_rigid motion = formula_face_motion(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    struct iso_upper_face probe = formula_face(2);
    const struct iso_upper_face other = formula_face(3), own = formula_face_moved(2, &motion);
    const struct iso_upper_face *person[] = {&other, &own};
    double other_mm, own_mm, both_mm;
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[0], 1, 0, &other_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[1], 1, 0, &own_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 2, 0, &both_mm), 0);
    assert_true(own_mm < other_mm && both_mm == own_mm);
    const double score = iso_rerank(&work, m, &probe, person, 2, 0, 3.0);
    assert_true(fabs(score - (0.5 * 3.0 - 2.0 * log(own_mm) + 0.25)) < 1e-9);
    /* The misfit of a surface with itself is the smallest one, ISO_RERANK_RMS_MIN_MM. */
    assert_int_equal(
        iso_rerank_misfit(&work, &probe, (const struct iso_upper_face *[]){&probe}, 1, 0, &own_mm),
        0);
    assert_true(own_mm == ISO_RERANK_RMS_MIN_MM);
    /* If there is no surface to compare, or if the weights are 0, the score stays the same. */
    assert_true(iso_rerank(&work, m, &probe, person, 0, 0, 3.0) == 3.0);
    memset(&probe, 0, sizeof probe);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 2, 0, &own_mm), -ENODATA);
    assert_true(iso_rerank(&work, m, &probe, person, 2, 0, 3.0) == 3.0);
    m->rerank = (struct iso_rerank_weights){0.0f, 0.0f, 0.0f};
    probe = formula_face(2);
    assert_true(iso_rerank(&work, m, &probe, person, 2, 0, 3.0) == 3.0);
    iso_metric_free(m);
}

/* Of several templates the misfit is that of the likeliest ones, wherever they stand. */
static void the_likeliest_templates_are_registered(void **state)
{
    (void)state;
    enum { TEMPLATES = 5 };
    const struct iso_rigid motion = formula_face_motion(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    const struct iso_upper_face probe = formula_face(2), own = formula_face_moved(2, &motion),
                                none = {0};
    struct iso_upper_face others[TEMPLATES];
    double own_mm, found_mm;
    assert_int_equal(
        iso_rerank_misfit(&work, &probe, (const struct iso_upper_face *[]){&own}, 1, 0, &own_mm),
        0);
    for (int place = 0; place < TEMPLATES; place++) {
        const struct iso_upper_face *person[TEMPLATES];
        for (int i = 0; i < TEMPLATES; i++) {
            others[i] = i % 2 ? none : formula_face(3 + i);
            person[i] = i == place ? &own : &others[i];
        }
        assert_int_equal(iso_rerank_misfit(&work, &probe, person, TEMPLATES, 0, &found_mm), 0);
        assert_true(found_mm == own_mm);
    }
    const struct iso_upper_face *nothing[] = {&none, &none, &none};
    assert_int_equal(iso_rerank_misfit(&work, &probe, nothing, 3, 0, &found_mm), -ENODATA);
}

/* One template is registered for a person whom the metric finds further back, two for the others.
 * The rough comparison prefers `other`; only registration shows that `own` is the same face. */
static void fewer_templates_are_registered_further_back(void **state)
{
    (void)state;
    const struct iso_rigid motion = formula_face_motion(0.06, 0.06, 0.0, 3.0, 3.0, 0.0);
    const struct iso_upper_face probe = formula_face(2), own = formula_face_moved(2, &motion);
    const struct iso_upper_face other = formula_face(3);
    const struct iso_upper_face *person[] = {&own, &other};
    double own_mm, other_mm, found_mm;
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[0], 1, 0, &own_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[1], 1, 0, &other_mm), 0);
    assert_true(own_mm < other_mm);
    for (int place = 0; place < ISO_RERANK_CANDIDATES; place++) {
        const double expected_mm = place < ISO_RERANK_FIRST ? own_mm : other_mm;
        assert_int_equal(iso_rerank_misfit(&work, &probe, person, 2, place, &found_mm), 0);
        assert_true(found_mm == expected_mm);
    }
}

/* A strip in the middle of the face, which resembles the whole but has too few points. */
static struct iso_upper_face strip_of(struct iso_upper_face face)
{
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        memset(face.kind[v], ISO_UPPER_NONE, ISO_UPPER_MIDDLE - 5);
        memset(&face.kind[v][ISO_UPPER_MIDDLE + 6], ISO_UPPER_NONE, ISO_UPPER_MIDDLE - 5);
    }
    return face;
}

/* If the likeliest templates cannot be registered, others are. */
static void templates_that_cannot_be_registered_are_replaced(void **state)
{
    (void)state;
    const struct iso_rigid motion = formula_face_motion(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    const struct iso_upper_face probe = formula_face(2), own = formula_face_moved(2, &motion);
    const struct iso_upper_face other = formula_face(3), strip = strip_of(probe);
    const struct iso_upper_face *person[] = {&strip, &other, &strip, &own, &other};
    double own_mm, found_mm;
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[3], 1, 0, &own_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 5, 0, &found_mm), 0);
    assert_true(found_mm == own_mm);
}

/* Twelve people whom the metric distinguishes only a little, and in the wrong order. */
static void a_search_looks_again_at_the_best(void **state)
{
    (void)state;
    enum { PEOPLE = 12 };
    struct iso_metric *m = new_metric();
    static struct iso_template enrolled[PEOPLE];
    struct iso_search_entry entries[PEOPLE];
    const struct iso_template probe = template_of(m, 4, 0.0f);
    for (int i = 0; i < PEOPLE; i++) {
        enrolled[i] = template_of(m, i, 0.02f * (float)i);
        entries[i] = (struct iso_search_entry){100 + i, &enrolled[i]};
    }
    struct iso_search_hit hits[PEOPLE];
    struct iso_metric plain = *m;
    plain.rerank = (struct iso_rerank_weights){0.0f, 0.0f, 0.0f};
    int n = 0;
    assert_int_equal(iso_search_by_metric(&work, entries, PEOPLE, &probe, &plain, hits, PEOPLE, &n),
                     0);
    assert_int_equal(n, ISO_RERANK_CANDIDATES);
    assert_true(hits[0].person != 104);
    int64_t left_out = 0;
    for (int i = 0; i < PEOPLE; i++) {
        bool there = false;
        for (int k = 0; k < n; k++) {
            there = there || hits[k].person == 100 + i;
        }
        left_out = there ? left_out : 100 + i;
    }
    assert_int_equal(iso_search_by_metric(&work, entries, PEOPLE, &probe, m, hits, 2, &n), 0);
    assert_int_equal(n, 2);
    assert_int_equal(hits[0].person, 104);
    assert_true(hits[0].score > hits[1].score && hits[1].person != left_out);
    iso_metric_free(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fused_score_is_the_weighted_sum),
        cmocka_unit_test(the_likeliest_templates_are_registered),
        cmocka_unit_test(fewer_templates_are_registered_further_back),
        cmocka_unit_test(templates_that_cannot_be_registered_are_replaced),
        cmocka_unit_test(a_search_looks_again_at_the_best),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
