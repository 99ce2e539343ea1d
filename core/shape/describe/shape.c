#include "isotherm/shape.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/heat/intrinsic/cloud.h"
#include "core/shape/describe/largest_part.h"

/* The relative residual of the eigenpairs; the error of the eigenvalues is about its square. */
static const double pairs_tolerance = 1e-8;

/* What a shape is made of, and so its matrices. */
enum surface { SURFACE_MESH, SURFACE_BAD_MESH, SURFACE_CLOUD };

static int assemble(enum surface surface, const struct iso_mesh *mesh, const double *density,
                    struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    switch (surface) {
    case SURFACE_BAD_MESH:
        return iso_stiffness_mass_robust(mesh, ISO_MASS_CONSISTENT, density, stiffness, mass);
    case SURFACE_CLOUD:
        return iso_stiffness_mass_cloud(mesh, ISO_MASS_CONSISTENT, density, stiffness, mass);
    default:
        return density ? iso_stiffness_mass_weighted(mesh, ISO_MASS_CONSISTENT, density, stiffness,
                                                     mass)
                       : iso_stiffness_mass(mesh, ISO_MASS_CONSISTENT, stiffness, mass);
    }
}

/* Whether a triangle belongs to the part whose vertices are 1 in `inside`. */
static bool is_inside(const struct iso_mesh *mesh, int32_t t, const double *inside, bool keep_flat)
{
    const int32_t *v = mesh->triangles[t];
    return inside[v[0]] > 0.0 && inside[v[1]] > 0.0 && inside[v[2]] > 0.0 &&
           (keep_flat || iso_triangle_has_area(mesh, t));
}

/* Copies the largest part with its colours. `parent`, and later `number`, use the same memory. */
static int copy_part(const struct iso_mesh *mesh, const struct iso_colour *colour, bool keep_flat,
                     int32_t *number, double *area, struct iso_shape *shape)
{
    int32_t best = iso_largest_part(mesh, number, area), n = 0, triangles = 0;
    if (best < 0) {
        return -ENODATA;
    }
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        area[v] = iso_part_root(number, v) == best ? 1.0 : 0.0;
        n += area[v] > 0.0;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        triangles += is_inside(mesh, t, area, keep_flat);
    }
    if (n < ISO_SHAPE_VERTICES_MIN) {
        return -ENODATA;
    }
    const int error = iso_mesh_new(n, triangles, &shape->mesh);
    shape->colour = colour ? calloc((size_t)n, sizeof *colour) : NULL;
    if (error || (colour && !shape->colour)) {
        return -ENOMEM;
    }
    struct iso_mesh *part = shape->mesh;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        number[v] = -1;
        if (area[v] > 0.0) {
            number[v] = part->n_vertices;
            part->vertices_mm[part->n_vertices] = mesh->vertices_mm[v];
            if (colour) {
                shape->colour[part->n_vertices] = colour[v];
            }
            part->n_vertices++;
        }
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        if (is_inside(mesh, t, area, keep_flat)) {
            for (int k = 0; k < 3; k++) {
                part->triangles[part->n_triangles][k] = number[mesh->triangles[t][k]];
            }
            part->n_triangles++;
        }
    }
    return 0;
}

static int take_part(const struct iso_mesh *mesh, const struct iso_colour *colour, bool keep_flat,
                     struct iso_shape *shape)
{
    const size_t n = (size_t)mesh->n_vertices + 1;
    int32_t *number = calloc(n, sizeof *number);
    double *area = calloc(n, sizeof *area);
    const int error = number && area ? copy_part(mesh, colour, keep_flat, number, area, shape)
                                     : -ENOMEM;
    free(number);
    free(area);
    return error;
}

/* Measures the area of the triangles: a third of it counts for each of their vertices. */
static int measure_area(struct iso_shape *shape)
{
    const struct iso_mesh *mesh = shape->mesh;
    shape->area = calloc((size_t)mesh->n_vertices, sizeof *shape->area);
    if (!shape->area) {
        return -ENOMEM;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const double area = iso_mesh_triangle_area(mesh, t);
        shape->total_area += area;
        for (int k = 0; k < 3; k++) {
            shape->area[mesh->triangles[t][k]] += area / 3.0;
        }
    }
    return 0;
}

/* The triangles of a cloud overlap, so that the area of a point is the sum of its row of B. */
static int measure_cloud(struct iso_shape *shape)
{
    const int32_t n = shape->mesh->n_vertices;
    double *one = malloc((size_t)n * sizeof *one);
    if (!one) {
        return -ENOMEM;
    }
    for (int32_t v = 0; v < n; v++) {
        one[v] = 1.0;
    }
    iso_symmetric_multiply(shape->mass, one, shape->area);
    free(one);
    shape->total_area = 0.0;
    for (int32_t v = 0; v < n; v++) {
        shape->total_area += shape->area[v];
    }
    return 0;
}

