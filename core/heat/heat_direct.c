#include "isotherm/heat_kernel.h"

#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/heat/block.h"
#include "core/heat/factor.h"
#include "core/heat/permuted.h"

/* With A = B^-1 L and S = (I + gamma A)^-1 = (B + gamma L)^-1 B, self-adjoint in <u, v> = u' B v:
 *
 *   exp(-t A) B^-1 b = exp(-t A) S^-1 v = g(S) v,   v = (B + gamma L)^-1 b,
 *   g(s) = exp(-(t / gamma) (1 / s - 1)) / s.
 *
 * Lanczos from v gives S V = V T + ..., so that g(S) v ~ |v| V g(T) e1, for every t at once. It
 * starts from v and not from B^-1 b, because b is a point load, which no mesh resolves. This costs
 * one more solve, but a space of dimension 9 is then enough.
 *
 * Vectors are not orthogonalised again beyond the recurrence of three terms. They lose their
 * orthogonality as Ritz values converge, which delays g(T) e1 but does not spoil it (Druskin,
 * Greenbaum and Knizhnerman, Using nonorthogonal Lanczos vectors in the computation of matrix
 * functions, 1998).
 *
 * The constant function, along which heat is conserved, lies only nearly in that space. The
 * coefficients c therefore get the least change that makes the total heat 1' B V c exactly 1.
 *
 * All sources of a block take each step together (block.h), in the factor's order of the vertices.
 * A Lanczos vector v is stored as u and a number `scale` with v = scale u, so that no pass over the
 * vectors is needed for the division by a norm. The diagonal of T, v' B S v, is the energy that the
 * solver returns. */

enum { KRYLOV_DEFAULT = 9 };

static const double gamma_over_t_default = 0.15;

/* The Krylov spaces of a block of sources. */
struct spaces {
    double alpha[ISO_HEAT_KRYLOV_MAX][ISO_BLOCK_MAX]; /* diagonal of T */
    double beta[ISO_HEAT_KRYLOV_MAX][ISO_BLOCK_MAX];  /* [0] is |v|, then below the diagonal */
    double scale[ISO_HEAT_KRYLOV_MAX][ISO_BLOCK_MAX]; /* v = scale u; 0 for an exhausted space */
    double total[ISO_HEAT_KRYLOV_MAX][ISO_BLOCK_MAX]; /* 1' B v, the heat in each Lanczos vector */
};

struct iso_heat_direct {
    struct iso_heat_direct_options options;
    const struct iso_block_ops *ops;
    struct iso_factor *factor;
    struct iso_permuted *mass; /* in the factor's order */
    bool *reached;             /* [n]: the supernodes that the loads reach */
    double *u;                 /* [krylov + 1] blocks: the Lanczos vectors, then working memory */
    struct spaces spaces;
};

/* The data of a call. */
struct work {
    struct iso_ldl ldl;
    struct iso_rows mass;
    const int32_t *order; /* of the vertices */
    int width;            /* of the block */
    double gamma;
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
    h->ops = iso_block_ops();
    h->u = calloc((size_t)(o.krylov + 1) * ISO_BLOCK_MAX * (size_t)o.n_capacity, sizeof *h->u);
    h->reached = calloc((size_t)o.n_capacity, sizeof *h->reached);
    int error = h->u && h->reached ? 0 : -ENOMEM;
    if (!error) {
        error = iso_factor_new(o.n_capacity, o.nnz_capacity, &h->factor);
    }
    if (!error) {
        error = iso_permuted_new(o.n_capacity, o.nnz_capacity, &h->mass);
    }
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
        iso_permuted_free(solver->mass);
        free(solver->reached);
        iso_wipe_free(solver->u);
        free(solver);
    }
}

/* Vectors in a block, those without a source included. */
static int lanes_of(const struct work *w)
{
    return w->width * ISO_DOUBLES;
}

/* Block j of the Lanczos vectors. */
static double *block_at(const struct iso_heat_direct *h, const struct work *w, int j)
{
    return &h->u[(size_t)j * (size_t)w->mass.n * (size_t)lanes_of(w)];
}

/* Writes the unit loads of the sources to block 0, one to each vector, and finds the supernodes
 * that they reach. Vectors without a source are 0. */
