#include "isotherm/signature.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* out [n][n_times] = sum_i factor(i, v) exp(-lambda_i t): factor [k][n] and decay [k][n_times] hold
 * the pairs from the first one wanted. */
static void sum_pairs(const double *factor, const double *decay, int32_t n, int32_t k, int n_times,
                      double *out)
{
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, n_times, k, 1.0, factor, n, decay,
                n_times, 0.0, out, n_times);
}

static void fill_decay(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *decay)
{
    for (int32_t i = first; i < pairs->k; i++) {
        for (int j = 0; j < n_times; j++) {
            *decay++ = exp(-pairs->lambda[i] * t[j]);
        }
    }
}

/* A course of heat at each vertex: sum_i exp(-lambda_i t) phi_i(.) other_i(.), where `other` is
 * phi_i itself, or phi_i at one vertex if that is 0 or more. */
static int courses(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                   const double *t, int n_times, double *out)
{
    size_t n = (size_t)pairs->n, k = (size_t)(pairs->k > first ? pairs->k - first : 0);
    double *factor = malloc((k * n + 1) * sizeof *factor);
    double *decay = malloc((k * (size_t)n_times + 1) * sizeof *decay);
    if (!factor || !decay) {
        free(factor);
        free(decay);
        return -ENOMEM;
    }
    for (size_t i = 0; i < k; i++) {
        const double *phi = &pairs->phi[(i + (size_t)first) * n];
        for (size_t v = 0; v < n; v++) {
            factor[i * n + v] = phi[v] * (vertex < 0 ? phi[v] : phi[vertex]);
        }
    }
    fill_decay(pairs, first, t, n_times, decay);
    sum_pairs(factor, decay, pairs->n, (int32_t)k, n_times, out);
    free(factor);
    free(decay);
    return 0;
}

int iso_heat_signature(const struct iso_eigenpairs *pairs, int32_t first, const double *t,
                       int n_times, double *out)
{
    return courses(pairs, -1, first, t, n_times, out);
}

int iso_heat_from_vertex(const struct iso_eigenpairs *pairs, int32_t vertex, int32_t first,
                         const double *t, int n_times, double *out)
{
    return courses(pairs, vertex, first, t, n_times, out);
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