/* The matrices of the triangles as they are. Their entries are where the neighbours are. */
static int assemble_plain(struct iso_shape *shape)
{
    int32_t n = shape->mesh->n_vertices, nnz = n + 3 * shape->mesh->n_triangles;
    int error = iso_symmetric_new(n, nnz, &shape->stiffness);
    if (!error) {
        error = iso_symmetric_new(n, nnz, &shape->mass);
    }
    return error ? error : assemble(SURFACE_MESH, shape->mesh, NULL, shape->stiffness, shape->mass);
}

/* Neighbours are where the matrices have entries: the lower triangle, then its mirror image. */
static int find_neighbours(struct iso_shape *shape)
{
    const struct iso_symmetric *a = shape->stiffness;
    const size_t n = (size_t)a->n;
    int32_t *start = calloc(n + 2, sizeof *start);
    shape->neighbour_start = start;
    shape->neighbour = calloc(2 * (size_t)a->nnz, sizeof *shape->neighbour);
    if (!start || !shape->neighbour) {
        return -ENOMEM;
    }
    start++; /* while it is filled, start[v] is where the next neighbour of v goes */
    for (int32_t j = 0; j < a->n; j++) {
        for (int32_t at = a->column_start[j] + 1; at < a->column_start[j + 1]; at++) {
            start[j + 1]++;
            start[a->row[at] + 1]++;
        }
    }
    for (size_t v = 0; v < n; v++) {
        start[v + 1] += start[v];
    }
    for (int32_t j = 0; j < a->n; j++) {
        for (int32_t at = a->column_start[j] + 1; at < a->column_start[j + 1]; at++) {
            shape->neighbour[start[j]++] = a->row[at];
            shape->neighbour[start[a->row[at]]++] = j;
        }
    }
    return 0;
}

/* Marks all neighbours of marked vertices. */
static void widen_marks(const struct iso_shape *shape, const uint8_t *from, uint8_t *to)
{
    for (int32_t v = 0; v < shape->mesh->n_vertices; v++) {
        to[v] = from[v];
        for (int32_t at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
            to[v] |= from[shape->neighbour[at]];
        }
    }
}

static int mark_boundary(const struct iso_mesh *mesh, uint8_t *on_boundary)
{
    int32_t(*adjacent)[3] = calloc((size_t)mesh->n_triangles, sizeof *adjacent);
    const int error = adjacent ? iso_mesh_adjacency(mesh, adjacent) : -ENOMEM;
    if (!error) {
        iso_mesh_boundary(mesh, (const int32_t(*)[3])adjacent, on_boundary);
    }
    free(adjacent);
    return error;
}

static int find_boundary(struct iso_shape *shape, enum surface surface)
{
    const size_t n = (size_t)shape->mesh->n_vertices;
    uint8_t *one_edge = calloc(n, 1);
    shape->near_boundary = calloc(n, 1);
    int error = one_edge && shape->near_boundary ? 0 : -ENOMEM;
    if (!error && surface == SURFACE_CLOUD) {
        iso_cloud_boundary(shape->mesh, shape->near_boundary);
    } else if (!error) {
        error = mark_boundary(shape->mesh, shape->near_boundary);
    }
    if (!error) {
        widen_marks(shape, shape->near_boundary, one_edge);
        widen_marks(shape, one_edge, shape->near_boundary);
    }
    free(one_edge);
    return error;
}

static bool valid_colours(const struct iso_colour *colour, int32_t n)
{
    for (int32_t v = 0; colour && v < n; v++) {
        for (int c = 0; c < ISO_CHANNELS; c++) {
            if (!(colour[v].channel[c] >= 0.0f && colour[v].channel[c] <= 1.0f)) {
                return false;
            }
        }
    }
    return true;
}

static int solve_pairs(const struct iso_shape *shape, const struct iso_symmetric *stiffness,
                       const struct iso_symmetric *mass, int32_t wanted,
                       struct iso_eigenpairs **out)
{
    const int32_t most = shape->mesh->n_vertices / 2;
    return iso_eigenpairs_new(stiffness, mass, wanted < most ? wanted : most, pairs_tolerance, out);
}

