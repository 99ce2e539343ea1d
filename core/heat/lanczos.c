#include "core/heat/lanczos.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 256 }; /* of V that are rotated at once */

/* Pseudo-random numbers in -1..1: Knuth's linear congruential generator (MMIX). */
static double next_random(struct iso_lanczos *l)
{
    l->random = l->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(int32_t)(l->random >> 32) / 2147483648.0;
}

static double *vector(double *vectors, const struct iso_lanczos *l, int32_t i)
{
    return &vectors[(size_t)i * (size_t)l->n];
}

/* Subtracts from w [columns][n] its projection on the first `size` vectors of V. If `sum`
 * [columns][stride] is given, the coefficients are added to it. */
static void project_out(struct iso_lanczos *l, int32_t size, double *w, int32_t columns,
                        double *sum, int32_t stride)
{
    if (size == 0) {
        return;
    }
    for (int pass = 0; pass < 2; pass++) { /* twice is enough (Kahan; Parlett 1980, 6.9) */
        for (int32_t c = 0; c < columns; c++) {
            iso_symmetric_multiply(l->mass, vector(w, l, c), vector(l->bw, l, c));
        }
        cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, size, columns, l->n, 1.0, l->v, l->n,
                    l->bw, l->n, 0.0, l->projected, size);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, l->n, columns, size, -1.0, l->v,
                    l->n, l->projected, size, 1.0, w, l->n);
        for (int32_t c = 0; sum && c < columns; c++) {
            for (int32_t i = 0; i < size; i++) {
                sum[c * stride + i] += l->projected[c * size + i];
            }
        }
    }
}

/* Stores w, which is orthogonal to V, as the next vector of the pending block, and returns its
 * norm. If the norm is at most `least`, it stores nothing and returns 0. The caller increases the
 * number of pending vectors. */
static double append(struct iso_lanczos *l, double *w, double least)
{
    double *v = vector(l->v, l, l->size + l->pending), *bv = vector(l->bv, l, l->pending);
    iso_symmetric_multiply(l->mass, w, bv);
    const double norm = sqrt(fmax(0.0, cblas_ddot(l->n, w, 1, bv, 1)));
    if (!(norm > least)) {
        return 0.0;
    }
    for (int32_t i = 0; i < l->n; i++) {
        v[i] = w[i] / norm;
        bv[i] /= norm;
    }
    return norm;
}

/* Completes the next block with random vectors, each orthogonal to those before. */
static int fill_up(struct iso_lanczos *l, int32_t wanted)
{
    while (l->pending < wanted) {
        for (int32_t i = 0; i < l->n; i++) {
            l->w[i] = next_random(l);
        }
        iso_symmetric_multiply(l->mass, l->w, l->bw);
        const double before = sqrt(cblas_ddot(l->n, l->w, 1, l->bw, 1));
        if (!isfinite(before)) {
            return -EDOM;
        }
        project_out(l, l->size + l->pending, l->w, 1, NULL, 0);
        l->pending += append(l, l->w, 1e-10 * before) > 0.0;
    }
    return 0;
}

int iso_lanczos_init(struct iso_lanczos *l, const struct iso_symmetric *mass,
                     struct iso_factor *factor, int32_t block, int32_t capacity)
{
    *l = (struct iso_lanczos){.mass = mass, .factor = factor, .n = mass->n, .random = 2013};
    l->block = block < mass->n ? block : mass->n;
    l->capacity = capacity;
    size_t n = (size_t)l->n, b = (size_t)l->block, room = (size_t)capacity + b;
    l->v = malloc(room * n * sizeof(double));
    l->bv = malloc(b * n * sizeof(double));
    l->bw = malloc(b * n * sizeof(double));
    l->t = calloc((size_t)capacity * (size_t)capacity, sizeof(double));
    l->coupling = calloc(b * b, sizeof(double));
    l->w = calloc(b * n, sizeof(double));
    l->projected = calloc(b * room, sizeof(double));
    const bool room_made = l->v && l->bv && l->bw && l->t && l->coupling && l->w && l->projected;
    if (!room_made) {
        return -ENOMEM;
    }
    return fill_up(l, l->block);
}

int iso_lanczos_rotate(struct iso_lanczos *l, const double *vectors, int32_t columns)
{
    double *rows = malloc(ROWS * (size_t)columns * sizeof *rows);
    if (!rows) {
        return -ENOMEM;
    }
    for (int32_t from = 0; from < l->n; from += ROWS) {
        const int32_t count = l->n - from < ROWS ? l->n - from : ROWS;
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, columns, l->size, 1.0,
                    &l->v[from], l->n, vectors, l->size, 0.0, rows, ROWS);
        for (int32_t i = 0; i < columns; i++) {
            memcpy(vector(l->v, l, i) + from, &rows[(size_t)i * ROWS],
                   (size_t)count * sizeof *rows);
        }
    }
    free(rows);
    return 0;
}

int iso_lanczos_restart(struct iso_lanczos *l, const double *vectors, const double *values,
                        int32_t keep)
{
    const size_t capacity = (size_t)l->capacity;
    const int error = iso_lanczos_rotate(l, vectors, keep);
    if (error) {
        return error;
    }
    memmove(vector(l->v, l, keep), vector(l->v, l, l->size),
            (size_t)l->pending * (size_t)l->n * sizeof *l->v);
    memset(l->t, 0, capacity * capacity * sizeof *l->t);
    for (int32_t i = 0; i < keep; i++) {
        l->t[(size_t)i * capacity + (size_t)i] = values[i];
    }
    l->size = keep;
    return 0;
}

void iso_lanczos_done(struct iso_lanczos *l)
{
    free(l->v);
    free(l->bv);
    free(l->bw);
    free(l->t);
    free(l->coupling);
    free(l->w);
    free(l->projected);
    *l = (struct iso_lanczos){0};
}

/* Makes the next block from the part of A V that lies outside of V: w = (next block) coupling. */
static int next_block(struct iso_lanczos *l, double scale)
{
    int32_t left = l->n - l->size, wanted = l->last < left ? l->last : left;
    memset(l->coupling, 0, (size_t)l->block * (size_t)l->block * sizeof(double));
    l->pending = 0;
    for (int32_t c = 0; c < l->last && l->pending < wanted; c++) {
        double *w = vector(l->w, l, c), *coupling = &l->coupling[c * l->block];
        for (int pass = 0; pass < 2; pass++) {
            for (int32_t i = 0; i < l->pending; i++) {
                const double dot = cblas_ddot(l->n, vector(l->bv, l, i), 1, w, 1);
                cblas_daxpy(l->n, -dot, vector(l->v, l, l->size + i), 1, w, 1);
                coupling[i] += dot;
            }
        }
        const double norm = append(l, w, 1e-14 * scale);
        if (norm > 0.0) {
            coupling[l->pending++] = norm;
        }
    }
    return fill_up(l, wanted);
}

int iso_lanczos_step(struct iso_lanczos *l)
{
    int32_t from = l->size, columns = l->pending;
    const int error = iso_factor_solve(l->factor, l->bv, columns, l->w);
    if (error) {
        return error;
    }
    double scale = 0.0; /* the largest entry of T so far is near the norm of A */
    project_out(l, from + columns, l->w, columns, &l->t[(size_t)from * (size_t)l->capacity],
                l->capacity);
    l->size += columns;
    l->last = columns;
    for (int32_t i = 0; i < l->size; i++) {
        scale = fmax(scale, fabs(l->t[(size_t)i * (size_t)l->capacity + (size_t)i]));
    }
    return isfinite(scale) ? next_block(l, scale) : -EDOM;
}
