/* Draws text into pictures and writes picture files. Internal to sim/lab. */
#ifndef SIM_LAB_DRAW_PNG_FILE_H
#define SIM_LAB_DRAW_PNG_FILE_H

#include <cairo.h>

#include "core/base/fault.h"

/* Writes a surface as a PNG file and always destroys it, even on failure. -ENOMEM (also for a
 * surface that could not be created), -EIO. */
int sim_png_file_write(cairo_surface_t *surface, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Draws text in the current colour and font; `anchor` is the share of its width left of x. */
void sim_picture_text(cairo_t *cr, const char *text, double x, double y, double anchor);

#endif
