#include "core/shape/classify/dictionary.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/lapack.h"

int iso_dictionary_init(struct iso_dictionary *d, const float *atom, int32_t n, int32_t size,
                        int32_t stride)
{
    const size_t entries = (size_t)n * (size_t)n;
    struct iso_dictionary made = {.n = n, .size = size, .atom = atom, .stride = stride};
    made.square = calloc((size_t)n, sizeof *made.square);
    made.value = calloc((size_t)n, sizeof *made.value);
    made.vector = calloc(entries, sizeof *made.vector);
    if (!made.square || !made.value || !made.vector) {
        iso_dictionary_done(&made);
        return -ENOMEM;
    }
    double trace = 0.0;
    for (int32_t i = 0; i < n; i++) {
        double *row = &made.vector[(size_t)i * (size_t)n];
        iso_dictionary_products(&made, &atom[(size_t)i * (size_t)stride], row);
        made.square[i] = row[i];
        trace += row[i];
    }
    const int error = isfinite(trace)
                          ? iso_lapack_error(LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', n,
                                                            made.vector, n, made.value))
                          : -EDOM;
    if (error) {
        iso_dictionary_done(&made);
        return error;
    }
    *d = made;
    return 0;
}

void iso_dictionary_done(struct iso_dictionary *d)
{
    free(d->square);
    free(d->value);
    free(d->vector);
    *d = (struct iso_dictionary){0};
}

void iso_dictionary_products(const struct iso_dictionary *d, const float *y, double *product)
{
    for (int32_t i = 0; i < d->n; i++) {
        const float *atom = &d->atom[(size_t)i * (size_t)d->stride];
        double sum = 0.0;
        for (int32_t j = 0; j < d->size; j++) {
            sum += (double)atom[j] * (double)y[j];
        }
        product[i] = sum;
    }
}

/* x = (D D' + c I)^-1 b by the eigenvectors, whose coefficients are put into `between`. */
static void solve_all(const struct iso_dictionary *d, double c, const double *b, double *between,
                      double *x)
{
    cblas_dgemv(CblasColMajor, CblasTrans, d->n, d->n, 1.0, d->vector, d->n, b, 1, 0.0, between, 1);
    for (int32_t j = 0; j < d->n; j++) {
        between[j] /= fmax(d->value[j], 0.0) + c;
    }
    cblas_dgemv(CblasColMajor, CblasNoTrans, d->n, d->n, 1.0, d->vector, d->n, between, 1, 0.0, x,
                1);
}

void iso_dictionary_solve(const struct iso_dictionary *d, double c, const double *b, int32_t left,
                          double *scratch, double *alpha)
{
    solve_all(d, c, b, scratch, alpha);
    if (left < 0) {
        return;
    }
    /* alpha_left = 0 by a Lagrange multiplier: alpha - (alpha_left / x_left) x, x = (..)^-1 e_left.
     */
    double *x = &scratch[d->n], factor;
    for (int32_t j = 0; j < d->n; j++) {
        scratch[j] = d->vector[(size_t)j * (size_t)d->n + (size_t)left] /
                     (fmax(d->value[j], 0.0) + c);
    }
    cblas_dgemv(CblasColMajor, CblasNoTrans, d->n, d->n, 1.0, d->vector, d->n, scratch, 1, 0.0, x,
                1);
    factor = alpha[left] / x[left];
    for (int32_t i = 0; i < d->n; i++) {
        alpha[i] -= factor * x[i];
    }
    alpha[left] = 0.0;
}
