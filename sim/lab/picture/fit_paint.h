/* Paints the panels of a picture of a fit, sample by sample. Internal to sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_FIT_PAINT_H
#define SIM_LAB_PICTURE_FIT_PAINT_H

#include "core/surface/raster.h"
#include "sim/lab/draw/canvas.h"
#include "sim/lab/picture/fit.h"

enum {
    SIM_FIT_PANEL_PX = 440,
    SIM_FIT_SAMPLES = SIM_FIT_PANEL_PX * SIM_CANVAS_SUPERSAMPLING,
};

/* The residual at which the colour scale ends. */
#define SIM_FIT_RESIDUAL_LIMIT_MM 8.0

/* The square of the frame that a panel shows: corner and side in pixels of the frame, as
 * sim_relief_place has them. */
struct sim_fit_window {
    double x, y, side;
};

/* The fitted head as a panel shows it. */
struct sim_fit_head {
    struct iso_raster raster;
    uint32_t *storage; /* memory of the raster's planes; free it with free() */
};

/* The frame in grey, lit, and darker with distance; unmeasured pixels are dark blue. One colour
 * for each pixel; free it with free(). NULL: out of memory. */
struct sim_colour *sim_fit_grey_new(const struct iso_frame *frame);

/* Paints the frame's part in the window, in the colours of sim_fit_grey_new. */
void sim_fit_paint_frame(struct sim_canvas *canvas, const struct iso_frame *frame,
                         const struct sim_colour *grey, struct sim_fit_window window);

/* Finds the visible part of the fitted head for each sample of a panel. -ENOMEM. */
int sim_fit_head_new(const struct sim_fit_view *view, struct sim_fit_window window,
                     struct sim_fit_head *out) __attribute__((warn_unused_result));

/* Paints the head's triangles and their edges, partly transparent. */
void sim_fit_paint_mesh(struct sim_canvas *canvas, const struct sim_fit_view *view,
                        const struct sim_fit_head *head);

/* Paints the residuals in colours, slightly lit, so that the face is recognisable. */
void sim_fit_paint_residuals(struct sim_canvas *canvas, const struct sim_fit_view *view,
                             const struct sim_fit_head *head);

#endif
