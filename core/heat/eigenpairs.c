#include "isotherm/eigenpairs.h"

#include <cblas.h>
#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/lanczos.h"

enum {
    BLOCK = ISO_PANEL, /* the first size of blocks; each further attempt doubles it */
    BLOCK_MAX = 32,
    /* From so many vertices on the basis is restarted. Smaller ones need little memory, and a basis
     * that only grows needs fewer solutions. */
    RESTART_FROM = 10000,
    RESTARTS_MAX = 30,
};

/* The least relative residual that rounding allows. */
static const double least_tolerance = 1e-13;

/* One attempt, with one size of blocks. Its largest memory is that of V with the factor. */
struct attempt {
    int32_t k;
    double shift; /* s > 0, so that L + s B is positive definite */
    double tolerance;
    struct iso_lanczos *lanczos;
    double *value; /* [size]: eigenvalues of T, ascending: 1 / (lambda + s) */
    double *ritz;  /* [size][size]: vectors of T by columns */
};

/* Without eigenvectors. */
static struct iso_eigenpairs *pairs_alloc(int32_t n, int32_t k)
{
    struct iso_eigenpairs *pairs = calloc(1, sizeof *pairs);
    if (pairs) {
        pairs->n = n;
        pairs->k = k;
        pairs->lambda = calloc((size_t)k, sizeof *pairs->lambda);
    }
    if (pairs && pairs->lambda) {
        return pairs;
    }
    iso_eigenpairs_free(pairs);
    return NULL;
}

/* The sum of all entries of the mass matrix, which is the area of the surface. Eigenvalues are 4 pi
 * / area apart (Weyl 1911); the shift is given in units of that. */
static double total_mass(const struct iso_symmetric *mass)
{
    double sum = 0.0;
    for (int32_t j = 0; j < mass->n; j++) {
        for (int32_t at = mass->column_start[j]; at < mass->column_start[j + 1]; at++) {
            sum += mass->row[at] == j ? mass->value[at] : 2.0 * mass->value[at];
        }
    }
    return sum;
}

/* Diagonalises T. */
static int diagonalise_basis(struct attempt *a)
{
    const struct iso_lanczos *l = a->lanczos;
    const size_t m = (size_t)l->size;
    free(a->ritz);
    a->ritz = malloc(m * m * sizeof(double));
    if (!a->ritz) {
        return -ENOMEM;
    }
    for (size_t j = 0; j < m; j++) {
        memcpy(&a->ritz[j * m], &l->t[j * (size_t)l->capacity], m * sizeof(double));
    }
    const int info = LAPACKE_dsyevd(LAPACK_COL_MAJOR, 'V', 'U', l->size, a->ritz, l->size,
                                    a->value);
    if (info == 0) {
        return 0;
    }
    return info == LAPACK_WORK_MEMORY_ERROR ? -ENOMEM : -ENOTRECOVERABLE;
}

/* How many of the k approximate eigenvectors with the largest eigenvalues are good: A times the
 * vector lies in V, except for a small remainder. */
static int32_t count_converged(const struct attempt *a)
{
    const struct iso_lanczos *l = a->lanczos;
    int32_t good = 0;
    for (int32_t i = 0; i < a->k; i++) {
        const int32_t at = l->size - 1 - i;
        const double *tail = &a->ritz[(size_t)at * (size_t)l->size + (size_t)(l->size - l->last)];
        double square = 0.0;
        for (int32_t r = 0; r < l->pending; r++) {
            double sum = 0.0;
            for (int32_t c = 0; c < l->last; c++) {
                sum += l->coupling[c * l->block + r] * tail[c];
            }
            square += sum * sum;
        }
        good += sqrt(square) <= a->tolerance * a->value[at];
    }
    return good;
}

/* The size at which a basis is restarted; INT32_MAX: never. */
static int32_t restart_size(int32_t n, int32_t k, int32_t block)
{
    return n < RESTART_FROM ? INT32_MAX : 2 * k + 6 * block;
}

/* Keeps the best approximate eigenvectors: all k, and a third of the others, in whole panels. */
static int restart(struct attempt *a)
{
    struct iso_lanczos *l = a->lanczos;
    const int32_t best = a->k + (l->size - a->k) / 3;
    const int32_t keep = (best + ISO_PANEL - 1) / ISO_PANEL * ISO_PANEL;
    const size_t m = (size_t)l->size, first = (size_t)(l->size - keep);
    return iso_lanczos_restart(l, &a->ritz[first * m], &a->value[first], keep);
}

/* At which size of the basis to look again. The number of good pairs grows nearly in proportion to
 * the vectors beyond the first of them, by 0.3 to 0.5 a vector: the guess is 0.5, and afterwards
 * what was seen between two looks. Diagonalising T at every size would take as long as the basis.
 */
static int32_t next_look(const struct attempt *a, int32_t good, int32_t size_before,
                         int32_t good_before)
{
    const struct iso_lanczos *l = a->lanczos;
    int32_t more = 2 * (a->k - good);
    if (size_before > 0 && good > good_before) {
        more = (int32_t)((int64_t)(a->k - good) * (l->size - size_before) / (good - good_before));
    }
    const int32_t most = 2 * l->block + a->k;
    more = more < most ? more : most;
    return l->size + (more > l->block ? more : l->block);
}

/* Lets the basis grow until it contains all k pairs. -EAGAIN if it may grow no further: where
 * eigenvalues are multiple, small blocks end before all copies are found. */
