#include "sim/lab/methods/subspace.h"

#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Components below this share of the largest are rounding errors. */
static const double variance_min = 1e-9;

void sim_subspace_free(struct sim_subspace *subspace)
{
    if (subspace) {
        free(subspace->mean);
        free(subspace->basis);
        free(subspace);
    }
}

static int new_subspace(size_t n_in, size_t n_out, struct sim_subspace **out)
{
    struct sim_subspace *s = calloc(1, sizeof *s);
    if (!s) {
        return -ENOMEM;
    }
    s->n_in = n_in;
    s->n_out = n_out;
    s->mean = calloc(n_in, sizeof *s->mean);
    s->basis = calloc(n_in * n_out, sizeof *s->basis);
    if (!s->mean || !s->basis) {
        sim_subspace_free(s);
        return -ENOMEM;
    }
    *out = s;
    return 0;
}

/* Eigenvalues, rising, and vectors (row k of `a` belongs to value k) of a symmetric matrix, which
 * is overwritten. */
static int solve_eigen(double *a, size_t n, double *value)
{
    /* Column-major, so that eigenvector k is row k of the row-major array. */
    lapack_int info = LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'L', (lapack_int)n, a, (lapack_int)n,
                                     value);
    if (info == 0) {
        return 0;
    }
    return info > 0 ? -EDOM : -ENOMEM;
}

static void mean_of(const float *samples, size_t n, size_t n_in, float *mean)
{
    for (size_t i = 0; i < n_in; i++) {
        double sum = 0.0;
        for (size_t k = 0; k < n; k++) {
            sum += (double)samples[k * n_in + i];
        }
        mean[i] = (float)(sum / (double)n);
    }
}

/* Uses four partial sums, because gcc does not reorder a sum. */
static double dot_product(const float *a, const float *b, size_t n)
{
    double sum[4] = {0.0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        for (size_t k = 0; k < 4; k++) {
            sum[k] += (double)a[i + k] * (double)b[i + k];
        }
    }
    for (; i < n; i++) {
        sum[0] += (double)a[i] * (double)b[i];
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
}

/* gram[k][l] = <sample k - mean, sample l - mean>; `centred` is [n][n_in]. */
static void gram_of(const float *samples, size_t n, size_t n_in, const float *mean, float *centred,
                    double *gram)
{
    for (size_t k = 0; k < n; k++) {
        for (size_t i = 0; i < n_in; i++) {
            centred[k * n_in + i] = samples[k * n_in + i] - mean[i];
        }
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t l = 0; l <= k; l++) {
            gram[k * n + l] = gram[l * n + k] = dot_product(&centred[k * n_in], &centred[l * n_in],
                                                            n_in);
        }
    }
}

/* The number of rising eigenvalues, counted from the last, that hold the energy. */
static size_t count_components(const double *value, size_t n, double energy, size_t n_most)
{
    double total = 0.0, sum = 0.0;
    for (size_t k = 0; k < n; k++) {
        total += fmax(value[k], 0.0);
    }
    size_t count = 0;
    while (count < n && count < n_most && sum < energy * total &&
           value[n - 1 - count] > variance_min * value[n - 1]) {
        sum += value[n - 1 - count];
        count++;
    }
    return count;
}

/* Component k of unit variance: sum over samples of vector[k] centred sqrt(n - 1) / value. */
static void fill_basis(const double *vector, const double *value, const float *centred, size_t n,
                       struct sim_subspace *s)
{
    for (size_t k = 0; k < s->n_out; k++) {
        const double *v = &vector[(n - 1 - k) * n];
        const double scale = sqrt((double)n - 1.0) / value[n - 1 - k];
        float *basis = &s->basis[k * s->n_in];
        for (size_t m = 0; m < n; m++) {
            const float factor = (float)(scale * v[m]);
            for (size_t i = 0; i < s->n_in; i++) {
                basis[i] += factor * centred[m * s->n_in + i];
            }
        }
    }
}

