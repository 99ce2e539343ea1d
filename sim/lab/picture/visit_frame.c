#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/lab/draw/scale.h"
#include "sim/lab/picture/relief.h"
#include "sim/lab/picture/visit_parts.h"

/* The visible window of the frame, in pixels of the frame. */
struct window {
    double x, y, width, height;
};

/* The window around the face, 1.75 times as high as the extent of the 68 points; without a face, a
 * window as high as the frame. */
static struct window window_of(const struct sim_visit_picture *p, const struct sim_visit_frame *f)
{
    const double aspect = p->width / p->height;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, x, y;
    for (int i = 0; f->ibug_mm && i < ISO_LANDMARKS_IBUG; i++) {
        if (sim_relief_place(f->frame, f->ibug_mm[i], &x, &y)) {
            low[0] = fmin(low[0], x);
            low[1] = fmin(low[1], y);
            high[0] = fmax(high[0], x);
            high[1] = fmax(high[1], y);
        }
    }
    if (!(high[0] > low[0])) {
        const double height = f->frame->height_px;
        return (struct window){0.5 * (f->frame->width_px - aspect * height), 0.0, aspect * height,
                               height};
    }
    const double height = 1.75 * fmax(high[0] - low[0], high[1] - low[1]);
    /* The landmarks reach from the brows to the chin, so that the forehead is above them. */
    return (struct window){0.5 * (low[0] + high[0] - aspect * height),
                           0.5 * (low[1] + high[1] - 1.12 * height), aspect * height, height};
}

static uint32_t grey_of(const struct iso_frame *frame, int column, int row, double nearest_mm)
{
    if (column < 0 || row < 0 || column >= frame->width_px || row >= frame->height_px) {
        return VISIT_PANEL;
    }
    const double depth_mm = (double)iso_frame_depth_at(frame, column, row);
    if (depth_mm <= 0.0) {
        return 0x0c1a33; /* not measured */
    }
    const int reach_px = sim_relief_reach_px(frame, depth_mm);
    double light = (double)sim_relief(frame, column, row, reach_px);
    light *= 1.0 - 0.6 * fmin((depth_mm - nearest_mm) / 900.0, 1.0);
    const uint32_t byte = (uint32_t)lrint(235.0 * light);
    return byte << 16 | byte << 8 | byte;
}

/* The window's pixels in their own size; Cairo enlarges them. */
static cairo_surface_t *new_relief(const struct iso_frame *frame, struct window window)
{
    const int width = (int)ceil(window.width) + 1, height = (int)ceil(window.height) + 1;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    if (cairo_surface_status(surface)) {
        return surface;
    }
    const double nearest_mm = sim_relief_nearest_mm(frame);
    unsigned char *data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            const uint32_t rgb = grey_of(frame, (int)floor(window.x) + x, (int)floor(window.y) + y,
                                         nearest_mm);
            memcpy(data + (size_t)y * (size_t)stride + (size_t)x * sizeof rgb, &rgb, sizeof rgb);
        }
    }
    cairo_surface_mark_dirty(surface);
    return surface;
}

/* Lines between the 68 points of a face. Some lines are closed (Sagonas et al. 2013). */
static const struct {
    int first, last;
    bool closed;
} lines[] = {
    {0, 16, false}, {17, 21, false}, {22, 26, false}, {27, 30, false}, {31, 35, false},
    {36, 41, true}, {42, 47, true},  {48, 59, true},  {60, 67, true},
};

static void draw_face(const struct sim_visit_picture *p, const struct sim_visit_frame *f)
{
    double x, y;
    sim_visit_colour(p, VISIT_FACE);
    cairo_new_path(p->cr);
    for (size_t l = 0; l < sizeof lines / sizeof *lines; l++) {
        cairo_new_sub_path(p->cr);
        for (int i = lines[l].first; i <= lines[l].last; i++) {
            if (sim_relief_place(f->frame, f->ibug_mm[i], &x, &y)) {
                cairo_line_to(p->cr, x, y);
            }
        }
        if (lines[l].closed) {
            cairo_close_path(p->cr);
        }
    }
}

static void draw_landmarks(const struct sim_visit_picture *p, const struct sim_visit_frame *f,
                           double zoom)
{
    double x, y;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (sim_relief_place(f->frame, f->landmark_mm[l], &x, &y)) {
            cairo_new_path(p->cr);
            cairo_arc(p->cr, x, y, 3.6 / zoom, 0.0, 2.0 * M_PI);
            sim_visit_colour(p, VISIT_LANDMARK);
            cairo_fill_preserve(p->cr);
            cairo_set_source_rgb(p->cr, 0.05, 0.05, 0.05);
            cairo_set_line_width(p->cr, 1.0 / zoom);
            cairo_stroke(p->cr);
        }
    }
}

void sim_visit_draw_frame(const struct sim_visit_picture *p, int i, double top)
{
    const struct sim_visit_frame *f = &p->view->frames[i];
    const struct window window = window_of(p, f);
    const double zoom = p->height / window.height;
    cairo_surface_t *relief = new_relief(f->frame, window);
    char text[64];
    cairo_save(p->cr);
    cairo_rectangle(p->cr, sim_visit_panel_x(p, i), top, p->width, p->height);
    cairo_clip(p->cr);
    cairo_translate(p->cr, sim_visit_panel_x(p, i), top);
    cairo_scale(p->cr, zoom, zoom);
    cairo_translate(p->cr, -window.x, -window.y);
    cairo_set_source_surface(p->cr, relief, floor(window.x), floor(window.y));
    cairo_pattern_set_filter(cairo_get_source(p->cr), CAIRO_FILTER_BEST);
    cairo_paint(p->cr);
    if (f->ibug_mm) {
        draw_face(p, f);
        cairo_set_line_width(p->cr, 1.8 / zoom);
        cairo_stroke(p->cr);
        draw_landmarks(p, f, zoom);
    }
    cairo_restore(p->cr);
    cairo_surface_destroy(relief);
    (void)snprintf(text, sizeof text, "frame %d, %.0f ms", i + 1, 1000.0 * f->t_s);
    cairo_set_source_rgba(p->cr, 0.05, 0.055, 0.07, 0.7);
    cairo_rectangle(p->cr, sim_visit_panel_x(p, i), top + p->height - 26, p->width, 26);
    cairo_fill(p->cr);
    sim_visit_colour(p, VISIT_TEXT);
    sim_visit_font(p, 13, false);
    sim_picture_text(p->cr, text, sim_visit_panel_x(p, i) + 10, top + p->height - 8, 0.0);
}