static int grow_basis(struct attempt *a)
{
    struct iso_lanczos *l = a->lanczos;
    const int32_t restart_at = restart_size(l->n, a->k, l->block);
    int32_t look = a->k + a->k / 2 + 3 * l->block, size_before = 0, good_before = 0;
    int32_t restarts_left = RESTARTS_MAX;
    for (;;) {
        int error = iso_lanczos_step(l);
        bool whole = l->pending == 0, full = l->size + l->pending > l->capacity;
        if (!error && (l->size >= look || whole || full)) {
            error = diagonalise_basis(a);
            const int32_t good = error ? 0 : count_converged(a);
            if (!error && (whole || good == a->k)) {
                return 0;
            }
            look = next_look(a, good, size_before, good_before);
            size_before = l->size;
            good_before = good;
            if (l->size < restart_at) {
                look = look < restart_at ? look : restart_at;
            } else if (!error && l->pending % ISO_PANEL == 0 && restarts_left-- > 0) {
                error = restart(a);
                full = false;
                look = restart_at;
                size_before = 0;
            }
        }
        if (!error && full) {
            error = -EAGAIN;
        }
        if (error) {
            return error;
        }
    }
}

/* The eigenvalue lambda of pair i; pairs are in the order of ascending lambda. */
static double lambda_of(const struct attempt *a, int32_t i)
{
    return 1.0 / a->value[a->lanczos->size - 1 - i] - a->shift;
}

/* Checks that no eigenvalue below the k-th is missing: blocks can miss copies of an eigenvalue
 * whose multiplicity is larger than their size. -EAGAIN if one is missing. */
static int count_again(const struct attempt *a, struct iso_factor *factor,
                       const struct iso_symmetric *stiffness, const struct iso_symmetric *mass)
{
    double last = lambda_of(a, a->k - 1), limit = last - 1e-6 * (last + a->shift);
    int32_t below = 0, found = 0;
    while (found < a->k && lambda_of(a, found) < limit) {
        found++;
    }
    const int error = iso_factor_count_below(factor, stiffness, limit, mass, &below);
    if (error) {
        return error;
    }
    return below > found ? -EAGAIN : 0;
}

/* Makes the eigenvectors: V times the last k vectors of T. Their order is reversed, because lambda
 * has to ascend. They take the place of V. */
static int extract_pairs(struct attempt *a, struct iso_eigenpairs *pairs)
{
    const size_t m = (size_t)a->lanczos->size;
    double *first = &a->ritz[(m - (size_t)a->k) * m];
    for (int32_t i = 0; i < a->k; i++) {
        pairs->lambda[i] = lambda_of(a, i);
        if (2 * i + 1 < a->k) {
            cblas_dswap(a->lanczos->size, &first[(size_t)i * m], 1,
                        &first[(size_t)(a->k - 1 - i) * m], 1);
        }
    }
    return iso_lanczos_end(a->lanczos, first, a->k);
}

static int write_vectors(const struct attempt *a, struct iso_eigenpairs *pairs)
{
    pairs->phi = calloc((size_t)pairs->n * (size_t)pairs->k, sizeof *pairs->phi);
    if (!pairs->phi) {
        return -ENOMEM;
    }
    iso_lanczos_write(a->lanczos, a->k, pairs->phi);
    return 0;
}

static int solve_with_blocks(const struct iso_symmetric *stiffness,
                             const struct iso_symmetric *mass, int32_t block, double tolerance,
                             struct iso_eigenpairs *pairs)
{
    struct iso_lanczos lanczos = {0};
    struct attempt a = {.k = pairs->k, .lanczos = &lanczos, .shift = 4.0 * M_PI / total_mass(mass)};
    a.tolerance = fmax(tolerance, least_tolerance);
    int32_t capacity = 4 * pairs->k + 16 * block;
    if (pairs->n >= RESTART_FROM) { /* the step that passes that size, and the pending block */
        capacity = restart_size(pairs->n, pairs->k, block) + 2 * block;
    }
    capacity = capacity < pairs->n ? capacity : pairs->n;
    struct iso_factor *factor = NULL;
    a.value = calloc((size_t)capacity, sizeof *a.value);
    int error = a.value ? 0 : -ENOMEM;
    if (!error) {
        error = iso_factor_new(pairs->n, stiffness->nnz, &factor);
    }
    if (!error) {
        error = iso_factor_compute(factor, 1.0, stiffness, a.shift, mass);
    }
    if (!error) {
        error = iso_lanczos_init(a.lanczos, mass, factor, block, capacity);
    }
    if (!error) {
        error = grow_basis(&a);
    }
    if (!error) {
        error = extract_pairs(&a, pairs);
    }
    if (!error) { /* now that V is smaller: this needs memory as well */
        error = count_again(&a, factor, stiffness, mass);
    }
    iso_factor_free(factor);
    if (!error) {
        error = write_vectors(&a, pairs);
    }
    iso_lanczos_done(a.lanczos);
    free(a.value);
    free(a.ritz);
    return error;
}

int iso_eigenpairs_new(const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                       int32_t k, double tolerance, struct iso_eigenpairs **out)
{
    const int32_t n = stiffness->n;
    if (n < 8 || k < 1 || k > n / 2 || !(tolerance >= 0.0)) {
        return -EINVAL;
    }
    struct iso_eigenpairs *pairs = pairs_alloc(n, k);
    int error = pairs ? -EAGAIN : -ENOMEM;
    for (int32_t block = BLOCK; error == -EAGAIN && block <= BLOCK_MAX; block *= 2) {
        error = solve_with_blocks(stiffness, mass, block, tolerance, pairs);
    }
    if (error) {
        iso_eigenpairs_free(pairs);
        return error == -EAGAIN ? -ENOTRECOVERABLE : error;
    }
    *out = pairs;
    return 0;
}

void iso_eigenpairs_free(struct iso_eigenpairs *pairs)
{
    if (pairs) {
        free(pairs->lambda);
        free(pairs->phi);
        free(pairs);
    }
}