int sim_subspace_principal(const float *samples, size_t n, size_t n_in, double energy,
                           size_t n_most, struct sim_subspace **out)
{
    if (n < 2 || n_in == 0 || !(energy > 0.0)) {
        return -EINVAL;
    }
    struct sim_subspace *s = NULL;
    double *gram = calloc(n * n, sizeof *gram), *value = calloc(n, sizeof *value);
    float *centred = calloc(n * n_in, sizeof *centred), *mean = calloc(n_in, sizeof *mean);
    int error = gram && value && centred && mean ? 0 : -ENOMEM;
    if (!error) {
        mean_of(samples, n, n_in, mean);
        gram_of(samples, n, n_in, mean, centred, gram);
        error = solve_eigen(gram, n, value);
    }
    if (!error) {
        const size_t n_out = value[n - 1] > 0.0 ? count_components(value, n, energy, n_most) : 0;
        error = n_out > 0 ? new_subspace(n_in, n_out, &s) : -EINVAL;
    }
    if (!error) {
        memcpy(s->mean, mean, n_in * sizeof *mean);
        fill_basis(gram, value, centred, n, s);
        *out = s;
    }
    free(gram);
    free(value);
    free(centred);
    free(mean);
    return error;
}

void sim_subspace_project(const struct sim_subspace *s, const float *sample, float *coordinate)
{
    for (size_t k = 0; k < s->n_out; k++) {
        const float *basis = &s->basis[k * s->n_in];
        double sum = 0.0;
        for (size_t i = 0; i < s->n_in; i++) {
            sum += (double)(basis[i] * (sample[i] - s->mean[i]));
        }
        coordinate[k] = (float)sum;
    }
}

/* Scatter of samples about their person's mean, and of these means about the mean of all, both
 * [d][d], divided by the number of samples. */
struct scatter {
    size_t d;
    double *within, *between;
    double *person_mean; /* [n_people][d] */
    size_t *count;       /* [n_people] */
};

static void scatter_done(struct scatter *s)
{
    free(s->within);
    free(s->between);
    free(s->person_mean);
    free(s->count);
}

static void add_outer(double *matrix, const double *x, size_t d, double weight)
{
    for (size_t i = 0; i < d; i++) {
        for (size_t j = 0; j < d; j++) {
            matrix[i * d + j] += weight * x[i] * x[j];
        }
    }
}

/* `samples` are centred. */
static void sum_scatter(const float *samples, const uint32_t *person, size_t n, uint32_t n_people,
                        double *difference, struct scatter *s)
{
    const size_t d = s->d;
    for (size_t k = 0; k < n; k++) {
        s->count[person[k]]++;
        for (size_t i = 0; i < d; i++) {
            s->person_mean[person[k] * d + i] += (double)samples[k * d + i];
        }
    }
    for (uint32_t p = 0; p < n_people; p++) {
        for (size_t i = 0; i < d && s->count[p] > 0; i++) {
            s->person_mean[p * d + i] /= (double)s->count[p];
        }
        add_outer(s->between, &s->person_mean[p * d], d, (double)s->count[p] / (double)n);
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t i = 0; i < d; i++) {
            difference[i] = (double)samples[k * d + i] - s->person_mean[person[k] * d + i];
        }
        add_outer(s->within, difference, d, 1.0 / (double)n);
    }
}

static int measure_scatter(const float *samples, const uint32_t *person, size_t n, size_t d,
                           uint32_t n_people, struct scatter *s)
{
    s->d = d;
    s->within = calloc(d * d, sizeof *s->within);
    s->between = calloc(d * d, sizeof *s->between);
    s->person_mean = calloc(n_people * d, sizeof *s->person_mean);
    s->count = calloc(n_people, sizeof *s->count);
    double *difference = calloc(d, sizeof *difference);
    const int error = s->within && s->between && s->person_mean && s->count && difference ? 0
                                                                                          : -ENOMEM;
    if (!error) {
        sum_scatter(samples, person, n, n_people, difference, s);
    }
    free(difference);
    return error;
}

static void shrink_matrix(double *matrix, size_t d, double shrinkage)
{
    double trace = 0.0;
    for (size_t i = 0; i < d; i++) {
        trace += matrix[i * d + i];
    }
    for (size_t i = 0; i < d * d; i++) {
        matrix[i] *= 1.0 - shrinkage;
    }
    for (size_t i = 0; i < d; i++) {
        matrix[i * d + i] += shrinkage * trace / (double)d;
    }
}

