/* The colour scale beside a picture. Internal to sim/lab. */
#ifndef SIM_LAB_DRAW_BAR_H
#define SIM_LAB_DRAW_BAR_H

#include <cairo.h>
#include <stdbool.h>

#include "sim/lab/draw/colour.h"
#include "sim/lab/draw/scale.h"

/* Sets the current colour of a context. */
void sim_picture_set_colour(cairo_t *cr, struct sim_colour colour);

struct sim_bar {
    struct sim_axis axis;                      /* the label stands above the bar */
    struct sim_colour (*colour)(double share); /* colour of a share, 0 (axis.from) .. 1 (axis.to) */
    bool falling;                              /* axis.from is at the top */
};

/* Draws the scale 18 pixels wide with its upper left corner at (x, top) and numbers on its right.
 */
void sim_picture_bar(cairo_t *cr, const struct sim_bar *bar, double x, double top, double bottom);

#endif
