#include "sim/shapes/match/match_picture.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/png_file.h"
#include "sim/shapes/describe/shape_view.h"

enum { CELL_PX = 420 };

/* Red, green and blue rise with x, y and z. */
static void colour_places(const struct iso_mesh *mesh, struct sim_colour *colour)
{
    struct iso_vec3 low = mesh->vertices_mm[0], high = low;
    for (int32_t v = 1; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = mesh->vertices_mm[v];
        low = iso_vec3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = iso_vec3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    const struct iso_vec3 size = iso_sub(high, low);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = iso_sub(mesh->vertices_mm[v], low);
        colour[v] = (struct sim_colour){0.08f + 0.9f * (float)(size.x > 0.0 ? p.x / size.x : 0.5),
                                        0.08f + 0.9f * (float)(size.y > 0.0 ? p.y / size.y : 0.5),
                                        0.08f + 0.9f * (float)(size.z > 0.0 ? p.z / size.z : 0.5)};
    }
}

static int draw_shape(cairo_t *cr, const struct iso_shape *shape, const struct sim_colour *colour,
                      double x)
{
    cairo_surface_t *picture = NULL;
    struct iso_mesh *facing = NULL;
    int error = shape->is_cloud ? sim_shape_face_viewer(shape->mesh, &facing) : 0;
    if (!error) {
        error = sim_shape_picture(facing ? facing : shape->mesh, colour, NULL, CELL_PX, &picture);
    }
    iso_mesh_free(facing);
    if (!error) {
        cairo_set_source_surface(cr, picture, x, 0.0);
        cairo_paint(cr);
        cairo_surface_destroy(picture);
    }
    return error;
}

int sim_match_picture(const struct iso_shape *from, const struct iso_shape *to,
                      const int32_t *point, const char *path, struct iso_fault *fault)
{
    const size_t n_from = (size_t)from->mesh->n_vertices, n_to = (size_t)to->mesh->n_vertices;
    struct sim_colour *colour = malloc((n_from + n_to) * sizeof *colour);
    if (!colour) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    colour_places(from->mesh, colour);
    for (size_t v = 0; v < n_to; v++) {
        colour[n_from + v] = colour[point[v]];
    }
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 2 * CELL_PX, CELL_PX);
    cairo_t *cr = cairo_create(surface);
    int error = draw_shape(cr, from, colour, 0.0);
    if (!error) {
        error = draw_shape(cr, to, colour + n_from, CELL_PX);
    }
    cairo_destroy(cr);
    free(colour);
    if (error) {
        cairo_surface_destroy(surface);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return sim_png_file_write(surface, path, fault);
}
