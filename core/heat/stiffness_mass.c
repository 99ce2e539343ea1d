#include "isotherm/stiffness_mass.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

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

/* The rows of one column, the diagonal first: sorts them and removes repetitions. Returns how many
 * there are. */
static int32_t sort_unique(int32_t *row, int32_t n)
{
    for (int32_t i = 2; i < n; i++) {
        int32_t value = row[i], at = i;
        for (; at > 1 && row[at - 1] > value; at--) {
            row[at] = row[at - 1];
        }
        row[at] = value;
    }
    int32_t kept = 1;
    for (int32_t i = 1; i < n; i++) {
        if (row[i] != row[kept - 1]) {
            row[kept++] = row[i];
        }
    }
    return kept;
}

/* The pattern of a mesh: the diagonal and one entry for each edge. Each edge is first written once
 * for each of its triangles, in place; then repetitions are removed. */
static int make_pattern(const struct iso_mesh *mesh, struct iso_symmetric *a)
{
    const int32_t n = mesh->n_vertices;
    if (n > a->n_capacity || n + 3 * mesh->n_triangles > a->nnz_capacity) {
        return -ENOSPC;
    }
    int32_t *start = a->column_start;
    start[0] = 0;
    for (int32_t j = 0; j < n; j++) {
        start[j + 1] = 1;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t p = mesh->triangles[t][k], q = mesh->triangles[t][(k + 1) % 3];
            start[(p < q ? p : q) + 1]++;
        }
    }
    for (int32_t j = 0; j < n; j++) {
        start[j + 1] += start[j];
    }
    /* Filling moves each start to the end of its column. */
    for (int32_t j = 0; j < n; j++) {
        a->row[start[j]++] = j;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t p = mesh->triangles[t][k], q = mesh->triangles[t][(k + 1) % 3];
            a->row[start[p < q ? p : q]++] = p < q ? q : p;
        }
    }
    int32_t nnz = 0, from = 0;
    for (int32_t j = 0; j < n; j++) {
        int32_t to = start[j], count = sort_unique(&a->row[from], to - from);
        memmove(&a->row[nnz], &a->row[from], (size_t)count * sizeof *a->row);
        start[j] = nnz;
        nnz += count;
        from = to;
    }
    start[n] = nnz;
    a->n = n;
    a->nnz = nnz;
    memset(a->value, 0, (size_t)nnz * sizeof *a->value);
    return 0;
}

static void add_entry(struct iso_symmetric *a, int32_t i, int32_t j, double value)
{
    int32_t column = i < j ? i : j, row = i < j ? j : i, at = a->column_start[column];
    while (a->row[at] != row) {
        at++;
    }
    a->value[at] += value;
}

/* Densities at the corners of a triangle, and their mean. */
struct corner_density {
    double at[3], mean;
};

static struct corner_density density_of(const double *density, const int32_t *corner)
{
    struct corner_density h = {{1.0, 1.0, 1.0}, 1.0};
    if (density) {
        for (int k = 0; k < 3; k++) {
            h.at[k] = density[corner[k]];
        }
        h.mean = (h.at[0] + h.at[1] + h.at[2]) / 3.0;
    }
    return h;
}

/* Adds what one triangle contributes (linear elements, linear density). */
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
    const struct corner_density h = density_of(density, v);
    for (int k = 0; k < 3; k++) {
        int32_t p = v[(k + 1) % 3], q = v[(k + 2) % 3];
        /* Cotangent of the angle at corner k, between edges k + 1 and k + 2. */
        const double cotangent = -iso_dot(edge[(k + 1) % 3], edge[(k + 2) % 3]) / (2.0 * area);
        const double conducted = 0.5 * h.mean * cotangent;
        add_entry(stiffness, p, q, -conducted);
        add_entry(stiffness, p, p, conducted);
        add_entry(stiffness, q, q, conducted);
        if (kind == ISO_MASS_CONSISTENT) {
            const double opposite = h.at[(k + 1) % 3] + h.at[(k + 2) % 3];
            add_entry(mass, p, q, area * (opposite / 60.0 + h.mean / 20.0));
            add_entry(mass, v[k], v[k], area * (h.at[k] / 15.0 + h.mean / 10.0));
        } else { /* lumped: the sum of a row of the consistent matrix */
            add_entry(mass, v[k], v[k], area * (h.at[k] / 12.0 + h.mean / 4.0));
        }
    }
}

/* Gives `mass` the pattern of `stiffness`, with zeros in it. */
static int copy_pattern(const struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    if (stiffness->nnz > mass->nnz_capacity) {
        return -ENOSPC;
    }
    mass->n = stiffness->n;
    mass->nnz = stiffness->nnz;
    memcpy(mass->column_start, stiffness->column_start,
           ((size_t)mass->n + 1) * sizeof *mass->column_start);
    memcpy(mass->row, stiffness->row, (size_t)mass->nnz * sizeof *mass->row);
    memset(mass->value, 0, (size_t)mass->nnz * sizeof *mass->value);
    return 0;
}

/* A density of NULL is 1 everywhere. */
static int assemble_matrices(const struct iso_mesh *mesh, enum iso_mass kind, const double *density,
                             struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    if (mesh->n_vertices < 1 || iso_mesh_check(mesh, NULL)) {
        return -EINVAL;
    }
    if (mesh->n_vertices > mass->n_capacity) {
        return -ENOSPC;
    }
    int error = make_pattern(mesh, stiffness);
    if (!error) {
        error = copy_pattern(stiffness, mass);
    }
    if (error) {
        return error;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        add_triangle(mesh, t, kind, density, stiffness, mass);
    }
    for (int32_t i = 0; i < mass->n; i++) {
        double *diagonal = &mass->value[mass->column_start[i]];
        *diagonal = *diagonal > 0.0 ? *diagonal : 1.0; /* 1 for a vertex without a triangle */
    }
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
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        if (!(density[i] > 0.0) || !isfinite(density[i])) {
            return -EINVAL;
        }
    }
    return assemble_matrices(mesh, kind, density, stiffness, mass);
}
