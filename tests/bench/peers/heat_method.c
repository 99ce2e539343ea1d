#include "tests/bench/peers/heat_method.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/grid/heat_grid.h"
#include "core/isotherm/grid_isotherm.h"
#include "isotherm/heat_kernel.h"
#include "tests/bench/peers/heat_arpack.h"
#include "tests/bench/peers/heat_peers.h"

enum { EIGENPAIRS = 100, EULER_STEPS = 8 };

/* The landmarks of the mean face: x and y in the face frame. */
static const double place_mm[ISO_LANDMARKS][2] = {
    [ISO_LM_NASION] = {0.1, 41.0},      [ISO_LM_NOSE_TIP] = {0.3, 0.4},
    [ISO_LM_SUBNASALE] = {-0.2, -14.0}, [ISO_LM_ALA_R] = {-15.5, -6.0},
    [ISO_LM_ALA_L] = {15.3, -6.2},      [ISO_LM_EYE_IN_R] = {-17.4, 33.0},
    [ISO_LM_EYE_IN_L] = {17.3, 33.1},   [ISO_LM_EYE_OUT_R] = {-45.2, 34.9},
    [ISO_LM_EYE_OUT_L] = {45.1, 35.2},  [ISO_LM_LIP_UPPER] = {0.4, -26.3},
    [ISO_LM_MOUTH_R] = {-24.4, -33.7},  [ISO_LM_MOUTH_L] = {24.6, -33.5},
};

struct heat_case heat_case_of(double n_vertices)
{
    struct heat_case c = {
        .surface = grid_surface_mean_face(sqrt(28000.0 / n_vertices)),
        .t_mm2 = 100.0,
        .radius_mm = 18.0,
        .n_points = 32,
    };
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        c.source[l] = grid_surface_mesh_point(&c.surface, place_mm[l][0], place_mm[l][1]);
        c.grid_source[l] = grid_surface_point(&c.surface, place_mm[l][0], place_mm[l][1]);
        c.centre_mm[l] = iso_mesh_point_at(c.surface.mesh, c.source[l]);
    }
    return c;
}

void heat_case_done(struct heat_case *c)
{
    grid_surface_done(&c->surface);
}

static void sample(const struct iso_tracer *curves, const struct heat_case *c, int landmark,
                   struct iso_isotherm *out)
{
    int curve = iso_tracer_enclosing(curves, c->centre_mm[landmark]);
    out->n = 0;
    if (curve < 0 || iso_isotherm_sample_polar(iso_tracer_curve(curves, curve),
                                               c->centre_mm[landmark], c->n_points, out)) {
        out->n = 0;
    }
}

int heat_isotherms_on_mesh(struct iso_tracer *tracer, const struct heat_case *c, const double *heat,
                           struct iso_isotherm out[ISO_LANDMARKS])
{
    const struct iso_mesh *mesh = c->surface.mesh;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        const double *column = &heat[(size_t)l * (size_t)mesh->n_vertices];
        double level;
        out[l].n = 0;
        if (iso_isotherm_level(mesh, column, c->radius_mm, &level) == 0 &&
            iso_tracer_run(tracer, mesh, (const int32_t(*)[3])c->surface.adjacent, column, level) >
                0) {
            sample(tracer, c, l, &out[l]);
        }
    }
    return 0;
}

/* ---- heat on the grid ---- */
struct on_grid {
    struct iso_heat_grid *solver;
    struct iso_grid_tracer *tracer;
};

static void close_grid(void *state)
{
    struct on_grid *g = state;
    if (g) {
        iso_heat_grid_free(g->solver);
        iso_grid_tracer_free(g->tracer);
        free(g);
    }
}

static void *open_grid(const struct heat_case *c)
{
    struct on_grid *g = calloc(1, sizeof *g);
    if (!g || iso_heat_grid_new(c->surface.grid, ISO_LANDMARKS, &g->solver) ||
        iso_grid_tracer_new(c->surface.grid, &g->tracer)) {
        close_grid(g);
        return NULL;
    }
    return g;
}

static int heat_on_grid(void *state, const struct heat_case *c)
{
    struct on_grid *g = state;
    const struct iso_heat_grid_request request = {
        .sources = c->grid_source,
        .n_sources = ISO_LANDMARKS,
        .t_mm2 = c->t_mm2,
        .radius_mm = c->radius_mm,
    };
    return iso_heat_grid(g->solver, c->surface.grid, &request);
}

