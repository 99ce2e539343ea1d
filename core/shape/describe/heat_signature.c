#include "isotherm/signature.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/describe/heat_courses.h"

enum { TIMES_AT_ONCE = 20 };

static void fill_decay(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *decay)
{
    for (int32_t i = first; i < pairs->k; i++) {
        for (int j = 0; j < n_times; j++) {
            *decay++ = exp(-pairs->lambda[i] * t[j]);
        }
    }
}

int iso_heat_courses_init(struct iso_heat_courses *courses, const struct iso_eigenpairs *pairs,
                          int32_t vertex, int32_t first, const double *t, int n_times)
{
    const size_t k = (size_t)(pairs->k > first ? pairs->k - first : 0);
    *courses = (struct iso_heat_courses){
        .pairs = pairs, .vertex = vertex, .first = first, .n_times = n_times, .t = t};
    courses->decay = malloc((k * (size_t)n_times + 1) * sizeof *courses->decay);
    courses->factor = malloc((k * ISO_HEAT_ROWS + 1) * sizeof *courses->factor);
    if (!courses->decay || !courses->factor) {
        return -ENOMEM;
    }
    fill_decay(pairs, first, t, n_times, courses->decay);
    return 0;
}

/* How many pairs matter at times from `t` on: the others have decayed to less than 2e-22 of the
 * first one's exp(-lambda t), which is far below rounding wherever the first ones do not vanish. */
static int pairs_left(const struct iso_heat_courses *courses, double t)
{
    const struct iso_eigenpairs *pairs = courses->pairs;
    int32_t end = pairs->k;
    while (end > courses->first + 1 &&
           (pairs->lambda[end - 1] - pairs->lambda[courses->first]) * t > 50.0) {
        end--;
    }
    return end > courses->first ? end - courses->first : 0;
}

void iso_heat_courses_at(const struct iso_heat_courses *courses, int32_t from, int32_t rows,
                         double *out)
{
    const struct iso_eigenpairs *pairs = courses->pairs;
    const int32_t vertex = courses->vertex;
    const size_t k = (size_t)(pairs->k > courses->first ? pairs->k - courses->first : 0);
    for (size_t i = 0; i < k; i++) {
        const double *phi = &pairs->phi[(i + (size_t)courses->first) * (size_t)pairs->n];
        double *factor = &courses->factor[i * ISO_HEAT_ROWS];
        for (int32_t r = 0; r < rows; r++) {
            factor[r] = phi[from + r] * phi[vertex < 0 ? from + r : vertex];
        }
    }
    for (int j = 0; j < courses->n_times; j += TIMES_AT_ONCE) {
        const int left = courses->n_times - j, times = left < TIMES_AT_ONCE ? left : TIMES_AT_ONCE;
        double first_t = courses->t[j];
        for (int i = 1; i < times; i++) {
            first_t = fmin(first_t, courses->t[j + i]);
        }
        cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, rows, times,
                    pairs_left(courses, first_t), 1.0, courses->factor, ISO_HEAT_ROWS,
                    &courses->decay[j], courses->n_times, 0.0, &out[j], courses->n_times);
    }
}

void iso_heat_courses_done(struct iso_heat_courses *courses)
{
    free(courses->decay);
    free(courses->factor);
    *courses = (struct iso_heat_courses){0};
}

static int all_courses(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                       const double *t, int n_times, double *out)
{
    struct iso_heat_courses courses;
    const int error = iso_heat_courses_init(&courses, pairs, vertex, first, t, n_times);
    for (int32_t from = 0; !error && from < pairs->n; from += ISO_HEAT_ROWS) {
        iso_heat_courses_at(&courses, from, iso_heat_rows_from(from, pairs->n),
                            &out[(size_t)from * (size_t)n_times]);
    }
    iso_heat_courses_done(&courses);
    return error;
}

int iso_heat_signature(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *out)
{
    return all_courses(pairs, ISO_HEAT_OWN, first, t, n_times, out);
}

int iso_heat_from_vertex(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                         const double *t, int n_times, double *out)
{
    return all_courses(pairs, vertex, first, t, n_times, out);
}

/* sum_j K(i, j, t) = sum_k exp(-lambda_k t) phi_k(i) sum_j phi_k(j), without the heat that stays at
 * i. */
int iso_heat_mean_signature(const struct iso_eigenpairs *pairs, double t, double *out)
{
    const int error = iso_heat_signature(pairs, 0, &t, 1, out);
    if (error) {
        return error;
    }
    for (int32_t v = 0; v < pairs->n; v++) {
        out[v] = -out[v];
    }
    for (int32_t i = 0; i < pairs->k; i++) {
        const double *phi = &pairs->phi[(size_t)i * (size_t)pairs->n];
        double sum = 0.0;
        for (int32_t v = 0; v < pairs->n; v++) {
            sum += phi[v];
        }
        cblas_daxpy(pairs->n, exp(-pairs->lambda[i] * t) * sum, phi, 1, out, 1);
    }
    cblas_dscal(pairs->n, 1.0 / pairs->n, out, 1);
    return 0;
}

void iso_heat_times(double t_first, double t_last, int n, double *t)
{
    for (int j = 0; j < n; j++) {
        const double share = n > 1 ? (double)j / (n - 1) : 0.0;
        t[j] = t_first * pow(t_last / t_first, share);
    }
}

void iso_heat_times_alpha(double unit, double alpha, double tau_first, double tau_step, int n,
                          double *t)
{
    for (int j = 0; j < n; j++) {
        t[j] = unit * pow(alpha, tau_first + tau_step * j);
    }
}