static void put_loads(struct iso_heat_direct *h, const struct iso_mesh *mesh,
                      const struct iso_surface_point *sources, int n_sources, const struct work *w)
{
    const size_t lanes = (size_t)lanes_of(w);
    double *load = block_at(h, w, 0);
    memset(load, 0, (size_t)w->mass.n * lanes * sizeof *load);
    memset(h->reached, 0, (size_t)w->ldl.nodes->count * sizeof *h->reached);
    for (int s = 0; s < n_sources; s++) {
        for (int k = 0; k < 3; k++) {
            const int32_t row = h->mass->place[mesh->triangles[sources[s].triangle][k]];
            load[(size_t)row * lanes + (size_t)s] += sources[s].weight[k];
            iso_ldl_reach(w->ldl.nodes, row, h->reached);
        }
    }
}

/* Sets the entry of T and the scale of the next vector from the square of |u|. A norm of 0 means
 * that the space is exhausted; everything that follows becomes 0. */
static void measure_next(struct spaces *k, int j, const struct work *w, const double *square,
                         const double *total)
{
    for (int s = 0; s < lanes_of(w); s++) {
        const double norm = sqrt(fmax(square[s], 0.0));
        k->scale[j][s] = norm > 1e-150 ? 1.0 / norm : 0.0;
        k->beta[j][s] = k->scale[j][s] > 0.0 ? norm : 0.0;
        k->total[j][s] = k->scale[j][s] * total[s];
    }
}

/* Builds the Krylov spaces of the loads that block 0 holds. The loads are 0 in most rows, which
 * spares most of the first forward substitution, and of the last solve only the energy is wanted.
 */
static void build_krylov(struct iso_heat_direct *h, const struct work *w)
{
    struct spaces *k = &h->spaces;
    double energy[ISO_BLOCK_MAX], square[ISO_BLOCK_MAX], total[ISO_BLOCK_MAX];
    h->ops->forward(&w->ldl, h->reached, w->width, block_at(h, w, 0));
    h->ops->backward(&w->ldl, w->width, block_at(h, w, 0), energy);
    for (int j = 0;; j++) {
        const bool last = j + 1 == h->options.krylov;
        double *u = block_at(h, w, j), *next = block_at(h, w, j + 1);
        h->ops->multiply(&w->mass, w->width, u, next, square, total);
        measure_next(k, j, w, square, total);
        h->ops->forward(&w->ldl, NULL, w->width, next);
        if (last) {
            h->ops->measure(&w->ldl, w->width, next, energy);
        } else {
            h->ops->backward(&w->ldl, w->width, next, energy);
        }
        double weight[3][ISO_BLOCK_MAX]; /* of S u, u and the vector before u */
        for (int s = 0; s < lanes_of(w); s++) {
            const double scale = k->scale[j][s];
            k->alpha[j][s] = scale * scale * energy[s];
            weight[0][s] = scale;
            weight[1][s] = -k->alpha[j][s] * scale;
            weight[2][s] = j > 0 ? -k->beta[j][s] * k->scale[j - 1][s] : 0.0;
        }
        if (last) {
            return;
        }
        h->ops->mix(w->mass.n, w->width, weight, u, block_at(h, w, j > 0 ? j - 1 : 0), next);
    }
}

/* The least change of the coefficients that makes the total heat 1. */
static void conserve_heat(const double *total, int m, double *c)
{
    double heat = 0.0, square = 0.0;
    for (int i = 0; i < m; i++) {
        heat += total[i] * c[i];
        square += total[i] * total[i];
    }
    for (int i = 0; i < m && square > 0.0; i++) {
        c[i] += (1.0 - heat) / square * total[i];
    }
}

/* The coefficients of the heat column of source s in the Lanczos vectors, c = |v| g(T) e1, changed
 * so that heat is conserved. `weight` receives them times the scale, for the vectors as they are
 * stored. */
