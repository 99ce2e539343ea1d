#include "isotherm/correspondence.h"

#include <cblas.h>
#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 256 }; /* vertices whose nearest points are looked for at once */

static int valid_pairs(const struct iso_shape *from, const struct iso_shape *to, int32_t k)
{
    return k >= 1 && k <= from->pairs->k && k <= to->pairs->k ? 0 : -EINVAL;
}

/* ---- from functions ------------------------------------------------------------------------- */

/* Coefficients [k][n] of functions [n_vertices][n] in the first k eigenfunctions. Each function is
 * divided by its norm. */
static int project(const struct iso_shape *shape, int32_t k, const double *function, int n,
                   double *coefficient)
{
    const size_t vertices = (size_t)shape->mesh->n_vertices;
    double *one = malloc(2 * vertices * sizeof *one);
    if (!one) {
        return -ENOMEM;
    }
    double *heavy = one + vertices;
    for (int j = 0; j < n; j++) {
        for (size_t v = 0; v < vertices; v++) {
            one[v] = function[v * (size_t)n + (size_t)j];
        }
        iso_symmetric_multiply(shape->mass, one, heavy);
        const double square = cblas_ddot((int)vertices, one, 1, heavy, 1);
        const double scale = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
        for (int32_t i = 0; i < k; i++) {
            coefficient[(size_t)i * (size_t)n + (size_t)j] =
                scale *
                cblas_ddot((int)vertices, &shape->pairs->phi[(size_t)i * vertices], 1, heavy, 1);
        }
    }
    free(one);
    return 0;
}

/* The rows of C are independent, since the commutator weighs each entry by itself: (a a' + weight
 * diag((lambda_to_i - lambda_from_j)^2)) c_i = a b_i. */
static int solve_rows(const struct iso_shape *from, const struct iso_shape *to, int32_t k, int n,
                      const double *a, const double *b, double weight, double *c)
{
    const size_t size = (size_t)k;
    const double top = fmax(from->pairs->lambda[k - 1], to->pairs->lambda[k - 1]);
    double *product = malloc(2 * size * size * sizeof *product);
    if (!product) {
        return -ENOMEM;
    }
    double *system = product + size * size;
    int error = 0;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, k, k, n, 1.0, a, n, a, n, 0.0, product, k);
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, k, k, n, 1.0, b, n, a, n, 0.0, c, k);
    for (int32_t i = 0; i < k && !error; i++) {
        memcpy(system, product, size * size * sizeof *system);
        for (int32_t j = 0; j < k; j++) {
            const double away = top > 0.0 ? (to->pairs->lambda[i] - from->pairs->lambda[j]) / top
                                          : 0.0;
            /* A little more than nothing keeps the system definite where eigenvalues are equal. */
            system[(size_t)j * size + (size_t)j] += weight * (away * away + 1e-9);
        }
        error = LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', k, 1, system, k, &c[(size_t)i * size], 1)
                    ? -EDOM
                    : 0;
    }
    free(product);
    return error;
}

int iso_functional_map_fit(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                           const struct iso_shared_functions *functions, double weight, double *c)
{
    if (valid_pairs(from, to, k) || functions->n < 1 || !(weight > 0.0)) {
        return -EINVAL;
    }
    const size_t size = (size_t)k * (size_t)functions->n;
    double *a = malloc(2 * size * sizeof *a);
    double *fitted = malloc((size_t)k * (size_t)k * sizeof *fitted);
    int error = a && fitted ? project(from, k, functions->from, functions->n, a) : -ENOMEM;
    if (!error) {
        error = project(to, k, functions->to, functions->n, a + size);
    }
    if (!error) {
        error = solve_rows(from, to, k, functions->n, a, a + size, weight, fitted);
    }
    if (!error) {
        memcpy(c, fitted, (size_t)k * (size_t)k * sizeof *c);
    }
    free(a);
    free(fitted);
    return error;
}

/* ---- maps of points ------------------------------------------------------------------------- */

/* Eigenfunctions vertex by vertex: out [n_vertices][k]. */
static void transpose(const struct iso_eigenpairs *pairs, int32_t k, double *out)
{
    for (int32_t i = 0; i < k; i++) {
        for (int32_t v = 0; v < pairs->n; v++) {
            out[(size_t)v * (size_t)k + (size_t)i] =
                pairs->phi[(size_t)i * (size_t)pairs->n + (size_t)v];
        }
    }
}