static int isotherms_on_grid(void *state, const struct heat_case *c,
                             struct iso_isotherm out[ISO_LANDMARKS])
{
    struct on_grid *g = state;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_grid_field field = iso_heat_grid_column(g->solver, l);
        double level;
        out[l].n = 0;
        iso_grid_tracer_begin(g->tracer, c->surface.grid, &field);
        if (iso_grid_tracer_run(g->tracer, c->radius_mm, &level) > 0) {
            sample(iso_grid_tracer_curves(g->tracer), c, l, &out[l]);
        }
    }
    return 0;
}

double heat_grid_pixels(const void *state)
{
    const struct on_grid *g = state;
    return iso_heat_grid_effort(g->solver).pixels;
}

/* ---- the other methods: on the mesh, with matrices ---- */
struct on_mesh {
    struct iso_symmetric *stiffness, *mass;
    struct iso_heat_direct *direct;
    struct iso_tracer *tracer;
    double *load, *column; /* [ISO_LANDMARKS][n_vertices] */
    double *lambda, *phi;
};

static void close_mesh(void *state)
{
    struct on_mesh *m = state;
    if (m) {
        iso_symmetric_free(m->stiffness);
        iso_symmetric_free(m->mass);
        iso_heat_direct_free(m->direct);
        iso_tracer_free(m->tracer);
        free(m->load);
        free(m->column);
        free(m->lambda);
        free(m->phi);
        free(m);
    }
}

static void *open_mesh(const struct heat_case *c)
{
    const struct iso_mesh *mesh = c->surface.mesh;
    int32_t n = mesh->n_vertices, nnz = n + 3 * mesh->n_triangles;
    size_t values = ISO_LANDMARKS * (size_t)n;
    const struct iso_heat_direct_options options = {.n_capacity = n, .nnz_capacity = nnz};
    struct on_mesh *m = calloc(1, sizeof *m);
    if (!m || iso_symmetric_new(n, nnz, &m->stiffness) || iso_symmetric_new(n, nnz, &m->mass) ||
        iso_heat_direct_new(&options, &m->direct) ||
        iso_tracer_new(mesh->n_triangles, &m->tracer)) {
        close_mesh(m);
        return NULL;
    }
    m->load = calloc(values, sizeof *m->load);
    m->column = calloc(values, sizeof *m->column);
    m->lambda = calloc(EIGENPAIRS, sizeof *m->lambda);
    m->phi = calloc(EIGENPAIRS * (size_t)n, sizeof *m->phi);
    if (!m->load || !m->column || !m->lambda || !m->phi) {
        close_mesh(m);
        return NULL;
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int k = 0; k < 3; k++) {
            int32_t corner = mesh->triangles[c->source[l].triangle][k];
            m->load[(size_t)l * (size_t)n + (size_t)corner] += c->source[l].weight[k];
        }
    }
    return m;
}

static int assemble(struct on_mesh *m, const struct heat_case *c)
{
    return iso_stiffness_mass(c->surface.mesh, ISO_MASS_CONSISTENT, m->stiffness, m->mass);
}

static int heat_directly(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    int error = assemble(m, c);
    return error ? error
                 : iso_heat_direct(m->direct, c->surface.mesh, m->stiffness, m->mass, c->source,
                                   ISO_LANDMARKS, &c->t_mm2, 1, m->column);
}

static int heat_by_eigenpairs(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    struct iso_eigenpairs *pairs = NULL;
    int error = assemble(m, c);
    if (!error) {
        error = iso_eigenpairs_new(m->stiffness, m->mass, EIGENPAIRS, 1e-10, &pairs);
    }
    if (!error) {
        iso_heat_spectral(pairs, c->surface.mesh, c->source, ISO_LANDMARKS, &c->t_mm2, 1,
                          m->column);
        iso_eigenpairs_free(pairs);
    }
    return error;
}

static int isotherms_on_mesh(void *state, const struct heat_case *c,
                             struct iso_isotherm out[ISO_LANDMARKS])
{
    struct on_mesh *m = state;
    return heat_isotherms_on_mesh(m->tracer, c, m->column, out);
}

