/* The score of a person of the site without the own share of the offset, compared with the formula
 * for matrices of three rows. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

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

/* Everybody's offset, without this person's share, is a direction of variance. */
static void a_person_is_scored_without_the_own_offset(void **state)
{
    (void)state;
    struct iso_metric *metric = small_metric();
    struct iso_site *statistics = NULL;
    struct iso_metric_vector captures[PEOPLE];
    struct iso_site_metric site;
    const struct iso_template tmpl = small_template(metric, 0.3);
    struct iso_metric_vector shipped, probe, person;
    double within[3][3], others[3];
    assert_int_equal(iso_site_new(metric, &statistics), 0);
    for (int p = 0; p < PEOPLE; p++) {
        captures[p] = (struct iso_metric_vector){.n = 1};
        for (int d = 0; d < DIMENSIONS; d++) {
            captures[p].mean[d] = (float)(1.0 + 2.0 * sin(5.0 * p + 2.0 * d));
        }
        assert_int_equal(iso_site_add(statistics, &captures[p], 1), 0);
    }
    assert_int_equal(iso_site_adapt(statistics, metric, &site), 0);
    assert_int_equal(site.people, PEOPLE);
    assert_int_equal(iso_metric_project(metric, &tmpl, &shipped), 0);
    shipped.mean[0] += 3.0f;
    iso_site_turn(&site, &shipped, &probe);
    iso_site_turn(&site, &captures[0], &person);
    for (int d = 0; d < 3; d++) {
        others[d] = ((PEOPLE + 1) * (double)site.offset[d] - (double)person.mean[d]) / PEOPLE;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            within[i][j] = (i == j ? 1.0 : 0.0) + others[i] * others[j] -
                           (double)site.offset[i] * (double)site.offset[j];
        }
    }
    assert_near(iso_site_score(&site, &person, &probe),
                score_by_definition(&site, within, &person, &probe), 1e-9);
    assert_true(fabs(iso_site_score(&site, &person, &probe) -
                     iso_metric_score(site.metric, &person, &probe)) > 1e-3);
    person.n = 0;
    assert_true(isinf(iso_site_score(&site, &person, &probe)));
    iso_site_metric_free(&site);
    iso_site_free(statistics);
    iso_metric_free(metric);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_is_scored_without_the_own_offset),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
