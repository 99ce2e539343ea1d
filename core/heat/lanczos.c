#include "core/heat/lanczos.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/small_cholesky.h"

enum { WIDTH = ISO_PANEL / ISO_DOUBLES };

/* Pseudo-random numbers in -1..1: Knuth's linear congruential generator (MMIX). */
static double next_random(struct iso_lanczos *l)
{
    l->random = l->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(int32_t)(l->random >> 32) / 2147483648.0;
}

static int32_t panels_for(int32_t vectors)
{
    return (vectors + ISO_PANEL - 1) / ISO_PANEL;
}

static size_t panel_values(const struct iso_lanczos *l)
{
    return (size_t)l->n * ISO_PANEL;
}

static double *panel(double *panels, const struct iso_lanczos *l, int32_t p)
{
    return &panels[(size_t)p * panel_values(l)];
}

/* The first value of vector i. Its next value is ISO_PANEL places further. */
static double *vector(double *panels, const struct iso_lanczos *l, int32_t i)
{
    return panel(panels, l, i / ISO_PANEL) + i % ISO_PANEL;
}

/* bw = B w, for panels of w. */
static void multiply(struct iso_lanczos *l, int32_t panels)
{
    double form[ISO_PANEL], total[ISO_PANEL];
    for (int32_t p = 0; p < panels; p++) {
        l->block_ops->multiply(&l->mass, WIDTH, panel(l->w, l, p), panel(l->bw, l, p), form, total);
    }
}

/* The rows of the product of panel p of V and panel q of w. */
static double (*product_at(const struct iso_lanczos *l, int32_t p, int32_t q,
                           int32_t n_q))[ISO_PANEL]
{
    return &l->product[((size_t)p * (size_t)n_q + (size_t)q) * ISO_PANEL];
}

/* product = V' b, for panels from..to of V and n_q panels b. */
static void dot_panels(struct iso_lanczos *l, double *v, int32_t from, int32_t to, double *b,
                       int32_t n_q)
{
    memset(product_at(l, from, 0, n_q), 0,
           (size_t)(to - from) * (size_t)n_q * ISO_PANEL * sizeof *l->product);
    for (int32_t row = 0; row < l->n; row += ISO_PANEL_ROWS) {
        const int32_t rows = l->n - row < ISO_PANEL_ROWS ? l->n - row : ISO_PANEL_ROWS;
        const size_t at = (size_t)row * ISO_PANEL;
        for (int32_t p = from; p < to; p++) {
            for (int32_t q = 0; q < n_q; q++) {
                l->panel_ops->dot(rows, panel(v, l, p) + at, panel(b, l, q) + at,
                                  product_at(l, p, q, n_q));
            }
        }
    }
}

/* w += V product, for panels from..to of V and n_q panels of w. */
static void add_panels(struct iso_lanczos *l, int32_t from, int32_t to, int32_t n_q)
{
    for (int32_t row = 0; row < l->n; row += ISO_PANEL_ROWS) {
        const int32_t rows = l->n - row < ISO_PANEL_ROWS ? l->n - row : ISO_PANEL_ROWS;
        const size_t at = (size_t)row * ISO_PANEL;
        for (int32_t p = from; p < to; p++) {
            for (int32_t q = 0; q < n_q; q++) {
                l->panel_ops->add(rows, panel(l->v, l, p) + at,
                                  (const double(*)[ISO_PANEL])product_at(l, p, q, n_q),
                                  panel(l->w, l, q) + at);
            }
        }
    }
}

/* Subtracts from `columns` vectors w their projection on panels from..to of V. If `sum`
 * [columns][stride] is given, the coefficients are added to it. */
static void project_out(struct iso_lanczos *l, int32_t from, int32_t to, int32_t columns,
                        double *sum, int32_t stride)
{
    const int32_t n_q = panels_for(columns);
    if (from >= to) {
        return;
    }
    multiply(l, n_q);
    dot_panels(l, l->v, from, to, l->bw, n_q);
    for (int32_t p = from; p < to; p++) {
        for (int32_t c = 0; sum && c < columns; c++) {
            double(*product)[ISO_PANEL] = product_at(l, p, c / ISO_PANEL, n_q);
            for (int32_t i = 0; i < ISO_PANEL && p * ISO_PANEL + i < stride; i++) {
                sum[c * stride + p * ISO_PANEL + i] += product[i][c % ISO_PANEL];
            }
        }
    }
    for (int32_t i = from * n_q * ISO_PANEL; i < to * n_q * ISO_PANEL; i++) {
        for (int c = 0; c < ISO_PANEL; c++) {
            l->product[i][c] = -l->product[i][c];
        }
    }
    add_panels(l, from, to, n_q);
}

