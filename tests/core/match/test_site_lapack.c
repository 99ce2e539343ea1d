/* Site statistics when the decompositions of LAPACKE fail: this program has its own ones, which do
 * nothing but return an error. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/base/lapack.h"
#include "core/match/site.h"
#include "tests/core/match/small_metric.h"

static lapack_int spread_result, metric_result;

lapack_int LAPACKE_dsyev(int layout, char jobz, char uplo, lapack_int n, double *a, lapack_int lda,
                         double *w)
{
    (void)layout, (void)jobz, (void)uplo, (void)n, (void)a, (void)lda;
    for (lapack_int i = 0; i < n; i++) {
        w[i] = 1.0;
    }
    return spread_result;
}

lapack_int LAPACKE_dsygv(int layout, lapack_int itype, char jobz, char uplo, lapack_int n,
                         double *a, lapack_int lda, double *b, lapack_int ldb, double *w)
{
    (void)layout, (void)itype, (void)jobz, (void)uplo, (void)n, (void)a, (void)lda, (void)b;
    (void)ldb, (void)w;
    return metric_result;
}

/* Two people with two captures each. */
static void pass_people(struct iso_site *site, bool second)
{
    for (int p = 0; p < 2; p++) {
        struct iso_metric_vector captures[2] = {{.n = 1}, {.n = 1}};
        for (int d = 0; d < DIMENSIONS; d++) {
            captures[0].mean[d] = (float)sin(7.0 * p + d);
            captures[1].mean[d] = (float)sin(7.0 * p + d + 0.5);
        }
        assert_int_equal(
            second ? iso_site_review(site, captures, 2) : iso_site_add(site, p, captures, 2), 0);
    }
}

static const struct {
    lapack_int result;
    int error;
} cases[] = {{LAPACK_WORK_MEMORY_ERROR, -ENOMEM},
             {LAPACK_TRANSPOSE_MEMORY_ERROR, -ENOMEM},
             {-5, -EDOM},
             {2, -EDOM}};

/* A lack of memory is not reported as bad numbers. The call may be repeated. */
static void the_directions_name_the_error(void **state)
{
    struct iso_metric *metric = small_metric();
    struct iso_site *site = NULL;
    (void)state;
    assert_int_equal(iso_site_new(metric, &site), 0);
    pass_people(site, false);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        spread_result = cases[i].result;
        assert_int_equal(iso_site_find_directions(site), cases[i].error);
    }
    spread_result = 0;
    assert_int_equal(iso_site_find_directions(site), 0);
    iso_site_free(site);
    iso_metric_free(metric);
}

static void the_adapted_metric_names_the_error(void **state)
{
    struct iso_metric *metric = small_metric();
    struct iso_site *site = NULL;
    (void)state;
    spread_result = 0;
    assert_int_equal(iso_site_new(metric, &site), 0);
    pass_people(site, false);
    assert_int_equal(iso_site_find_directions(site), 0);
    pass_people(site, true);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct iso_site_metric adapted;
        metric_result = cases[i].result;
        assert_int_equal(iso_site_adapt(site, metric, &adapted), cases[i].error);
        assert_null(adapted.metric);
    }
    iso_site_free(site);
    iso_metric_free(metric);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_directions_name_the_error),
        cmocka_unit_test(the_adapted_metric_names_the_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
