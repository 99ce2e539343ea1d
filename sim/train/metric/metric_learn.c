#include "sim/train/metric/metric_learn.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "sim/train/principal.h"

enum { SPARE = 10 /* directions beyond those kept */, ITERATIONS = 12 };

/* Subtracts the mean from rows[n][width] and stores it in mean[width]. */
static void centre_rows(const struct sim_metric_samples *s, size_t width, float *rows, double *mean)
{
    memset(mean, 0, width * sizeof *mean);
    for (size_t i = 0; i < s->n * width; i++) {
        mean[i % width] += (double)s->residual_mm[i] / (double)s->n;
    }
    for (size_t i = 0; i < s->n * width; i++) {
        rows[i] = s->residual_mm[i] - (float)mean[i % width];
    }
}

/* next = (rows' rows) basis, both [width][k]. Both products are computed one row at a time. */
static void apply_covariance(const float *rows, size_t n, size_t width, size_t k,
                             const float *basis, float *next)
{
    memset(next, 0, width * k * sizeof *next);
    for (size_t i = 0; i < n; i++) {
        sim_progress_step(1);
        const float *row = &rows[i * width];
        float y[ISO_METRIC_DIMENSIONS_MAX + SPARE] = {0};
        for (size_t v = 0; v < width; v++) {
            for (size_t d = 0; d < k; d++) {
                y[d] += row[v] * basis[v * k + d];
            }
        }
        for (size_t v = 0; v < width; v++) {
            for (size_t d = 0; d < k; d++) {
                next[v * k + d] += row[v] * y[d];
            }
        }
    }
}

/* Makes the k columns orthonormal, in order (modified Gram-Schmidt, twice). */
static void orthonormalise_columns(float *basis, size_t width, size_t k)
{
    for (size_t d = 0; d < 2 * k; d++) {
        const size_t at = d / 2; /* each column twice, against all previous columns */
        for (size_t e = 0; e < at; e++) {
            double dot = 0.0;
            for (size_t v = 0; v < width; v++) {
                dot += (double)basis[v * k + at] * (double)basis[v * k + e];
            }
            for (size_t v = 0; v < width; v++) {
                basis[v * k + at] -= (float)dot * basis[v * k + e];
            }
        }
        double square = 0.0;
        for (size_t v = 0; v < width; v++) {
            square += (double)basis[v * k + at] * (double)basis[v * k + at];
        }
        const float scale = (float)(1.0 / sqrt(fmax(square, 1e-30)));
        for (size_t v = 0; v < width; v++) {
            basis[v * k + at] *= scale;
        }
    }
}

/* y[n][k] = rows basis */
static void project_rows(const float *rows, size_t n, size_t width, size_t k, const float *basis,
                         double *y)
{
    memset(y, 0, n * k * sizeof *y);
    for (size_t i = 0; i < n; i++) {
        for (size_t v = 0; v < width; v++) {
            const double x = (double)rows[i * width + v];
            for (size_t d = 0; d < k; d++) {
                y[i * k + d] += x * (double)basis[v * k + d];
            }
        }
    }
}

/* a[k][k] += scale * x x' */
static void add_square(double *a, size_t k, const double *x, double scale)
{
    for (size_t i = 0; i < k; i++) {
        for (size_t j = 0; j < k; j++) {
            a[i * k + j] += scale * x[i] * x[j];
        }
    }
}

/* Rotates the basis [width][k] to the k_kept directions of largest variance, [width][k_kept]. `y`
 * holds the n rows in the old basis. *variance is the sum over the directions kept. */
static int rotate_to_principal(const double *y, size_t n, size_t width, size_t k, size_t k_kept,
                               float *basis, double *variance)
{
    double *moment = calloc(k * k, sizeof *moment), *vector = calloc(k * k, sizeof *vector);
    double value[ISO_METRIC_DIMENSIONS_MAX + SPARE];
    if (!moment || !vector) {
        free(moment);
        free(vector);
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        add_square(moment, k, &y[i * k], 1.0 / (double)n);
    }
    sim_symmetric_eigen(moment, (uint32_t)k, value, vector);
    *variance = 0.0;
    for (size_t d = 0; d < k_kept; d++) {
        *variance += value[d];
    }
    for (size_t v = 0; v < width; v++) {
        double row[ISO_METRIC_DIMENSIONS_MAX + SPARE];
        for (size_t d = 0; d < k_kept; d++) {
            row[d] = 0.0;
            for (size_t e = 0; e < k; e++) {
                row[d] += (double)basis[v * k + e] * vector[d * k + e];
            }
        }
        for (size_t d = 0; d < k_kept; d++) {
            basis[v * k_kept + d] = (float)
                row[d]; /* does not reach the values that are still to be read */
        }
    }
    free(moment);
    free(vector);
    return 0;
}