/* Stores vector c of w, which is orthogonal to V, as the next vector of the pending block, and
 * returns its norm. If the norm is at most `least`, it stores nothing and returns 0. The caller
 * increases the number of pending vectors. */
static double append(struct iso_lanczos *l, int32_t c, double least)
{
    double *v = vector(l->v, l, l->size + l->pending), *bv = vector(l->bv, l, l->pending);
    const double *w = vector(l->w, l, c), *bw = vector(l->bw, l, c);
    multiply(l, panels_for(c + 1));
    const double norm = sqrt(fmax(0.0, cblas_ddot(l->n, w, ISO_PANEL, bw, ISO_PANEL)));
    if (!(norm > least)) {
        return 0.0;
    }
    for (size_t i = 0; i < panel_values(l); i += ISO_PANEL) {
        v[i] = w[i] / norm;
        bv[i] = bw[i] / norm;
    }
    return norm;
}

/* Completes the next block with random vectors, each orthogonal to those before. */
static int fill_up(struct iso_lanczos *l, int32_t wanted)
{
    while (l->pending < wanted) {
        memset(l->w, 0, panel_values(l) * sizeof *l->w);
        for (int32_t i = 0; i < l->n; i++) {
            l->w[(size_t)i * ISO_PANEL] = next_random(l);
        }
        multiply(l, 1);
        const double before = sqrt(cblas_ddot(l->n, l->w, ISO_PANEL, l->bw, ISO_PANEL));
        if (!isfinite(before)) {
            return -EDOM;
        }
        for (int pass = 0; pass < 2; pass++) { /* twice is enough (Kahan; Parlett 1980, 6.9) */
            project_out(l, 0, panels_for(l->size + l->pending), 1, NULL, 0);
        }
        l->pending += append(l, 0, 1e-10 * before) > 0.0;
    }
    return 0;
}

static int allocate(struct iso_lanczos *l)
{
    const size_t b = (size_t)l->block, capacity = (size_t)l->capacity;
    const size_t block_panels = (size_t)panels_for(l->block);
    const size_t panels = (size_t)panels_for(l->capacity) + block_panels;
    l->order = malloc((size_t)l->n * sizeof *l->order);
    l->v = malloc(panels * panel_values(l) * sizeof(double));
    l->bv = malloc(block_panels * panel_values(l) * sizeof(double));
    l->bw = malloc(block_panels * panel_values(l) * sizeof(double));
    l->w = calloc(block_panels * panel_values(l), sizeof(double));
    l->t = calloc(capacity * capacity, sizeof(double));
    l->coupling = calloc(b * b, sizeof(double));
    l->product = malloc(panels * block_panels * ISO_PANEL * sizeof *l->product);
    return l->order && l->v && l->bv && l->bw && l->w && l->t && l->coupling && l->product
               ? 0
               : -ENOMEM;
}

/* Panels of a block that are not full have zeros in the place of vectors. */
static void clear_pending(struct iso_lanczos *l)
{
    const size_t bytes = (size_t)panels_for(l->block) * panel_values(l) * sizeof(double);
    memset(vector(l->v, l, l->size), 0, bytes);
    memset(l->bv, 0, bytes);
    l->pending = 0;
}

int iso_lanczos_init(struct iso_lanczos *l, const struct iso_symmetric *mass,
                     const struct iso_factor *factor, int32_t block, int32_t capacity)
{
    const int32_t *order;
    *l = (struct iso_lanczos){.n = mass->n, .random = 2013};
    l->block_ops = iso_block_ops();
    l->panel_ops = iso_panel_ops();
    l->block = block < mass->n ? block : mass->n;
    l->capacity = capacity;
    int error = iso_factor_ldl(factor, &l->ldl, &order);
    if (!error) {
        error = iso_permuted_new(mass->n, mass->nnz, &l->permuted);
    }
    if (!error) {
        error = iso_permuted_fill(l->permuted, mass, order, &l->mass);
    }
    if (!error) {
        error = allocate(l);
    }
    if (error) {
        return error;
    }
    memcpy(l->order, order, (size_t)l->n * sizeof *l->order);
    clear_pending(l);
    return fill_up(l, l->block);
}

