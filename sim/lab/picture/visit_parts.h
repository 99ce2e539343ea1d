/* The parts of the picture of a visit. Internal to sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_VISIT_PARTS_H
#define SIM_LAB_PICTURE_VISIT_PARTS_H

#include <cairo.h>

#include "sim/lab/draw/bar.h"
#include "sim/lab/draw/png_file.h"
#include "sim/lab/picture/visit.h"

enum {
    VISIT_WIDTH_PX = 1200,
    VISIT_MARGIN_PX = 40,
    VISIT_HEAD_PX = 96,
    VISIT_PANEL_WIDTH_MAX_PX = 556,
    VISIT_PANEL_HEIGHT_MAX_PX = 400,
    VISIT_GAP_PX = 8,
    VISIT_SCORES_PX = 190,
    VISIT_RELAY_PX = 170,
    VISIT_BACKGROUND = 0x14161b,
    VISIT_PANEL = 0x1d2027,
    VISIT_TEXT = 0xe6e8ee,
    VISIT_FAINT = 0x8b92a1,
    VISIT_FACE = 0x6fb1ff,
    VISIT_LANDMARK = 0xffd23f,
    VISIT_GOOD = 0x3ddc84,
    VISIT_BAD = 0xff5d5d,
};

struct sim_visit_picture {
    const struct sim_visit_view *view;
    cairo_t *cr;
    int n;                /* number of frames to draw */
    double width, height; /* of a frame's panel, px */
    double score_max;     /* the score whose bar has the full height */
};

/* Set the current colour (0xRRGGBB) and the current font. */
void sim_visit_colour(const struct sim_visit_picture *p, uint32_t hex);
void sim_visit_font(const struct sim_visit_picture *p, double size, bool bold);

/* Draws an empty panel. */
void sim_visit_box(const struct sim_visit_picture *p, double x, double y, double width,
                   double height);

/* The left edge of the panel of frame number i. */
double sim_visit_panel_x(const struct sim_visit_picture *p, int i);

/* Draws frame number i as a relief with the fitted face (visit_frame.c). */
void sim_visit_draw_frame(const struct sim_visit_picture *p, int i, double top);

/* Draws the relay over time (visit_relay.c). */
void sim_visit_draw_relay(const struct sim_visit_picture *p, double top);

#endif