/* Computes the spectra of the manifolds whose densities are the channels. */
static int solve_weighted(struct iso_shape *shape, enum surface surface)
{
    struct iso_symmetric *stiffness = NULL, *mass = NULL;
    int32_t n = shape->mesh->n_vertices, room = shape->stiffness->nnz_capacity;
    double *density = malloc((size_t)n * sizeof *density);
    int error = density ? 0 : -ENOMEM;
    if (!error) {
        error = iso_symmetric_new(n, room, &stiffness);
    }
    if (!error) {
        error = iso_symmetric_new(n, room, &mass);
    }
    for (int c = 0; !error && c < ISO_CHANNELS; c++) {
        for (int32_t v = 0; v < n; v++) {
            density[v] = fmax(ISO_SHAPE_DENSITY_MIN, (double)shape->colour[v].channel[c]);
        }
        error = assemble(surface, shape->mesh, density, stiffness, mass);
        if (!error) {
            error = solve_pairs(shape, stiffness, mass, ISO_SHAPE_WEIGHTED_PAIRS,
                                &shape->weighted[c]);
        }
    }
    iso_symmetric_free(stiffness);
    iso_symmetric_free(mass);
    free(density);
    return error;
}

/* Everything besides the eigenpairs. */
static int fill_shape(struct iso_shape *shape, enum surface surface)
{
    int error = measure_area(shape);
    if (!error) {
        error = assemble_plain(shape);
    }
    if (!error) {
        error = find_neighbours(shape);
    }
    if (!error) {
        error = find_boundary(shape, surface);
    }
    if (!error && surface != SURFACE_MESH) { /* the neighbours are those of the triangles */
        error = assemble(surface, shape->mesh, NULL, shape->stiffness, shape->mass);
    }
    if (!error && surface == SURFACE_CLOUD) {
        error = measure_cloud(shape);
    }
    return error;
}

static int make_shape(const struct iso_mesh *mesh, const struct iso_colour *colour, int32_t n_pairs,
                      enum surface surface, struct iso_shape **out)
{
    if (n_pairs < 0 || iso_mesh_check(mesh, NULL) || !valid_colours(colour, mesh->n_vertices)) {
        return -EINVAL;
    }
    struct iso_shape *shape = calloc(1, sizeof *shape);
    if (!shape) {
        return -ENOMEM;
    }
    shape->is_cloud = surface == SURFACE_CLOUD;
    int error = take_part(mesh, colour, surface != SURFACE_MESH, shape);
    if (!error) {
        error = fill_shape(shape, surface);
    }
    if (!error) {
        error = solve_pairs(shape, shape->stiffness, shape->mass,
                            n_pairs ? n_pairs : ISO_SHAPE_PAIRS, &shape->pairs);
    }
    if (!error && colour) {
        error = solve_weighted(shape, surface);
    }
    if (!error && surface == SURFACE_CLOUD) { /* the matrices need the triangles of all stars */
        error = iso_cloud_merge(shape->mesh);
    }
    if (error) {
        iso_shape_free(shape);
        return error;
    }
    *out = shape;
    return 0;
}

int iso_shape_new(const struct iso_mesh *mesh, const struct iso_colour *colour, int32_t n_pairs,
                  struct iso_shape **out)
{
    return make_shape(mesh, colour, n_pairs, SURFACE_MESH, out);
}

int iso_shape_new_robust(const struct iso_mesh *mesh, const struct iso_colour *colour,
                         int32_t n_pairs, struct iso_shape **out)
{
    return make_shape(mesh, colour, n_pairs, SURFACE_BAD_MESH, out);
}

int iso_shape_new_cloud(const struct iso_vec3 *point, const struct iso_colour *colour, int32_t n,
                        int32_t neighbours, int32_t n_pairs, struct iso_shape **out)
{
    struct iso_mesh *cloud = NULL;
    int error = iso_cloud_triangulate(point, n, neighbours, &cloud);
    if (!error) {
        error = make_shape(cloud, colour, n_pairs, SURFACE_CLOUD, out);
    }
    iso_mesh_free(cloud);
    return error;
}

void iso_shape_drop_colours(struct iso_shape *shape)
{
    free(shape->colour);
    shape->colour = NULL;
    for (int c = 0; c < ISO_CHANNELS; c++) {
        iso_eigenpairs_free(shape->weighted[c]);
        shape->weighted[c] = NULL;
    }
}

void iso_shape_free(struct iso_shape *shape)
{
    if (shape) {
        iso_shape_drop_colours(shape);
        iso_mesh_free(shape->mesh);
        free(shape->area);
        free(shape->near_boundary);
        free(shape->neighbour_start);
        free(shape->neighbour);
        iso_symmetric_free(shape->stiffness);
        iso_symmetric_free(shape->mass);
        iso_eigenpairs_free(shape->pairs);
        free(shape);
    }
}