/* Finds the principal directions basis[width][k_kept]; `basis` has room for SPARE more. */
static int find_principal(const float *rows, size_t n, size_t width, size_t k_kept, float *basis,
                          double *explained)
{
    const size_t k = k_kept + SPARE < width ? k_kept + SPARE : width;
    float *next = calloc(width * k, sizeof *next);
    double *y = calloc(n * k, sizeof *y);
    int error = next && y ? 0 : -ENOMEM;
    struct sim_random random = sim_random_seeded(1, sim_random_hash("metric"), 0);
    for (size_t i = 0; !error && i < width * k; i++) {
        basis[i] = (float)sim_random_normal(&random);
    }
    const bool shown = sim_progress_begin("finding the principal directions", ITERATIONS * n);
    for (int i = 0; !error && i < ITERATIONS; i++) {
        apply_covariance(rows, n, width, k, basis, next);
        orthonormalise_columns(next, width, k);
        memcpy(basis, next, width * k * sizeof *basis);
    }
    sim_progress_end(shown);
    double kept = 0.0, all = 0.0;
    if (!error) {
        project_rows(rows, n, width, k, basis, y);
        error = rotate_to_principal(y, n, width, k, k_kept, basis, &kept);
    }
    for (size_t i = 0; i < n * width; i++) {
        all += (double)rows[i] * (double)rows[i] / (double)n;
    }
    if (!error && explained) {
        *explained = kept / all;
    }
    free(next);
    free(y);
    return error;
}

/* Covariances within and between people, [k][k], by moments. With n_i samples of person i, the
 * spread of the means contains within / n_i. */
static int split_covariance(const struct sim_metric_samples *s, const double *y, size_t k,
                            double *within, double *between)
{
    double *mean = calloc(s->n_people * k, sizeof *mean);
    size_t *count = calloc(s->n_people, sizeof *count);
    if (!mean || !count) {
        free(mean);
        free(count);
        return -ENOMEM;
    }
    for (size_t i = 0; i < s->n; i++) {
        count[s->person[i]]++;
        for (size_t d = 0; d < k; d++) {
            mean[s->person[i] * k + d] += y[i * k + d];
        }
    }
    double inverse = 0.0;
    for (size_t p = 0; p < s->n_people; p++) {
        for (size_t d = 0; d < k; d++) {
            mean[p * k + d] /= (double)count[p];
        }
        inverse += 1.0 / (double)count[p] / (double)s->n_people;
        add_square(between, k, &mean[p * k], 1.0 / (double)s->n_people);
    }
    for (size_t i = 0; i < s->n; i++) {
        double off[ISO_METRIC_DIMENSIONS_MAX];
        for (size_t d = 0; d < k; d++) {
            off[d] = y[i * k + d] - mean[s->person[i] * k + d];
        }
        add_square(within, k, off, 1.0 / (double)(s->n - s->n_people));
    }
    for (size_t i = 0; i < k * k; i++) {
        between[i] -= inverse * within[i];
    }
    free(mean);
    free(count);
    return 0;
}

/* out = a' m a, all [k][k] row-major; column j of a is a direction. */
static void congruence_of(const double *m, const double *a, size_t k, double *half, double *out)
{
    for (size_t i = 0; i < k; i++) {
        for (size_t j = 0; j < k; j++) {
            half[i * k + j] = 0.0;
            for (size_t e = 0; e < k; e++) {
                half[i * k + j] += m[i * k + e] * a[e * k + j];
            }
        }
    }
    for (size_t i = 0; i < k; i++) {
        for (size_t j = 0; j < k; j++) {
            out[i * k + j] = 0.0;
            for (size_t e = 0; e < k; e++) {
                out[i * k + j] += a[e * k + i] * half[e * k + j];
            }
        }
    }
}

/* Finds the columns of `basis` [k][k] that make `within` the identity and `between` diagonal, with
 * `value` on its diagonal. Destroys `within`. */