static int coefficients_of(const struct iso_heat_direct *h, int s, double t_mm2, double gamma,
                           double (*weight)[ISO_BLOCK_MAX])
{
    const int m = h->options.krylov;
    const struct spaces *k = &h->spaces;
    double d[ISO_HEAT_KRYLOV_MAX], e[ISO_HEAT_KRYLOV_MAX], total[ISO_HEAT_KRYLOV_MAX];
    double z[ISO_HEAT_KRYLOV_MAX * ISO_HEAT_KRYLOV_MAX], work[2 * ISO_HEAT_KRYLOV_MAX];
    double c[ISO_HEAT_KRYLOV_MAX] = {0};
    for (int i = 0; i < m; i++) {
        d[i] = k->alpha[i][s];
        e[i] = i + 1 < m ? k->beta[i + 1][s] : 0.0;
        total[i] = k->total[i][s];
    }
    if (LAPACKE_dstev_work(LAPACK_COL_MAJOR, 'V', m, d, e, z, m, work) != 0) {
        return -EDOM;
    }
    for (int j = 0; j < m; j++) {
        /* The spectrum of S lies in (0, 1]; g vanishes as s goes to 0. */
        const double theta = fmin(d[j], 1.0);
        const double g = theta > 1e-8 ? exp(-(t_mm2 / gamma) * (1.0 / theta - 1.0)) / theta : 0.0;
        for (int i = 0; i < m; i++) {
            c[i] += k->beta[0][s] * g * z[j * m] * z[j * m + i];
        }
    }
    conserve_heat(total, m, c);
    for (int i = 0; i < m; i++) {
        weight[i][s] = c[i] * k->scale[i][s];
    }
    return 0;
}

/* Writes the heat columns of a block at one time; that of source s begins at out[s * stride]. */
static int put_columns(struct iso_heat_direct *h, const struct work *w, int n_sources, double t_mm2,
                       double *out, size_t stride)
{
    const int m = h->options.krylov, lanes = lanes_of(w);
    double weight[ISO_HEAT_KRYLOV_MAX][ISO_BLOCK_MAX] = {{0}};
    int error = 0;
    for (int s = 0; s < n_sources && !error; s++) {
        error = coefficients_of(h, s, t_mm2, w->gamma, weight);
    }
    if (error) {
        return error;
    }
    double *sum = block_at(h, w, m);
    h->ops->combine(w->mass.n, w->width, h->u, m, (const double(*)[ISO_BLOCK_MAX])weight, sum);
    for (int32_t i = 0; i < w->mass.n; i++) {
        double *to = &out[w->order[i]];
        for (int s = 0; s < n_sources; s++) {
            to[(size_t)s * stride] = sum[(size_t)i * (size_t)lanes + (size_t)s];
        }
    }
    return 0;
}

static bool request_sane(const struct iso_mesh *mesh, const struct iso_symmetric *mass,
                         const struct iso_surface_point *sources, int n_sources,
                         const double *t_mm2, int n_times)
{
    bool sane = n_sources >= 1 && n_times >= 1 && mesh->n_vertices == mass->n;
    for (int s = 0; sane && s < n_sources; s++) {
        const double *weight = sources[s].weight;
        sane = sources[s].triangle >= 0 && sources[s].triangle < mesh->n_triangles &&
               isfinite(weight[0] + weight[1] + weight[2]);
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
    struct work w = {.gamma = h->options.gamma_over_t * t_max};
    int error = iso_factor_compute(h->factor, w.gamma, stiffness, 1.0, mass);
    if (!error) {
        error = iso_factor_ldl(h->factor, &w.ldl, &w.order);
    }
    if (!error) {
        error = iso_permuted_fill(h->mass, mass, w.order, &w.mass);
    }
    const size_t stride = (size_t)n_times * (size_t)mass->n;
    for (int first = 0; first < n_sources && !error; first += ISO_BLOCK_MAX) {
        const int left = n_sources - first, n_block = left < ISO_BLOCK_MAX ? left : ISO_BLOCK_MAX;
        w.width = (n_block + ISO_DOUBLES - 1) / ISO_DOUBLES;
        put_loads(h, mesh, &sources[first], n_block, &w);
        build_krylov(h, &w);
        for (int j = 0; j < n_times && !error; j++) {
            double *column = &out[(size_t)first * stride + (size_t)j * (size_t)mass->n];
            error = put_columns(h, &w, n_block, t_mm2[j], column, stride);
        }
    }
    return error;
}
