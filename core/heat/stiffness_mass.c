#include "isotherm/stiffness_mass.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/elements.h"

int iso_symmetric_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_symmetric **out)
{
    if (n_capacity < 1 || nnz_capacity < n_capacity) {
        return -EINVAL;
    }
    struct iso_symmetric *a = calloc(1, sizeof *a);
    if (!a) {
        return -ENOMEM;
    }
    a->n_capacity = n_capacity;
    a->nnz_capacity = nnz_capacity;
    a->column_start = calloc((size_t)n_capacity + 1, sizeof *a->column_start);
    a->row = calloc((size_t)nnz_capacity, sizeof *a->row);
    a->value = calloc((size_t)nnz_capacity, sizeof *a->value);
    if (!a->column_start || !a->row || !a->value) {
        iso_symmetric_free(a);
        return -ENOMEM;
    }
    *out = a;
    return 0;
}

void iso_symmetric_free(struct iso_symmetric *matrix)
{
    if (matrix) {
        free(matrix->column_start);
        free(matrix->row);
        free(matrix->value);
        free(matrix);
    }
}

void iso_symmetric_multiply(const struct iso_symmetric *a, const double *x, double *y)
{
    memset(y, 0, (size_t)a->n * sizeof *y);
    for (int32_t j = 0; j < a->n; j++) {
        int32_t at = a->column_start[j];
        double sum = a->value[at] * x[j];
        for (at++; at < a->column_start[j + 1]; at++) {
            const int32_t i = a->row[at];
            y[i] += a->value[at] * x[j];
            sum += a->value[at] * x[i];
        }
        y[j] += sum;
    }
}

/* Adds what one triangle contributes. */
static void add_triangle(const struct iso_mesh *mesh, int32_t t, enum iso_mass kind,
                         const double *density, struct iso_symmetric *stiffness,
                         struct iso_symmetric *mass)
{
    const int32_t *v = mesh->triangles[t];
    struct iso_vec3 edge[3]; /* opposite to corner k */
    double longest = 0.0;
    for (int k = 0; k < 3; k++) {
        edge[k] = iso_sub(mesh->vertices_mm[v[(k + 2) % 3]], mesh->vertices_mm[v[(k + 1) % 3]]);
        longest = fmax(longest, iso_dot(edge[k], edge[k]));
    }
    const double area = 0.5 * iso_norm(iso_cross(edge[0], edge[1]));
    if (!(area >= 1e-12 * longest) || longest == 0.0) {
        return;
    }
    struct iso_element element = {.corner = {v[0], v[1], v[2]}, .area = area};
    for (int k = 0; k < 3; k++) {
        /* The angle at corner k is between edges k + 1 and k + 2. */
        element.cotangent[k] = -iso_dot(edge[(k + 1) % 3], edge[(k + 2) % 3]) / (2.0 * area);
    }
    iso_element_add(&element, kind, density, stiffness, mass);
}

/* A density of NULL is 1 everywhere. */
static int assemble_matrices(const struct iso_mesh *mesh, enum iso_mass kind, const double *density,
                             struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    if (mesh->n_vertices < 1 || iso_mesh_check(mesh, NULL)) {
        return -EINVAL;
    }
    const int error = iso_elements_begin(mesh->n_vertices, (const int32_t(*)[3])mesh->triangles,
                                         mesh->n_triangles, stiffness, mass);
    if (error) {
        return error;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        add_triangle(mesh, t, kind, density, stiffness, mass);
    }
    iso_elements_end(mass);
    return 0;
}

int iso_stiffness_mass(const struct iso_mesh *mesh, enum iso_mass kind,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    return assemble_matrices(mesh, kind, NULL, stiffness, mass);
}

int iso_stiffness_mass_weighted(const struct iso_mesh *mesh, enum iso_mass kind,
                                const double *density, struct iso_symmetric *stiffness,
                                struct iso_symmetric *mass)
{
    return iso_elements_density_is_good(density, mesh->n_vertices)
               ? assemble_matrices(mesh, kind, density, stiffness, mass)
               : -EINVAL;
}