/* Finds the nearest of n rows of a for each of some rows of b. product [rows][n] is scratch. */
static void find_nearest(const double *a, const double *square, int32_t n, const double *b,
                         int rows, int32_t k, double *product, int32_t *nearest)
{
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasTrans, rows, n, k, -2.0, b, k, a, k, 0.0, product,
                n);
    for (int r = 0; r < rows; r++) {
        const double *p = &product[(size_t)r * (size_t)n];
        int32_t best = 0;
        for (int32_t i = 1; i < n; i++) {
            best = p[i] + square[i] < p[best] + square[best] ? i : best;
        }
        nearest[r] = best;
    }
}

int iso_functional_map_points(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                              const double *c, int32_t *point)
{
    if (valid_pairs(from, to, k)) {
        return -EINVAL;
    }
    const size_t n_from = (size_t)from->mesh->n_vertices, n_to = (size_t)to->mesh->n_vertices;
    const size_t size = (size_t)k;
    double *a = malloc((n_from * (size + 1) + n_to * 2 * size) * sizeof *a);
    double *product = malloc(ROWS * n_from * sizeof *product);
    if (!a || !product) {
        free(a);
        free(product);
        return -ENOMEM;
    }
    double *square = a + n_from * size, *own = square + n_from, *b = own + n_to * size;
    transpose(from->pairs, k, a);
    transpose(to->pairs, k, own);
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)n_to, k, k, 1.0, own, k, c, k, 0.0,
                b, k);
    for (size_t i = 0; i < n_from; i++) {
        square[i] = cblas_ddot(k, &a[i * size], 1, &a[i * size], 1);
    }
    for (size_t at = 0; at < n_to; at += ROWS) {
        const int rows = (int)(n_to - at < ROWS ? n_to - at : ROWS);
        find_nearest(a, square, (int32_t)n_from, &b[at * size], rows, k, product, &point[at]);
    }
    free(a);
    free(product);
    return 0;
}

int iso_functional_map_of(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                          const int32_t *point, double *c)
{
    const size_t n_from = (size_t)from->mesh->n_vertices, n_to = (size_t)to->mesh->n_vertices;
    if (valid_pairs(from, to, k)) {
        return -EINVAL;
    }
    for (size_t v = 0; v < n_to; v++) {
        if (point[v] < 0 || point[v] >= (int32_t)n_from) {
            return -EINVAL;
        }
    }
    double *taken = malloc(2 * n_to * sizeof *taken);
    if (!taken) {
        return -ENOMEM;
    }
    for (int32_t j = 0; j < k; j++) {
        for (size_t v = 0; v < n_to; v++) {
            taken[v] = from->pairs->phi[(size_t)j * n_from + (size_t)point[v]];
        }
        iso_symmetric_multiply(to->mass, taken, taken + n_to);
        for (int32_t i = 0; i < k; i++) {
            c[(size_t)i * (size_t)k + (size_t)j] = cblas_ddot(
                (int)n_to, &to->pairs->phi[(size_t)i * n_to], 1, taken + n_to, 1);
        }
    }
    free(taken);
    return 0;
}

int iso_zoom_out(const struct iso_shape *from, const struct iso_shape *to, int32_t k,
                 const double *c, int32_t step, int32_t k_last, int32_t *point)
{
    if (valid_pairs(from, to, k) || valid_pairs(from, to, k_last) || step < 1 || k_last < k) {
        return -EINVAL;
    }
    double *map = malloc((size_t)k_last * (size_t)k_last * sizeof *map);
    if (!map) {
        return -ENOMEM;
    }
    memcpy(map, c, (size_t)k * (size_t)k * sizeof *map);
    int error = iso_functional_map_points(from, to, k, map, point);
    while (!error && k < k_last) {
        k = k_last - k < step ? k_last : k + step;
        error = iso_functional_map_of(from, to, k, point, map);
        if (!error) {
            error = iso_functional_map_points(from, to, k, map, point);
        }
    }
    free(map);
    return error;
}
