#include "sim/shapes/describe/shape_view.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "isotherm/stiffness_mass.h"

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

int sim_shape_face_viewer(const struct iso_mesh *mesh, struct iso_mesh **out)
{
    const struct sim_view view = sim_shape_view(mesh);
    const struct iso_vec3 viewer = {sin(view.yaw_rad) * cos(view.pitch_rad), sin(view.pitch_rad),
                                    cos(view.yaw_rad) * cos(view.pitch_rad)};
    struct iso_mesh *copy = NULL;
    const int error = iso_mesh_new(mesh->n_vertices, mesh->n_triangles, &copy);
    if (error) {
        return error;
    }
    copy->n_vertices = mesh->n_vertices;
    copy->n_triangles = mesh->n_triangles;
    memcpy(copy->vertices_mm, mesh->vertices_mm,
           (size_t)mesh->n_vertices * sizeof *mesh->vertices_mm);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        const struct iso_vec3 a = mesh->vertices_mm[c[0]];
        const struct iso_vec3 normal = iso_cross(iso_sub(mesh->vertices_mm[c[1]], a),
                                                 iso_sub(mesh->vertices_mm[c[2]], a));
        const bool front = iso_dot(normal, viewer) >= 0.0;
        copy->triangles[t][0] = c[0];
        copy->triangles[t][1] = front ? c[1] : c[2];
        copy->triangles[t][2] = front ? c[2] : c[1];
    }
    *out = copy;
    return 0;
}

int sim_shape_cloud_surface(const struct iso_mesh *points, int32_t neighbours,
                            struct iso_mesh **out)
{
    struct iso_mesh *cloud = NULL;
    int error = iso_cloud_triangulate(points->vertices_mm, points->n_vertices, neighbours, &cloud);
    if (!error) {
        error = sim_shape_face_viewer(cloud, out);
    }
    iso_mesh_free(cloud);
    return error;
}

static void draw_dots(const struct iso_mesh *mesh, const struct sim_array *dots,
                      const struct sim_scene *scene)
{
    for (int32_t i = 0; dots && i < dots->rows; i++) {
        const int32_t v = (int32_t)sim_array_item(dots, i, 0);
        sim_scene_dot(scene, mesh->vertices_mm[v], sim_colour_hex(0xffffff), 3.5);
    }
}

struct sim_view sim_shape_view_from(const struct iso_mesh *mesh, struct iso_vec3 direction)
{
    struct sim_view view = sim_shape_view(mesh);
    view.yaw_rad = atan2(direction.x, direction.z);
    view.pitch_rad = asin(fmax(-1.0, fmin(1.0, direction.y)));
    return view;
}

static int draw(const struct iso_mesh *mesh, const struct sim_view *view,
                const struct sim_surface_style *style, const struct sim_array *dots, int size_px,
                cairo_surface_t **out)
{
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    int error = sim_canvas_new(size_px, size_px, sim_colour_hex(0xf4f6f8), sim_colour_hex(0xd8dee4),
                               &canvas);
    if (!error) {
        error = sim_scene_new(mesh, view, canvas, &scene);
    }
    if (!error) {
        error = sim_scene_shade(scene, style);
    }
    if (!error) {
        draw_dots(mesh, dots, scene);
        *out = sim_canvas_surface(canvas);
    }
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    return error;
}

int sim_shape_picture(const struct iso_mesh *mesh, const struct sim_colour *colour,
                      const struct sim_array *dots, int size_px, cairo_surface_t **out)
{
    const struct sim_view view = sim_shape_view(mesh);
    const struct sim_surface_style style = {.vertex = colour};
    return draw(mesh, &view, &style, dots, size_px, out);
}

int sim_shape_picture_from(const struct iso_mesh *mesh, const struct sim_view *view, int size_px,
                           cairo_surface_t **out)
{
    const struct sim_surface_style style = {.base = sim_colour_hex(0xb9c4cf)};
    return draw(mesh, view, &style, NULL, size_px, out);
}
