/* The finite elements of the Delaunay triangulation of a mesh's tufted cover, halved: the robust
 * Laplacian of Sharp and Crane 2020 (isotherm/stiffness_mass.h, intrinsic.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/elements.h"
#include "core/heat/intrinsic/intrinsic.h"

/* Each triangle counts half, because the cover has two for each triangle of the mesh. */
static void add_triangle(const struct iso_intrinsic *s, int32_t t, enum iso_mass kind,
                         const double *density, struct iso_symmetric *stiffness,
                         struct iso_symmetric *mass)
{
    struct iso_element element = {.area = 0.5 * iso_intrinsic_area(s, t)};
    for (int k = 0; k < 3; k++) {
        element.corner[k] = s->corner[3 * t + k];
        element.cotangent[k] = 0.5 * iso_intrinsic_cotangent(s, 3 * t + (k + 1) % 3);
    }
    iso_element_add(&element, kind, density, stiffness, mass);
}

/* Assembles matrices that have room for as many entries as the cover has sides. */
static int assemble(const struct iso_intrinsic *s, int32_t n, enum iso_mass kind,
                    const double *density, struct iso_symmetric *stiffness,
                    struct iso_symmetric *mass)
{
    const int32_t(*triangles)[3] = (const int32_t(*)[3])s->corner;
    const int error = iso_elements_begin(n, triangles, s->n_triangles, stiffness, mass);
    if (error) {
        return error;
    }
    for (int32_t t = 0; t < s->n_triangles; t++) {
        add_triangle(s, t, kind, density, stiffness, mass);
    }
    iso_elements_end(mass);
    return 0;
}

static int copy(const struct iso_symmetric *from, struct iso_symmetric *to)
{
    const int error = iso_elements_copy_pattern(from, to);
    if (!error) {
        memcpy(to->value, from->value, (size_t)from->nnz * sizeof *to->value);
    }
    return error;
}

/* Assembles both in memory with room for each edge as often as its triangles name it. */
static int assemble_copies(const struct iso_intrinsic *s, int32_t n, enum iso_mass kind,
                           const double *density, struct iso_symmetric *stiffness,
                           struct iso_symmetric *mass)
{
    struct iso_symmetric *l = NULL, *b = NULL;
    int error = iso_symmetric_new(n, n + s->n_sides, &l);
    if (!error) {
        error = iso_symmetric_new(n, n + s->n_sides, &b);
    }
    if (!error) {
        error = assemble(s, n, kind, density, l, b);
    }
    if (!error) {
        error = copy(l, stiffness);
    }
    if (!error) {
        error = copy(b, mass);
    }
    iso_symmetric_free(l);
    iso_symmetric_free(b);
    return error;
}

int iso_stiffness_mass_robust(const struct iso_mesh *mesh, enum iso_mass kind,
                              const double *density, struct iso_symmetric *stiffness,
                              struct iso_symmetric *mass)
{
    struct iso_intrinsic surface = {0};
    int64_t n_flips = 0;
    if (mesh->n_vertices < 1 || iso_mesh_check(mesh, NULL) ||
        !iso_elements_density_is_good(density, mesh->n_vertices)) {
        return -EINVAL;
    }
    int error = iso_intrinsic_cover(mesh, &surface);
    if (error) {
        return error;
    }
    error = iso_intrinsic_delaunay(&surface, &n_flips);
    if (!error) {
        error = assemble_copies(&surface, mesh->n_vertices, kind, density, stiffness, mass);
    }
    iso_intrinsic_done(&surface);
    return error;
}