void iso_lanczos_done(struct iso_lanczos *l)
{
    iso_permuted_free(l->permuted);
    free(l->order);
    free(l->v);
    free(l->bv);
    free(l->bw);
    free(l->w);
    free(l->t);
    free(l->coupling);
    free(l->product);
    *l = (struct iso_lanczos){0};
}

/* Makes the next block from w by Gram and Schmidt, vector by vector, and leaves out vectors that
 * depend on others. */
static int next_by_vectors(struct iso_lanczos *l, int32_t wanted, double scale)
{
    memset(l->coupling, 0, (size_t)l->block * (size_t)l->block * sizeof(double));
    clear_pending(l);
    for (int32_t c = 0; c < l->last && l->pending < wanted; c++) {
        double *w = vector(l->w, l, c), *coupling = &l->coupling[c * l->block];
        for (int pass = 0; pass < 2; pass++) {
            for (int32_t i = 0; i < l->pending; i++) {
                const double dot = cblas_ddot(l->n, vector(l->bv, l, i), ISO_PANEL, w, ISO_PANEL);
                cblas_daxpy(l->n, -dot, vector(l->v, l, l->size + i), ISO_PANEL, w, ISO_PANEL);
                coupling[i] += dot;
            }
        }
        const double norm = append(l, c, 1e-14 * scale);
        if (norm > 0.0) {
            coupling[l->pending++] = norm;
        }
    }
    return fill_up(l, wanted);
}

/* w = w R^-1 for one panel, with R' R = w' B w, and bw = B w R^-1. r receives R R(before). False,
 * with w and r as they were, if a vector of w depends too much on those before it. */
static bool orthogonalise_panel(struct iso_lanczos *l, double scale, double (*r)[ISO_PANEL])
{
    double inverse[ISO_PANEL][ISO_PANEL];
    multiply(l, 1);
    dot_panels(l, l->w, 0, 1, l->bw, 1);
    if (!iso_small_cholesky(l->product, scale, r, inverse)) {
        return false;
    }
    for (int32_t row = 0; row < l->n; row += ISO_PANEL_ROWS) {
        const int32_t rows = l->n - row < ISO_PANEL_ROWS ? l->n - row : ISO_PANEL_ROWS;
        const double(*weight)[ISO_PANEL] = (const double(*)[ISO_PANEL])inverse;
        l->panel_ops->multiply(rows, weight, &l->w[(size_t)row * ISO_PANEL]);
        l->panel_ops->multiply(rows, weight, &l->bw[(size_t)row * ISO_PANEL]);
    }
    return true;
}

/* The same by Cholesky's factor of w' B w, twice (Yamamoto et al., Roundoff error analysis of the
 * CholeskyQR2 algorithm, 2015), for a block of one panel. -EAGAIN, with w as it was, if the vectors
 * are not independent enough for that; -EDOM if something is not finite. */
static int next_by_cholesky(struct iso_lanczos *l, double scale)
{
    double r[ISO_PANEL][ISO_PANEL] = {{0}};
    for (int i = 0; i < ISO_PANEL; i++) {
        r[i][i] = 1.0;
    }
    if (!orthogonalise_panel(l, scale, r)) {
        return -EAGAIN;
    }
    if (!orthogonalise_panel(l, 0.0, r)) { /* these are nearly orthonormal, unless not finite */
        return -EDOM;
    }
    for (int c = 0; c < ISO_PANEL; c++) {
        for (int i = 0; i < ISO_PANEL; i++) {
            l->coupling[c * ISO_PANEL + i] = r[i][c];
        }
    }
    memcpy(vector(l->v, l, l->size), l->w, panel_values(l) * sizeof(double));
    memcpy(l->bv, l->bw, panel_values(l) * sizeof(double));
    l->pending = ISO_PANEL;
    return 0;
}

/* Makes the next block from the part of A V that lies outside of V: w = (next block) coupling. */
static int next_block(struct iso_lanczos *l, double scale)
{
    const int32_t left = l->n - l->size, wanted = l->last < left ? l->last : left;
    l->pending = 0;
    if (left == 0) { /* V is the whole space; its last panel may not be full */
        return 0;
    }
    const bool one_panel = l->block == ISO_PANEL && wanted == ISO_PANEL;
    const int error = one_panel ? next_by_cholesky(l, scale) : -EAGAIN;
    return error == -EAGAIN ? next_by_vectors(l, wanted, scale) : error;
}

