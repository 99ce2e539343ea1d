#include "core/shape/describe/principal.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/lapack.h"

/* A component whose variance is below this share of the largest one is only rounding noise, because
 * values are floats. */
static const double least_variance = 1e-10;

static int fill_centred(const float *const *vector, int32_t n, struct iso_principal *p,
                        double *centred)
{
    const size_t size = (size_t)p->size;
    for (size_t j = 0; j < size; j++) {
        double sum = 0.0;
        for (int32_t i = 0; i < n; i++) {
            sum += (double)vector[i][j];
        }
        p->mean[j] = (float)(sum / n);
        for (int32_t i = 0; i < n; i++) {
            centred[(size_t)i * size + j] = (double)vector[i][j] - sum / n;
        }
        if (!isfinite(sum)) {
            return -EDOM;
        }
    }
    return 0;
}

/* Makes the components from the eigenvectors of the matrix of products, whose last eigenvalue is
 * the largest. */
static void combine(const double *centred, const double *eigenvector, const double *value,
                    int32_t n, double *sum, struct iso_principal *p)
{
    const int32_t wanted = p->n_components;
    p->n_components = 0;
    for (int32_t c = 0; c < wanted; c++) {
        const double variance = value[n - 1 - c];
        if (!(variance > 0.0) || variance < least_variance * value[n - 1]) {
            return;
        }
        cblas_dgemv(CblasRowMajor, CblasTrans, n, p->size, 1.0 / sqrt(variance), centred, p->size,
                    &eigenvector[(size_t)(n - 1 - c) * (size_t)n], 1, 0.0, sum, 1);
        for (int32_t j = 0; j < p->size; j++) {
            p->component[(size_t)c * (size_t)p->size + (size_t)j] = (float)sum[j];
        }
        p->n_components++;
    }
}

int iso_principal_init(const float *const *vector, int32_t n, int32_t size, int32_t wanted,
                       struct iso_principal *out)
{
    if (n < 1 || size < 1 || wanted < 1) {
        return -EINVAL;
    }
    struct iso_principal p = {.size = size, .n_components = wanted < n ? wanted : n};
    p.mean = calloc((size_t)size, sizeof *p.mean);
    p.component = calloc((size_t)p.n_components * (size_t)size, sizeof *p.component);
    double *centred = malloc((size_t)n * (size_t)size * sizeof *centred);
    double *product = calloc((size_t)n * (size_t)n, sizeof *product);
    double *value = calloc((size_t)n, sizeof *value), *sum = calloc((size_t)size, sizeof *sum);
    int error = p.mean && p.component && centred && product && value && sum ? 0 : -ENOMEM;
    if (!error) {
        error = fill_centred(vector, n, &p, centred);
    }
    if (!error) {
        cblas_dsyrk(CblasRowMajor, CblasLower, CblasNoTrans, n, size, 1.0, centred, size, 0.0,
                    product, n);
        /* The lower triangle by rows is the upper one by columns. */
        error = iso_lapack_error(LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', n, product, n, value));
    }
    if (!error) {
        combine(centred, product, value, n, sum, &p);
        *out = p;
    } else {
        iso_principal_done(&p);
    }
    free(centred);
    free(product);
    free(value);
    free(sum);
    return error;
}

void iso_principal_done(struct iso_principal *principal)
{
    free(principal->mean);
    free(principal->component);
    *principal = (struct iso_principal){0};
}

void iso_principal_project(const struct iso_principal *p, const float *vector, float *coefficient)
{
    for (int32_t c = 0; c < p->n_components; c++) {
        const float *component = &p->component[(size_t)c * (size_t)p->size];
        double sum = 0.0;
        for (int32_t j = 0; j < p->size; j++) {
            sum += (double)component[j] * ((double)vector[j] - (double)p->mean[j]);
        }
        coefficient[c] = (float)sum;
    }
}