#if defined HAVE_ARPACK || defined HAVE_HEAT_PEERS
/* Below 0 by about the spacing of eigenvalues, 4 pi / area (Weyl 1911). */
static double shift_of(const struct heat_case *c)
{
    return -4.0 * M_PI / iso_mesh_area(c->surface.mesh);
}

static void columns_of(struct on_mesh *m, const struct heat_case *c)
{
    const struct iso_eigenpairs pairs = {m->stiffness->n, EIGENPAIRS, m->lambda, m->phi};
    iso_heat_spectral(&pairs, c->surface.mesh, c->source, ISO_LANDMARKS, &c->t_mm2, 1, m->column);
}
#endif

#ifdef HAVE_ARPACK
static int heat_by_arpack(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    int error = assemble(m, c);
    if (!error) {
        error = peer_arpack(m->stiffness, m->mass, EIGENPAIRS, shift_of(c), m->lambda, m->phi);
    }
    if (!error) {
        columns_of(m, c);
    }
    return error;
}
#endif

#ifdef HAVE_HEAT_PEERS
static struct peer_matrix matrix_of(const struct iso_symmetric *a)
{
    return (struct peer_matrix){a->n, a->nnz, a->column_start, a->row, a->value};
}

static struct peer_mesh mesh_of(const struct iso_mesh *mesh)
{
    return (struct peer_mesh){mesh->n_triangles,
                              (const double(*)[3])(const void *)mesh->vertices_mm,
                              (const int32_t(*)[3])mesh->triangles, iso_mesh_area(mesh)};
}

static int heat_by_spectra(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    int error = assemble(m, c);
    if (!error) {
        struct peer_matrix l = matrix_of(m->stiffness), b = matrix_of(m->mass);
        error = peer_spectra(&l, &b, EIGENPAIRS, shift_of(c), m->lambda, m->phi);
    }
    if (!error) {
        columns_of(m, c);
    }
    return error;
}

static int heat_by_euler(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    int error = assemble(m, c);
    struct peer_matrix l = matrix_of(m->stiffness), b = matrix_of(m->mass);
    return error ? error
                 : peer_backward_euler(&l, &b, c->t_mm2, EULER_STEPS, m->load, ISO_LANDMARKS,
                                       m->column);
}

/* Distances, converted to the heat of a plane at these distances. */
static int heat_by_distance(void *state, const struct heat_case *c)
{
    struct on_mesh *m = state;
    int error = assemble(m, c);
    if (!error) {
        struct peer_matrix l = matrix_of(m->stiffness), b = matrix_of(m->mass);
        struct peer_mesh mesh = mesh_of(c->surface.mesh);
        error = peer_heat_method(&mesh, &l, &b, m->load, ISO_LANDMARKS, m->column);
    }
    size_t values = ISO_LANDMARKS * (size_t)m->stiffness->n;
    for (size_t i = 0; i < values && !error; i++) {
        m->column[i] = exp(-m->column[i] * m->column[i] / (4.0 * c->t_mm2));
    }
    return error;
}
#endif

#define ON_MESH(heat) open_mesh, heat, isotherms_on_mesh, close_mesh

const struct heat_method heat_methods[] = {
    {"grid, Chebyshev", ISO_MASS_LUMPED, true, 50000, 0, open_grid, heat_on_grid, isotherms_on_grid,
     close_grid},
    {"mesh, LDL' and Lanczos", ISO_MASS_CONSISTENT, true, 1000000, 2, ON_MESH(heat_directly)},
    {"100 eigenpairs, own Lanczos", ISO_MASS_CONSISTENT, true, 50000, 0,
     ON_MESH(heat_by_eigenpairs)},
#ifdef HAVE_ARPACK
    {"100 eigenpairs, ARPACK", ISO_MASS_CONSISTENT, true, 50000, 0, ON_MESH(heat_by_arpack)},
#endif
#ifdef HAVE_HEAT_PEERS
    {"100 eigenpairs, Spectra", ISO_MASS_CONSISTENT, true, 50000, 0, ON_MESH(heat_by_spectra)},
    {"backward Euler, Eigen", ISO_MASS_CONSISTENT, true, 50000, 0, ON_MESH(heat_by_euler)},
    {"heat method, Eigen", ISO_MASS_CONSISTENT, false, 50000, 0, ON_MESH(heat_by_distance)},
#endif
};
const int n_heat_methods = sizeof heat_methods / sizeof heat_methods[0];