int iso_lanczos_step(struct iso_lanczos *l)
{
    const int32_t from = l->size, columns = l->pending, panels = panels_for(columns);
    const int32_t end = panels_for(from + columns), before = (from - l->last) / ISO_PANEL;
    double *t = &l->t[(size_t)from * (size_t)l->capacity], energy[ISO_PANEL], scale = 0.0;
    memcpy(l->w, l->bv, (size_t)panels * panel_values(l) * sizeof(double));
    for (int32_t p = 0; p < panels; p++) {
        iso_block_solve(l->block_ops, &l->ldl, WIDTH, panel(l->w, l, p), energy);
    }
    project_out(l, before, end, columns, t, l->capacity);
    project_out(l, 0, end, columns, t, l->capacity);
    l->size += columns;
    l->last = columns;
    /* The largest entry of T so far is near the norm of A. */
    for (int32_t i = 0; i < l->size; i++) {
        scale = fmax(scale, fabs(l->t[(size_t)i * (size_t)l->capacity + (size_t)i]));
    }
    return isfinite(scale) ? next_block(l, scale) : -EDOM;
}

/* Replaces the first `columns` vectors of V by V times `vectors` [columns][size], some rows at a
 * time, so that no second V is needed. */
static int rotate(struct iso_lanczos *l, const double *vectors, int32_t columns)
{
    const int32_t panels = panels_for(l->size), width = panels * ISO_PANEL;
    double *rows = malloc(ISO_PANEL_ROWS * (size_t)width * sizeof *rows);
    double *product = malloc(ISO_PANEL_ROWS * (size_t)columns * sizeof *product);
    const int error = rows && product ? 0 : -ENOMEM;
    for (int32_t row = 0; !error && row < l->n; row += ISO_PANEL_ROWS) {
        const int32_t count = l->n - row < ISO_PANEL_ROWS ? l->n - row : ISO_PANEL_ROWS;
        const size_t at = (size_t)row * ISO_PANEL;
        for (int32_t p = 0; p < panels; p++) {
            const double *from = panel(l->v, l, p) + at;
            for (int32_t r = 0; r < count; r++) {
                memcpy(&rows[r * width + p * ISO_PANEL], &from[r * ISO_PANEL],
                       ISO_PANEL * sizeof *rows);
            }
        }
        cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, columns, count, l->size, 1.0, vectors,
                    l->size, rows, width, 0.0, product, columns);
        for (int32_t i = 0; i < columns; i++) {
            double *to = vector(l->v, l, i) + at;
            for (int32_t r = 0; r < count; r++) {
                to[r * ISO_PANEL] = product[r * columns + i];
            }
        }
    }
    free(rows);
    free(product);
    return error;
}

int iso_lanczos_restart(struct iso_lanczos *l, const double *vectors, const double *values,
                        int32_t keep)
{
    const size_t capacity = (size_t)l->capacity;
    const int error = rotate(l, vectors, keep);
    if (error) {
        return error;
    }
    memmove(vector(l->v, l, keep), vector(l->v, l, l->size),
            (size_t)panels_for(l->pending) * panel_values(l) * sizeof *l->v);
    memset(l->t, 0, capacity * capacity * sizeof *l->t);
    for (int32_t i = 0; i < keep; i++) {
        l->t[(size_t)i * capacity + (size_t)i] = values[i];
    }
    l->size = l->last = keep;
    return 0;
}

int iso_lanczos_end(struct iso_lanczos *l, const double *vectors, int32_t k)
{
    const int error = rotate(l, vectors, k);
    if (error) {
        return error;
    }
    double *smaller = realloc(l->v, (size_t)panels_for(k) * panel_values(l) * sizeof *smaller);
    if (!smaller) {
        return -ENOMEM;
    }
    l->v = smaller;
    return 0;
}

void iso_lanczos_write(const struct iso_lanczos *l, int32_t k, double *out)
{
    for (int32_t i = 0; i < k; i++) {
        const double *from = vector(l->v, l, i);
        for (int32_t row = 0; row < l->n; row++) {
            out[(size_t)i * (size_t)l->n + (size_t)l->order[row]] = from[(size_t)row * ISO_PANEL];
        }
    }
}