static int diagonalise_scatter(double *within, const double *between, size_t k, double *basis,
                               double *value)
{
    double *work = calloc(4 * k * k, sizeof *work);
    if (!work) {
        return -ENOMEM;
    }
    double *vector = work, *white = work + k * k, *half = white + k * k, *turned = half + k * k;
    sim_symmetric_eigen(within, (uint32_t)k, value, vector);
    for (size_t e = 0; e < k; e++) {
        for (size_t d = 0; d < k; d++) {
            white[e * k + d] = vector[d * k + e] / sqrt(fmax(value[d], 1e-9));
        }
    }
    congruence_of(between, white, k, half, turned);
    sim_symmetric_eigen(turned, (uint32_t)k, value, vector);
    for (size_t e = 0; e < k; e++) {
        for (size_t d = 0; d < k; d++) {
            basis[e * k + d] = 0.0;
            for (size_t f = 0; f < k; f++) {
                basis[e * k + d] += white[e * k + f] * vector[d * k + f];
            }
        }
    }
    free(work);
    return 0;
}

static void write_axes(const float *principal, const double *basis, const double *value,
                       const double *mean, struct iso_metric *metric)
{
    const size_t k = (size_t)metric->n_dimensions;
    double centre[ISO_METRIC_DIMENSIONS_MAX] = {0};
    for (size_t v = 0; v < (size_t)metric->n_values; v++) {
        for (size_t d = 0; d < k; d++) {
            double a = 0.0;
            for (size_t e = 0; e < k; e++) {
                a += (double)principal[v * k + e] * basis[e * k + d];
            }
            metric->axis[v * k + d] = (float)a;
            centre[d] += mean[v] * a;
        }
    }
    for (size_t d = 0; d < k; d++) {
        metric->centre[d] = (float)centre[d];
        metric->between[d] = (float)fmax(value[d], 0.0);
    }
}

int sim_metric_learn(const struct sim_metric_samples *s, struct iso_metric *metric,
                     double *explained)
{
    const size_t width = (size_t)metric->n_values, k = (size_t)metric->n_dimensions;
    if (k > width) {
        return -EINVAL;
    }
    if (s->n_people < 2 * k || s->n < 2 * s->n_people) {
        return -ENODATA;
    }
    float *rows = calloc(s->n * width, sizeof *rows);
    float *principal = calloc(width * (k + SPARE), sizeof *principal);
    double *mean = calloc(width, sizeof *mean), *y = calloc(s->n * k, sizeof *y);
    double *square = calloc(3 * k * k, sizeof *square);
    double value[ISO_METRIC_DIMENSIONS_MAX];
    int error = rows && principal && mean && y && square ? 0 : -ENOMEM;
    if (!error) {
        centre_rows(s, width, rows, mean);
        error = find_principal(rows, s->n, width, k, principal, explained);
    }
    if (!error) {
        project_rows(rows, s->n, width, k, principal, y);
        error = split_covariance(s, y, k, square, square + k * k);
    }
    if (!error) {
        error = diagonalise_scatter(square, square + k * k, k, square + 2 * k * k, value);
    }
    if (!error) {
        write_axes(principal, square + 2 * k * k, value, mean, metric);
    }
    free(rows);
    free(principal);
    free(mean);
    free(y);
    free(square);
    return error;
}

static int by_falling(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

int sim_metric_calibrate(double *ratio, size_t n, float *gain, float *bias)
{
    enum { PER_DECADE = 8, TAIL_MIN = 10 };
    if (n < 1000 * TAIL_MIN) {
        return -ENODATA;
    }
    qsort(ratio, n, sizeof *ratio, by_falling);
    /* Least squares fit of -log10(rate) to the ratio that has this rate. */
    double sum[5] = {0.0};
    const int points = (int)floor(PER_DECADE * (log10((double)n / TAIL_MIN) - 2.0));
    for (int i = 0; i <= points; i++) {
        const double s = 2.0 + (double)i / PER_DECADE;
        const double x = ratio[(size_t)(pow(10.0, -s) * (double)n)];
        sum[0] += 1.0;
        sum[1] += x;
        sum[2] += s;
        sum[3] += x * x;
        sum[4] += x * s;
    }
    const double slope = (sum[0] * sum[4] - sum[1] * sum[2]) / (sum[0] * sum[3] - sum[1] * sum[1]);
    if (!(slope > 0.0) || !isfinite(slope)) {
        return -EDOM;
    }
    *gain = (float)slope;
    *bias = (float)((sum[2] - slope * sum[1]) / sum[0]);
    return 0;
}
