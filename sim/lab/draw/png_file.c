#include "sim/lab/draw/png_file.h"

#include <errno.h>

int sim_png_file_write(cairo_surface_t *surface, const char *path, struct iso_fault *fault)
{
    cairo_status_t status = cairo_surface_status(surface);
    if (status == CAIRO_STATUS_SUCCESS) {
        status = cairo_surface_write_to_png(surface, path);
    }
    cairo_surface_destroy(surface);
    if (status == CAIRO_STATUS_NO_MEMORY) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    return status ? iso_fault_set(fault, -EIO, "%s: %s", path, cairo_status_to_string(status)) : 0;
}

void sim_picture_text(cairo_t *cr, const char *text, double x, double y, double anchor)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cr, text, &extents);
    cairo_move_to(cr, x - anchor * extents.x_advance, y);
    cairo_show_text(cr, text);
}
