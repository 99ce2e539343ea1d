#include "core/heat/heat_kernel.h"

#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/factor.h"

/* With A = B^-1 L and S = (I + gamma A)^-1 = (B + gamma L)^-1 B, self-adjoint in <u, v> = u' B v:
 *
 *   exp(-t A) B^-1 b = exp(-t A) S^-1 v = g(S) v,   v = (B + gamma L)^-1 b,
 *   g(s) = exp(-(t / gamma) (1 / s - 1)) / s.
 *
 * Lanczos from v gives S V = V T + ..., so that g(S) v ~ |v| V g(T) e1, for every t at once.
 * Starting from v rather than from B^-1 b (b a point load, which no mesh resolves) costs one solve
 * and is what lets a space of dimension 9 do.
 *
 * The constant function, along which heat is conserved, lies in that space only nearly. So the
 * coefficients c are given the least change that makes the total heat 1' B V c exactly 1. */

/* Sources that are worked on together: CHOLMOD solves for four columns in one pass. */
enum { BLOCK = 4, KRYLOV_DEFAULT = 9 };

static const double gamma_over_t_default = 0.15;

struct iso_heat_direct {
    struct iso_heat_direct_options options;
    struct iso_factor *factor;
    double *v;     /* [krylov + 1][BLOCK][n]: Lanczos vectors */
    double *bv;    /* the same times B */
    double *alpha; /* [BLOCK][krylov]: diagonal of T */
    double *beta;  /* [BLOCK][krylov + 1]: beta[0] = |v|, then below the diagonal */
    double *total; /* [BLOCK][krylov]: 1' B v, the heat in each Lanczos vector */
};

int iso_heat_direct_new(const struct iso_heat_direct_options *options, struct iso_heat_direct **out)
{
    struct iso_heat_direct_options o = *options;
    o.krylov = o.krylov ? o.krylov : KRYLOV_DEFAULT;
    o.gamma_over_t = o.gamma_over_t != 0.0 ? o.gamma_over_t : gamma_over_t_default;
    if (o.n_capacity < 1 || o.nnz_capacity < o.n_capacity || o.krylov < 2 ||
        o.krylov > ISO_HEAT_KRYLOV_MAX || !(o.gamma_over_t > 0.0) || !isfinite(o.gamma_over_t)) {
        return -EINVAL;
    }
    struct iso_heat_direct *h = calloc(1, sizeof *h);
    if (!h) {
        return -ENOMEM;
    }
    h->options = o;
    size_t vectors = (size_t)(o.krylov + 1) * BLOCK * (size_t)o.n_capacity;
    h->v = calloc(vectors, sizeof *h->v);
    h->bv = calloc(vectors, sizeof *h->bv);
    h->alpha = calloc((size_t)o.krylov * BLOCK, sizeof *h->alpha);
    h->beta = calloc((size_t)(o.krylov + 1) * BLOCK, sizeof *h->beta);
    h->total = calloc((size_t)o.krylov * BLOCK, sizeof *h->total);
    int error = h->v && h->bv && h->alpha && h->beta && h->total ? 0 : -ENOMEM;
    error = error ? error : iso_factor_new(o.n_capacity, o.nnz_capacity, &h->factor);
    if (error) {
        iso_heat_direct_free(h);
        return error;
    }
    *out = h;
    return 0;
}

void iso_heat_direct_free(struct iso_heat_direct *solver)
{
    if (solver) {
        iso_factor_free(solver->factor);
        free(solver->v);
        free(solver->bv);
        free(solver->alpha);
        free(solver->beta);
        free(solver->total);
        free(solver);
    }
}

/* Four sums side by side, since one alone waits for each addition in turn. */
static double dot(const double *a, const double *b, int32_t n)
{
    double sum[4] = {0};
    int32_t i = 0;
    for (; i + 4 <= n; i += 4) {
        for (int k = 0; k < 4; k++) {
            sum[k] += a[i + k] * b[i + k];
        }
    }
    for (; i < n; i++) {
        sum[0] += a[i] * b[i];
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
}

static void add_scaled(double *y, double s, const double *x, int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        y[i] += s * x[i];
    }
}

/* Lanczos vector j of source s in the block, in one of the two stores. */
static double *vector(double *store, int j, int s, int32_t n)
{
    return &store[((size_t)j * BLOCK + (size_t)s) * (size_t)n];
}

/* Divides vector j by its norm, which goes to beta, and keeps its product with B. A norm of nothing
 * means that the space is exhausted: the vector becomes 0 and so does all that follows. */
static void normalise(struct iso_heat_direct *h, const struct iso_symmetric *mass, int j, int s)
{
    int m = h->options.krylov;
    double *v = vector(h->v, j, s, mass->n), *bv = vector(h->bv, j, s, mass->n), total = 0.0;
    iso_symmetric_multiply(mass, v, bv);
    double norm = sqrt(fmax(dot(v, bv, mass->n), 0.0));
    double scale = norm > 1e-150 ? 1.0 / norm : 0.0;
    for (int32_t i = 0; i < mass->n; i++) {
        v[i] *= scale;
        bv[i] *= scale;
        total += bv[i];
    }
    h->beta[s * (m + 1) + j] = scale > 0.0 ? norm : 0.0;
    h->total[s * m + j] = total;
}

/* Makes of S v_j, which vector j + 1 holds, the next Lanczos vector, with full orthogonalisation.
 */
