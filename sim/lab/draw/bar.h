/* The scale beside a picture in colours. Internal to sim/lab. */
#ifndef SIM_LAB_DRAW_BAR_H
#define SIM_LAB_DRAW_BAR_H

#include <cairo.h>
#include <stdbool.h>

#include "sim/lab/draw/colour.h"
#include "sim/lab/draw/scale.h"

/* The current colour of a context. */
void sim_picture_set_colour(cairo_t *cr, struct sim_colour colour);

struct sim_bar {
    struct sim_axis axis;                      /* the label stands above the bar */
    struct sim_colour (*colour)(double share); /* of 0 (axis.from) .. 1 (axis.to) */
    bool falling;                              /* axis.from is at the top */
};

/* 18 pixels wide, its upper left corner at (x, top), its numbers right of it. */
void sim_picture_bar(cairo_t *cr, const struct sim_bar *bar, double x, double top, double bottom);

#endif
