#include "sim/picture/depth.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/picture/colour.h"
#include "sim/picture/png_file.h"
#include "sim/picture/scale.h"

struct range {
    double near_mm, far_mm;
};

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
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

static void set_colour(cairo_t *cr, struct sim_colour c)
{
    cairo_set_source_rgb(cr, sim_colour_byte(c.r) / 255.0, sim_colour_byte(c.g) / 255.0,
                         sim_colour_byte(c.b) / 255.0);
}

/* Brightness of a pixel as if its surface were lit from the upper left: makes relief visible where
 * the range of colours is too wide for it. Jumps and the border are lit like a flat surface. */
static float relief(const struct iso_frame *frame, int column, int row)
{
    const double jump_mm = 30.0, flat = 0.75;
    double z = (double)iso_frame_depth_at(frame, column, row), slope[2];
    for (int axis = 0; axis < 2; axis++) {
        int c = column + (axis == 0), r = row + (axis == 1);
        bool inside = c < frame->width_px && r < frame->height_px;
        double next = inside ? (double)iso_frame_depth_at(frame, c, r) : 0.0;
        bool joined = next > 0.0 && fabs(next - z) < jump_mm;
        slope[axis] = joined ? (next - z) / iso_camera_pixel_mm(&frame->camera, z) : 0.0;
    }
    /* The normal (slope_x, slope_y, -1) and the light (-1, -1, -2) / sqrt 6. */
    double lambert = (2.0 - slope[0] - slope[1]) /
                     sqrt(6.0 * (1.0 + slope[0] * slope[0] + slope[1] * slope[1]));
    return (float)fmin(fmax(0.15 + lambert * flat / 0.8165 * 0.85, 0.1), 1.0);
}

static void draw_pixels(cairo_t *cr, const struct iso_frame *frame, struct range range, int zoom)
{
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            double depth = (double)iso_frame_depth_at(frame, column, row);
            if (depth > 0.0) {
                double share = (range.far_mm - depth) / (range.far_mm - range.near_mm);
                set_colour(cr,
                           sim_colour_scale(relief(frame, column, row), sim_colour_depth(share)));
                cairo_rectangle(cr, column * zoom, row * zoom, zoom, zoom);
                cairo_fill(cr);
            }
        }
    }
}

/* The colours from near (top) to far, with their depths, in the column right of x. */
static void draw_bar(cairo_t *cr, struct range range, double x, double height)
{
    double top = 40.0, bottom = height - 24.0;
    for (double y = top; y < bottom; y += 1.0) {
        set_colour(cr, sim_colour_depth((bottom - y) / (bottom - top)));
        cairo_rectangle(cr, x + 18.0, y, 18.0, 1.0);
        cairo_fill(cr);
    }
    cairo_set_source_rgb(cr, 0.85, 0.87, 0.9);
    cairo_set_font_size(cr, 13.0);
    sim_picture_text(cr, "depth, mm", x + 18.0, 24.0, 0.0);
    const struct sim_axis axis = {NULL, SIM_SCALE_LINEAR, range.near_mm, range.far_mm};
    struct sim_tick ticks[SIM_TICKS_MAX];
    size_t n = sim_axis_ticks(&axis, ticks);
    for (size_t i = 0; i < n; i++) {
        double y = top + (bottom - top) * sim_axis_place(&axis, ticks[i].value);
        sim_picture_text(cr, ticks[i].label, x + 44.0, y + 5.0, 0.0);
    }
}

int sim_picture_depth(const struct iso_frame *frame, const char *path, struct iso_fault *fault)
{
    enum { BAR_PX = 100, SMALL_PX = 480 };
    struct range range;
    if (depth_range(frame, &range)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    int zoom = frame->height_px < SMALL_PX ? SMALL_PX / frame->height_px : 1;
    int width = frame->width_px * zoom, height = frame->height_px * zoom;
    height = height > 160 ? height : 160; /* room for the bar */
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width + BAR_PX,
                                                          height);
    cairo_t *cr = cairo_create(surface);
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    draw_pixels(cr, frame, range, zoom);
    draw_bar(cr, range, width, height);
    cairo_destroy(cr);
    return sim_png_file_write(surface, path, fault);
}
