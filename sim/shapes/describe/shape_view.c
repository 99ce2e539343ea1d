#include "sim/shapes/describe/shape_view.h"

#include <math.h>

struct sim_view sim_shape_view(const struct iso_mesh *mesh)
{
    struct iso_vec3 low = mesh->vertices_mm[0], high = low;
    for (int32_t v = 1; v < mesh->n_vertices; v++) {
        struct iso_vec3 p = mesh->vertices_mm[v];
        low = iso_vec3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = iso_vec3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    const double size = iso_norm(iso_sub(high, low));
    return (struct sim_view){
        .yaw_rad = 0.7,
        .pitch_rad = 0.35,
        .centre_mm = iso_scale(0.5, iso_add(low, high)),
        .distance_mm = 6.0 * size,
        .height_mm = size,
    };
}
