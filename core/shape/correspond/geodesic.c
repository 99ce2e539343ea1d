#include "isotherm/correspondence.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/factor.h"

/* The Poisson problem is made definite by this share of the mass, in units of 1 / area. A constant
 * is the only function that it changes noticeably, and the constant is chosen afterwards. */
static const double pinning = 1e-8;

struct iso_geodesic {
    const struct iso_shape *shape;
    struct iso_symmetric *stiffness, *mass; /* mass lumped, so that the heat stays positive */
    struct iso_factor *heat, *poisson;
    double *work; /* [n]: the heat, then its gradient's divergence */
};

static double mean_edge(const struct iso_mesh *mesh)
{
    double sum = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        for (int k = 0; k < 3; k++) {
            sum += iso_norm(iso_sub(mesh->vertices_mm[v[(k + 1) % 3]], mesh->vertices_mm[v[k]]));
        }
    }
    return sum / (3.0 * mesh->n_triangles);
}

static int assemble(struct iso_geodesic *g)
{
    const struct iso_mesh *mesh = g->shape->mesh;
    const int32_t n = mesh->n_vertices, nnz = n + 3 * mesh->n_triangles;
    int error = iso_symmetric_new(n, nnz, &g->stiffness);
    if (!error) {
        error = iso_symmetric_new(n, nnz, &g->mass);
    }
    if (!error) {
        error = iso_stiffness_mass(mesh, ISO_MASS_LUMPED, g->stiffness, g->mass);
    }
    if (!error) {
        error = iso_factor_new(n, nnz, &g->heat);
    }
    if (!error) {
        error = iso_factor_new(n, nnz, &g->poisson);
    }
    return error;
}

int iso_geodesic_new(const struct iso_shape *shape, struct iso_geodesic **out)
{
    struct iso_geodesic *g = calloc(1, sizeof *g);
    if (!g) {
        return -ENOMEM;
    }
    const double edge = mean_edge(shape->mesh);
    g->shape = shape;
    g->work = calloc((size_t)shape->mesh->n_vertices, sizeof *g->work);
    int error = g->work ? assemble(g) : -ENOMEM;
    if (!error) {
        error = iso_factor_compute(g->heat, edge * edge, g->stiffness, 1.0, g->mass);
    }
    if (!error) {
        error = iso_factor_compute(g->poisson, 1.0, g->stiffness, pinning / shape->total_area,
                                   g->mass);
    }
    if (error) {
        iso_geodesic_free(g);
        return error;
    }
    *out = g;
    return 0;
}

void iso_geodesic_free(struct iso_geodesic *geodesic)
{
    if (geodesic) {
        iso_symmetric_free(geodesic->stiffness);
        iso_symmetric_free(geodesic->mass);
        iso_factor_free(geodesic->heat);
        iso_factor_free(geodesic->poisson);
        free(geodesic->work);
        free(geodesic);
    }
}

/* Adds the divergence of one triangle's unit field to `out`: the integral of X . grad(hat_i), where
 * grad(hat_i) = (normal x opposite edge) / (2 area). */
static void add_triangle(const struct iso_mesh *mesh, int32_t t, const double *heat, double *out)
{
    const int32_t *v = mesh->triangles[t];
    struct iso_vec3 across[3], field = {0};
    struct iso_vec3 edge[3];
    for (int k = 0; k < 3; k++) {
        edge[k] = iso_sub(mesh->vertices_mm[v[(k + 2) % 3]], mesh->vertices_mm[v[(k + 1) % 3]]);
    }
    const struct iso_vec3 normal = iso_cross(edge[0], edge[1]);
    const double twice = iso_norm(normal);
    if (!(twice > 0.0)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        across[k] = iso_scale(1.0 / twice, iso_cross(normal, edge[k])); /* 2 area grad(hat_k) */
        field = iso_sub(field, iso_scale(heat[v[k]], across[k]));
    }
    const double length = iso_norm(field);
    for (int k = 0; k < 3 && length > 0.0; k++) {
        out[v[k]] += 0.5 * iso_dot(field, across[k]) / length;
    }
}

int iso_geodesic_distance(struct iso_geodesic *g, int32_t vertex, double *distance)
{
    const struct iso_mesh *mesh = g->shape->mesh;
    const size_t n = (size_t)mesh->n_vertices;
    if (vertex < 0 || vertex >= mesh->n_vertices) {
        return -EINVAL;
    }
    double *divergence = calloc(n, sizeof *divergence);
    if (!divergence) {
        return -ENOMEM;
    }
    memset(g->work, 0, n * sizeof *g->work);
    g->work[vertex] = 1.0;
    int error = iso_factor_solve(g->heat, g->work, 1, g->work);
    if (!error) {
        for (int32_t t = 0; t < mesh->n_triangles; t++) {
            add_triangle(mesh, t, g->work, divergence);
        }
        error = iso_factor_solve(g->poisson, divergence, 1, divergence);
    }
    const double zero = divergence[vertex];
    for (size_t i = 0; i < n && !error; i++) {
        distance[i] = fmax(divergence[i] - zero, 0.0);
    }
    free(divergence);
    return error;
}
