#include "tests/bench/peers/heat_arpack.h"

#include <arpack/arpack.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/factor.h"

/* The state of ARPACK's reverse communication. */
struct arpack {
    int n, k, ncv;
    double shift; /* sigma < 0, so that L - sigma B is positive definite */
    double tolerance;
    double *residual; /* [n] */
    double *basis;    /* [ncv][n] */
    double *workd;    /* [3 n] */
    double *workl;    /* [ncv (ncv + 8)] */
    double *scratch;  /* [n] */
    int iparam[11], ipntr[11];
};

static int arpack_init(struct arpack *a, int32_t n, int32_t k, double shift, double tolerance)
{
    memset(a, 0, sizeof *a);
    a->n = n;
    a->k = k;
    a->ncv = 2 * k + 10 < n ? 2 * k + 10 : n;
    a->shift = shift;
    a->tolerance = tolerance;
    a->iparam[0] = 1;   /* exact shifts */
    a->iparam[2] = 300; /* restarts at most */
    a->iparam[6] = 3;   /* shift-invert */
    size_t rows = (size_t)n, ncv = (size_t)a->ncv;
    a->residual = calloc(rows, sizeof(double));
    a->basis = calloc(rows * ncv, sizeof(double));
    a->workd = calloc(3 * rows, sizeof(double));
    a->workl = calloc(ncv * (ncv + 8), sizeof(double));
    a->scratch = calloc(rows, sizeof(double));
    return a->residual && a->basis && a->workd && a->workl && a->scratch ? 0 : -ENOMEM;
}

static void arpack_done(struct arpack *a)
{
    free(a->residual);
    free(a->basis);
    free(a->workd);
    free(a->workl);
    free(a->scratch);
}

/* Runs the reverse communication to its end. */
static int arpack_iterate(struct arpack *a, const struct iso_symmetric *mass,
                          struct iso_factor *factor)
{
    int ido = 0, info = 1; /* info 1: the start vector is given, so that all runs are the same */
    for (int i = 0; i < a->n; i++) {
        a->residual[i] = 1.0 + 0.5 * sin(1.0 + 0.7 * i); /* any vector with all modes in it */
    }
    for (;;) {
        dsaupd_c(&ido, "G", a->n, "LM", a->k, a->tolerance, a->residual, a->ncv, a->basis, a->n,
                 a->iparam, a->ipntr, a->workd, a->workl, a->ncv * (a->ncv + 8), &info);
        double *x = &a->workd[a->ipntr[0] - 1], *y = &a->workd[a->ipntr[1] - 1];
        int error = 0;
        switch (ido) {
        case -1: /* y = (L - sigma B)^-1 B x */
            iso_symmetric_multiply(mass, x, a->scratch);
            error = iso_factor_solve(factor, a->scratch, 1, y);
            break;
        case 1: /* the same, with B x already computed */
            error = iso_factor_solve(factor, &a->workd[a->ipntr[2] - 1], 1, y);
            break;
        case 2: /* y = B x */
            iso_symmetric_multiply(mass, x, y);
            break;
        default:
            return info == 0 && a->iparam[4] >= a->k ? 0 : -ENOTRECOVERABLE;
        }
        if (error) {
            return error;
        }
    }
}

/* Extracts values and vectors, ascending. */
static int arpack_extract(struct arpack *a, double *lambda, double *phi)
{
    int info = 0, *select = calloc((size_t)a->ncv, sizeof *select);
    if (!select) {
        return -ENOMEM;
    }
    dseupd_c(1, "A", select, lambda, phi, a->n, a->shift, "G", a->n, "LM", a->k, a->tolerance,
             a->residual, a->ncv, a->basis, a->n, a->iparam, a->ipntr, a->workd, a->workl,
             a->ncv * (a->ncv + 8), &info);
    free(select);
    if (info != 0) {
        return -ENOTRECOVERABLE;
    }
    for (int i = 1; i < a->k; i++) { /* insertion sort: ARPACK returns them nearly sorted */
        for (int j = i; j > 0 && lambda[j - 1] > lambda[j]; j--) {
            double larger = lambda[j - 1];
            lambda[j - 1] = lambda[j];
            lambda[j] = larger;
            double *u = &phi[(size_t)j * (size_t)a->n], *v = u - a->n;
            memcpy(a->scratch, u, (size_t)a->n * sizeof *u);
            memcpy(u, v, (size_t)a->n * sizeof *u);
            memcpy(v, a->scratch, (size_t)a->n * sizeof *u);
        }
    }
    return 0;
}

int peer_arpack(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass, int k,
                double shift, double *lambda, double *phi)
{
    struct arpack arpack;
    struct iso_factor *factor = NULL;
    int error = arpack_init(&arpack, stiffness->n, k, shift, 1e-10);
    if (!error) {
        error = iso_factor_new(stiffness->n, stiffness->nnz, &factor);
    }
    if (!error) {
        error = iso_factor_compute(factor, 1.0, stiffness, -shift, mass);
    }
    if (!error) {
        error = arpack_iterate(&arpack, mass, factor);
    }
    if (!error) {
        error = arpack_extract(&arpack, lambda, phi);
    }
    iso_factor_free(factor);
    arpack_done(&arpack);
    return error;
}
