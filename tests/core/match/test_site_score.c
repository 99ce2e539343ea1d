/* The score of a person of the site leaves out the person's own share in the offset, and it is the
 * least of the scores that also leave out one of four groups of people. The test compares it with
 * the formula for whole matrices, which have three rows here. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/site.h"
#include "tests/core/match/small_metric.h"
#include "tests/support/near.h"

enum { PEOPLE = 5 };

static double invert(const double m[3][3], double out[3][3])
{
    double determinant = 0.0;
    for (int i = 0; i < 3; i++) {
        determinant += m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] -
                                  m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / determinant;
        }
    }
    return determinant;
}

static double unlikeliness(const double m[3][3], const double *x)
{
    double inverse[3][3];
    double sum = log(invert(m, inverse));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            sum += x[i] * inverse[i][j] * x[j];
        }
    }
    return sum;
}

/* B inv(B + w W) for a column of W, [3][3]. */
static void shrink_of(const double w_matrix[3][3], const float *b, double w, double out[3][3])
{
    double sum[3][3], inverse[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            sum[i][j] = w * w_matrix[i][j] + (i == j ? (double)b[i] : 0.0);
        }
    }
    (void)invert(sum, inverse);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out[i][j] = (double)b[i] * inverse[i][j];
        }
    }
}

/* The score by the definition (iso_metric_score) for a covariance W within a person. */
static double score_by_definition(const struct iso_site_metric *site, const double within[3][3],
                                  const struct iso_metric_vector *person,
                                  const struct iso_metric_vector *probe)
{
    const float *b = site->metric->between;
    const double own = iso_metric_variance(probe->step), w = iso_metric_variance(person->step);
    double shrink[3][3], any[3][3], same[3][3], x[3], off[3];
    shrink_of(within, b, w, shrink);
    for (int i = 0; i < 3; i++) {
        x[i] = (double)(probe->scale * probe->mean[i]);
        off[i] = x[i];
        for (int j = 0; j < 3; j++) {
            off[i] -= shrink[i][j] * (double)(person->scale * person->mean[j]);
            any[i][j] = own * within[i][j] + (i == j ? (double)b[i] : 0.0);
            same[i][j] = any[i][j] - shrink[i][j] * (double)b[j];
        }
    }
    const double ratio = unlikeliness(any, x) - unlikeliness(same, off);
    return 0.5 * (double)site->metric->gain * ratio + (double)site->metric->bias;
}

/* The score without the shares of the people whose bits are set. */
static double score_without(const struct iso_site_metric *site, unsigned left_out,
                            const struct iso_metric_vector *person,
                            const struct iso_metric_vector *probe)
{
    double within[3][3], others[3];
    for (int d = 0; d < 3; d++) {
        double sum = (PEOPLE + 1) * (double)site->offset[d], people = PEOPLE + 1;
        for (int p = 0; p < PEOPLE; p++) {
            if (left_out & 1U << p) {
                sum -= (double)site->own[3 * p + d];
                people -= 1.0;
            }
        }
        others[d] = sum / people;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            within[i][j] = (i == j ? 1.0 : 0.0) + others[i] * others[j] -
                           (double)site->offset[i] * (double)site->offset[j];
        }
    }
    return score_by_definition(site, within, person, probe);
}

/* The least score without `own`, which may be 0, and without one of four groups of people. */
static double least_score(const struct iso_site_metric *site, unsigned own,
                          const struct iso_metric_vector *person,
                          const struct iso_metric_vector *probe)
{
    double least = INFINITY;
    static const unsigned groups[] = {1, 2, 4, 8 + 16};
    for (int g = 0; g < 4; g++) {
        least = fmin(least, score_without(site, own | groups[g], person, probe));
    }
    return least;
}

/* A site of people with one template each. */
static struct iso_site_metric adapt_to(const struct iso_metric *metric,
                                       const struct iso_metric_vector *captures)
{
    struct iso_site *statistics = NULL;
    struct iso_site_metric site;
    assert_int_equal(iso_site_new(metric, &statistics), 0);
    for (int p = 0; p < PEOPLE; p++) {
        assert_int_equal(iso_site_add(statistics, 10 * p, &captures[p], 1), 0);
    }
    assert_int_equal(iso_site_find_directions(statistics), 0);
    for (int p = 0; p < PEOPLE; p++) {
        assert_int_equal(iso_site_review(statistics, &captures[p], 1), 0);
    }
    assert_int_equal(iso_site_adapt(statistics, metric, &site), 0);
    assert_int_equal(site.people, PEOPLE);
    iso_site_free(statistics);
    return site;
}

/* Forgets the share of person 20. The others keep theirs, and nothing is left of it. */
static void a_share_can_be_forgotten(struct iso_site_metric *site)
{
    static const float nothing[DIMENSIONS];
    float before[PEOPLE][DIMENSIONS];
    memcpy(before, site->own, sizeof before);
    iso_site_metric_forget(site, 5); /* nobody */
    assert_int_equal(site->n_own, PEOPLE);
    iso_site_metric_forget(site, 20);
    assert_int_equal(site->n_own, PEOPLE - 1);
    assert_int_equal(site->number[2], 30);
    assert_int_equal(site->number[PEOPLE - 1], 0);
    assert_memory_equal(&site->own[DIMENSIONS], before[1], sizeof before[1]);
    assert_memory_equal(&site->own[2 * DIMENSIONS], before[3], sizeof before[3]);
    assert_memory_equal(&site->own[(PEOPLE - 1) * DIMENSIONS], nothing, sizeof nothing);
}

/* The offset without these shares is a direction of variance. */
static void a_person_is_scored_without_shares_of_the_offset(void **state)
{
    (void)state;
    struct iso_metric *metric = small_metric();
    struct iso_metric_vector captures[PEOPLE];
    const struct iso_template tmpl = small_template(metric, 0.3);
    struct iso_metric_vector shipped, probe, person;
    for (int p = 0; p < PEOPLE; p++) {
        captures[p] = (struct iso_metric_vector){.n = 1};
        for (int d = 0; d < DIMENSIONS; d++) {
            captures[p].mean[d] = (float)(1.0 + 2.0 * sin(5.0 * p + 2.0 * d));
        }
    }
    struct iso_site_metric site = adapt_to(metric, captures);
    assert_int_equal(iso_metric_project(metric, &tmpl, &shipped), 0);
    shipped.mean[0] += 3.0f;
    iso_site_turn(&site, &shipped, &probe);
    int lower = 0; /* people whose score is lower than without their own share alone */
    for (int p = 0; p < PEOPLE; p++) {
        iso_site_turn(&site, &captures[p], &person);
        const double score = iso_site_score(&site, 10 * p, &person, &probe);
        assert_near(score, least_score(&site, 1U << p, &person, &probe), 1e-9);
        lower += score < score_without(&site, 1U << p, &person, &probe) - 1e-3;
        assert_true(fabs(score - iso_metric_score(site.metric, &person, &probe)) > 1e-3);
        /* Nobody of this site has the number 5. */
        assert_near(iso_site_score(&site, 5, &person, &probe),
                    least_score(&site, 0, &person, &probe), 1e-9);
    }
    assert_true(lower > 0);
    probe.mean[1] = NAN;
    assert_true(iso_site_score(&site, 0, &person, &probe) == -INFINITY);
    a_share_can_be_forgotten(&site);
    person.n = 0;
    assert_true(isinf(iso_site_score(&site, 0, &person, &probe)));
    iso_site_metric_free(&site);
    iso_metric_free(metric);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_is_scored_without_shares_of_the_offset),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