/* Finds direction[k][i], by falling ratio of between to within: the generalised eigenvectors of
 * between v = ratio within v, v' within v = 1. Overwrites the scatter. */
static int find_discriminant(struct scatter *s, size_t n_out, double *direction)
{
    const size_t d = s->d;
    double *ratio = calloc(d, sizeof *ratio);
    if (!ratio) {
        return -ENOMEM;
    }
    lapack_int info = LAPACKE_dsygvd(LAPACK_COL_MAJOR, 1, 'V', 'L', (lapack_int)d, s->between,
                                     (lapack_int)d, s->within, (lapack_int)d, ratio);
    free(ratio);
    if (info != 0) {
        return info > 0 ? -EDOM : -ENOMEM;
    }
    for (size_t k = 0; k < n_out; k++) {
        memcpy(&direction[k * d], &s->between[(d - 1 - k) * d], d * sizeof *direction);
    }
    return 0;
}

/* Converts directions in the coordinates of `inner` to a basis for the samples themselves. */
static int compose_subspace(const struct sim_subspace *inner, const double *direction, size_t n_out,
                            struct sim_subspace **out)
{
    struct sim_subspace *s = NULL;
    const int error = new_subspace(inner->n_in, n_out, &s);
    if (error) {
        return error;
    }
    memcpy(s->mean, inner->mean, inner->n_in * sizeof *s->mean);
    for (size_t k = 0; k < n_out; k++) {
        for (size_t j = 0; j < inner->n_out; j++) {
            const float factor = (float)direction[k * inner->n_out + j];
            for (size_t i = 0; i < inner->n_in; i++) {
                s->basis[k * s->n_in + i] += factor * inner->basis[j * inner->n_in + i];
            }
        }
    }
    *out = s;
    return 0;
}

static int check_people(const uint32_t *person, size_t n, uint32_t n_people)
{
    bool seen_twice = false;
    uint32_t people = 0;
    for (uint32_t p = 0; p < n_people; p++) {
        size_t count = 0;
        for (size_t k = 0; k < n; k++) {
            count += person[k] == p;
        }
        people += count > 0;
        seen_twice = seen_twice || count > 1;
    }
    return people >= 2 && seen_twice ? 0 : -EINVAL;
}

int sim_subspace_discriminant(const float *samples, const uint32_t *person, size_t n, size_t n_in,
                              uint32_t n_people, double energy, double shrinkage,
                              struct sim_subspace **out)
{
    struct sim_subspace *inner = NULL;
    struct scatter scatter = {0};
    float *inside = NULL;
    double *direction = NULL;
    int error = check_people(person, n, n_people);
    if (error) {
        return error;
    }
    error = sim_subspace_principal(samples, n, n_in, energy, n - n_people, &inner);
    if (error) {
        return error;
    }
    const size_t d = inner->n_out, n_out = d < n_people - 1 ? d : n_people - 1;
    inside = calloc(n * d, sizeof *inside);
    direction = calloc(n_out * d, sizeof *direction);
    error = inside && direction ? 0 : -ENOMEM;
    for (size_t k = 0; !error && k < n; k++) {
        sim_subspace_project(inner, &samples[k * n_in], &inside[k * d]);
    }
    if (!error) {
        error = measure_scatter(inside, person, n, d, n_people, &scatter);
    }
    if (!error) {
        shrink_matrix(scatter.within, d, shrinkage);
        error = find_discriminant(&scatter, n_out, direction);
    }
    if (!error) {
        error = compose_subspace(inner, direction, n_out, out);
    }
    scatter_done(&scatter);
    free(inside);
    free(direction);
    sim_subspace_free(inner);
    return error;
}

double sim_cosine_distance(const float *a, const float *b, size_t n)
{
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (size_t i = 0; i < n; i++) {
        ab += (double)(a[i] * b[i]);
        aa += (double)(a[i] * a[i]);
        bb += (double)(b[i] * b[i]);
    }
    return aa > 0.0 && bb > 0.0 ? 1.0 - ab / sqrt(aa * bb) : 1.0;
}
