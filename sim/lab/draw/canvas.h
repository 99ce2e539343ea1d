/* A picture being painted, with several samples for each pixel so that edges are smooth. */
#ifndef SIM_LAB_DRAW_CANVAS_H
#define SIM_LAB_DRAW_CANVAS_H

#include <cairo.h>

#include "sim/lab/draw/colour.h"

enum { SIM_CANVAS_SUPERSAMPLING = 3 }; /* samples along each side of a pixel */

struct sim_canvas {
    int width, height;         /* in samples */
    struct sim_colour *sample; /* [height * width] */
};

/* Makes a canvas for a picture of width_px x height_px pixels, with one colour at the top, another
 * at the bottom, and darker corners. -EINVAL for a side outside 1..4096, -ENOMEM. */
int sim_canvas_new(int width_px, int height_px, struct sim_colour top, struct sim_colour bottom,
                   struct sim_canvas **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_canvas_free(struct sim_canvas *canvas);

/* Blends a colour over a sample; alpha 0..1. */
static inline void sim_canvas_blend(struct sim_canvas *canvas, int x, int y,
                                    struct sim_colour colour, float alpha)
{
    struct sim_colour *s = &canvas->sample[(long)y * canvas->width + x];
    *s = sim_colour_mix(*s, colour, alpha);
}

/* Averages the samples of each pixel into a Cairo surface, which the caller destroys. The
 * surface's status reports missing memory. */
cairo_surface_t *sim_canvas_surface(const struct sim_canvas *canvas);

#endif
