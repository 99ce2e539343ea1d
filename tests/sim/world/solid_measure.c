#include "tests/sim/world/solid_measure.h"

#include <math.h>

/* Uses the divergence theorem. */
double solid_volume(const struct sim_solid *solid)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < solid->n_triangles; t++) {
        const uint32_t *c = solid->triangles[t];
        sum += iso_dot(solid->vertices_mm[c[0]],
                       iso_cross(solid->vertices_mm[c[1]], solid->vertices_mm[c[2]]));
    }
    return sum / 6.0;
}

double solid_area(const struct sim_solid *solid)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < solid->n_triangles; t++) {
        struct iso_vec3 a = solid->vertices_mm[solid->triangles[t][0]];
        struct iso_vec3 ab = iso_sub(solid->vertices_mm[solid->triangles[t][1]], a);
        sum += iso_norm(iso_cross(ab, iso_sub(solid->vertices_mm[solid->triangles[t][2]], a)));
    }
    return 0.5 * sum;
}

struct solid_extent solid_extent(const struct sim_solid *solid)
{
    struct solid_extent e = {solid->vertices_mm[0], solid->vertices_mm[0]};
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        struct iso_vec3 p = solid->vertices_mm[i];
        e.least = iso_vec3(fmin(e.least.x, p.x), fmin(e.least.y, p.y), fmin(e.least.z, p.z));
        e.most = iso_vec3(fmax(e.most.x, p.x), fmax(e.most.y, p.y), fmax(e.most.z, p.z));
    }
    return e;
}
