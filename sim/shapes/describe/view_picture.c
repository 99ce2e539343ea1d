#include "sim/shapes/describe/view_picture.h"

#include <string.h>

#include "sim/lab/draw/png_file.h"
#include "sim/shapes/describe/shape_view.h"

enum { CELL_PX = 240, LABEL_PX = 34, COLUMNS = 4 };

static const struct sim_array *find_array(const struct sim_arrays *arrays, const char *name)
{
    for (int i = 0; i < arrays->n; i++) {
        if (strcmp(arrays->array[i].name, name) == 0) {
            return &arrays->array[i];
        }
    }
    return NULL;
}

static int draw_view(cairo_t *cr, const struct iso_shape *shape, const struct sim_arrays *arrays,
                     int32_t number)
{
    const struct sim_array *view = find_array(arrays, "view");
    const struct iso_vec3 direction = {sim_array_item(view, number, 0),
                                       sim_array_item(view, number, 1),
                                       sim_array_item(view, number, 2)};
    const struct sim_view from = sim_shape_view_from(shape->mesh, direction);
    const double x = CELL_PX * (number % COLUMNS), middle = x + 0.5 * CELL_PX;
    const double y = (CELL_PX + LABEL_PX) * (double)(number / COLUMNS);
    cairo_surface_t *picture = NULL;
    char text[64];
    const int error = sim_shape_picture_from(shape->mesh, &from, CELL_PX, &picture);
    if (error) {
        return error;
    }
    cairo_set_source_surface(cr, picture, x, y);
    cairo_paint(cr);
    cairo_surface_destroy(picture);
    cairo_set_source_rgb(cr, 0.1, 0.1, 0.1);
    (void)snprintf(text, sizeof text, "%.2f, %.2f, %.2f", direction.x, direction.y, direction.z);
    sim_picture_text(cr, text, middle, y + CELL_PX + 14.0, 0.5);
    (void)snprintf(text, sizeof text, "entropy %.3f, divergence %.3f",
                   sim_array_item(find_array(arrays, "view_entropy"), number, 0),
                   sim_array_item(find_array(arrays, "view_divergence"), number, 0));
    cairo_set_source_rgb(cr, 0.4, 0.4, 0.4);
    sim_picture_text(cr, text, middle, y + CELL_PX + 28.0, 0.5);
    return 0;
}

int sim_view_picture(const struct iso_shape *shape, const struct sim_arrays *arrays,
                     const char *path, struct iso_fault *fault)
{
    const struct sim_array *view = find_array(arrays, "view");
    int error = 0;
    if (!view) {
        return 0;
    }
    const int rows = (view->rows + COLUMNS - 1) / COLUMNS;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, CELL_PX * COLUMNS,
                                                          (CELL_PX + LABEL_PX) * rows);
    cairo_t *cr = cairo_create(surface);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 12.0);
    for (int32_t i = 0; i < view->rows && !error; i++) {
        error = draw_view(cr, shape, arrays, i);
    }
    cairo_destroy(cr);
    if (error) {
        cairo_surface_destroy(surface);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return sim_png_file_write(surface, path, fault);
}
