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

static void draw_dots(const struct iso_mesh *mesh, const struct sim_array *dots,
                      const struct sim_scene *scene)
{
    for (int32_t i = 0; dots && i < dots->rows; i++) {
        const int32_t v = (int32_t)sim_array_item(dots, i, 0);
        sim_scene_dot(scene, mesh->vertices_mm[v], sim_colour_hex(0xffffff), 3.5);
    }
}

int sim_shape_picture(const struct iso_mesh *mesh, const struct sim_colour *colour,
                      const struct sim_array *dots, int size_px, cairo_surface_t **out)
{
    struct sim_view view = sim_shape_view(mesh);
    const struct sim_surface_style style = {.vertex = colour};
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    int error = sim_canvas_new(size_px, size_px, sim_colour_hex(0xf4f6f8), sim_colour_hex(0xd8dee4),
                               &canvas);
    if (!error) {
        error = sim_scene_new(mesh, &view, canvas, &scene);
    }
    if (!error) {
        error = sim_scene_shade(scene, &style);
    }
    if (!error) {
        draw_dots(mesh, dots, scene);
        *out = sim_canvas_surface(canvas);
    }
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    return error;
}