static void advance(struct iso_heat_direct *h, const struct iso_symmetric *mass, int j, int s)
{
    int m = h->options.krylov;
    int32_t n = mass->n;
    double *w = vector(h->v, j + 1, s, n);
    h->alpha[s * m + j] = dot(w, vector(h->bv, j, s, n), n);
    if (j + 1 == m) {
        return;
    }
    add_scaled(w, -h->alpha[s * m + j], vector(h->v, j, s, n), n);
    for (int i = j - 1; i >= 0; i--) {
        add_scaled(w, -dot(w, vector(h->bv, i, s, n), n), vector(h->v, i, s, n), n);
    }
    normalise(h, mass, j + 1, s);
}

/* Builds the Krylov spaces of a block of sources. */
static int build_krylov(struct iso_heat_direct *h, const struct iso_mesh *mesh,
                        const struct iso_symmetric *mass, const struct iso_surface_point *sources,
                        int n_sources)
{
    int32_t n = mass->n;
    double *load = vector(h->bv, 0, 0, n);
    memset(load, 0, (size_t)n_sources * (size_t)n * sizeof *load);
    for (int s = 0; s < n_sources; s++) {
        for (int k = 0; k < 3; k++) {
            vector(h->bv, 0, s, n)[mesh->triangles[sources[s].triangle][k]] += sources[s].weight[k];
        }
    }
    int error = iso_factor_solve(h->factor, load, n_sources, vector(h->v, 0, 0, n));
    for (int s = 0; s < n_sources && !error; s++) {
        normalise(h, mass, 0, s);
    }
    for (int j = 0; j < h->options.krylov && !error; j++) {
        error = iso_factor_solve(h->factor, vector(h->bv, j, 0, n), n_sources,
                                 vector(h->v, j + 1, 0, n));
        for (int s = 0; s < n_sources && !error; s++) {
            advance(h, mass, j, s);
        }
    }
    return error;
}

/* The least change of the coefficients that makes the total heat 1. */
static void conserve(const double *total, int m, double *c)
{
    double heat = dot(total, c, m), square = dot(total, total, m);
    add_scaled(c, square > 0.0 ? (1.0 - heat) / square : 0.0, total, m);
}

/* Coefficients of the heat column in the Lanczos vectors: c = |v| g(T) e1, conserving heat. */
static int coefficients(const struct iso_heat_direct *h, int s, double t_mm2, double gamma,
                        double c[ISO_HEAT_KRYLOV_MAX])
{
    int m = h->options.krylov;
    const double *beta = &h->beta[s * (m + 1)];
    double d[ISO_HEAT_KRYLOV_MAX], e[ISO_HEAT_KRYLOV_MAX];
    double z[ISO_HEAT_KRYLOV_MAX * ISO_HEAT_KRYLOV_MAX], work[2 * ISO_HEAT_KRYLOV_MAX];
    memcpy(d, &h->alpha[s * m], (size_t)m * sizeof *d);
    memcpy(e, &beta[1], (size_t)(m - 1) * sizeof *e);
    if (LAPACKE_dstev_work(LAPACK_COL_MAJOR, 'V', m, d, e, z, m, work) != 0) {
        return -EDOM;
    }
    for (int i = 0; i < m; i++) {
        c[i] = 0.0;
    }
    for (int j = 0; j < m; j++) {
        /* The spectrum of S lies in (0, 1]; g vanishes as s goes to 0. */
        double theta = fmin(d[j], 1.0);
        double g = theta > 1e-8 ? exp(-(t_mm2 / gamma) * (1.0 / theta - 1.0)) / theta : 0.0;
        for (int i = 0; i < m; i++) {
            c[i] += beta[0] * g * z[j * m] * z[j * m + i];
        }
    }
    conserve(&h->total[s * m], m, c);
    return 0;
}

static bool request_sane(const struct iso_mesh *mesh, const struct iso_symmetric *mass,
                         const struct iso_surface_point *sources, int n_sources,
                         const double *t_mm2, int n_times)
{
    bool sane = n_sources >= 1 && n_times >= 1 && mesh->n_vertices == mass->n;
    for (int s = 0; sane && s < n_sources; s++) {
        sane = sources[s].triangle >= 0 && sources[s].triangle < mesh->n_triangles;
    }
    for (int j = 0; sane && j < n_times; j++) {
        sane = t_mm2[j] > 0.0 && isfinite(t_mm2[j]);
    }
    return sane;
}

int iso_heat_direct(struct iso_heat_direct *h, const struct iso_mesh *mesh,
                    const struct iso_symmetric *stiffness, const struct iso_symmetric *mass,
                    const struct iso_surface_point *sources, int n_sources, const double *t_mm2,
                    int n_times, double *out)
{
    if (!request_sane(mesh, mass, sources, n_sources, t_mm2, n_times)) {
        return -EINVAL;
    }
    double t_max = 0.0;
    for (int j = 0; j < n_times; j++) {
        t_max = fmax(t_max, t_mm2[j]);
    }
    double gamma = h->options.gamma_over_t * t_max;
    int error = iso_factor_compute(h->factor, gamma, stiffness, 1.0, mass);
    size_t n = (size_t)mass->n;
    for (int first = 0; first < n_sources && !error; first += BLOCK) {
        int block = n_sources - first < BLOCK ? n_sources - first : BLOCK;
        error = build_krylov(h, mesh, mass, &sources[first], block);
        for (int s = 0; s < block && !error; s++) {
            for (int j = 0; j < n_times && !error; j++) {
                double c[ISO_HEAT_KRYLOV_MAX];
                error = coefficients(h, s, t_mm2[j], gamma, c);
                double *column = &out[((size_t)(first + s) * (size_t)n_times + (size_t)j) * n];
                memset(column, 0, n * sizeof *column);
                for (int i = 0; i < h->options.krylov && !error; i++) {
                    add_scaled(column, c[i], vector(h->v, i, s, mass->n), mass->n);
                }
            }
        }
    }
    return error;
}
