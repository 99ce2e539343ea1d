#include "sim/lab/picture/depth.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/lab/draw/bar.h"
#include "sim/lab/draw/png_file.h"
#include "sim/lab/picture/relief.h"

struct range {
    double near_mm, far_mm;
};

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static int depth_range(const struct iso_frame *frame, struct range *out)
{
    size_t n_pixels = (size_t)frame->width_px * (size_t)frame->height_px, n = 0;
    float *depths = calloc(n_pixels, sizeof *depths);
    if (!depths) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n_pixels; i++) {
        if (frame->depth_mm[i] > 0.0f) {
            depths[n++] = frame->depth_mm[i];
        }
    }
    qsort(depths, n, sizeof *depths, by_value);
    *out = (struct range){0.0, 1.0};
    if (n > 0) {
        out->near_mm = (double)depths[n / 100];
        out->far_mm = fmax((double)depths[n - 1 - n / 100], out->near_mm + 1.0);
    }
    free(depths);
    return 0;
}

static void draw_pixels(cairo_t *cr, const struct iso_frame *frame, struct range range, int zoom)
{
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            const double depth = (double)iso_frame_depth_at(frame, column, row);
            if (depth > 0.0) {
                const double share = (range.far_mm - depth) / (range.far_mm - range.near_mm);
                sim_picture_set_colour(cr, sim_colour_scale(sim_relief(frame, column, row, 1),
                                                            sim_colour_depth(share)));
                cairo_rectangle(cr, column * zoom, row * zoom, zoom, zoom);
                cairo_fill(cr);
            }
        }
    }
}

/* Near is bright. */
static struct sim_colour colour_of_share(double share)
{
    return sim_colour_depth(1.0 - share);
}

int sim_picture_depth(const struct iso_frame *frame, const char *path, struct iso_fault *fault)
{
    enum { BAR_PX = 100, SMALL_PX = 480 };
    struct range range;
    if (depth_range(frame, &range)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    const int zoom = frame->height_px < SMALL_PX ? SMALL_PX / frame->height_px : 1;
    int width = frame->width_px * zoom, height = frame->height_px * zoom;
    height = height > 160 ? height : 160; /* room for the bar */
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width + BAR_PX,
                                                          height);
    cairo_t *cr = cairo_create(surface);
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    draw_pixels(cr, frame, range, zoom);
    const struct sim_bar bar = {
        .axis = {"depth, mm", SIM_SCALE_LINEAR, range.near_mm, range.far_mm},
        .colour = colour_of_share,
        .falling = true,
    };
    sim_picture_bar(cr, &bar, width + 18.0, 40.0, height - 24.0);
    cairo_destroy(cr);
    return sim_png_file_write(surface, path, fault);
}
