#include "sim/lab/picture/visit.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/bar.h"
#include "sim/lab/draw/png_file.h"
#include "sim/lab/draw/scale.h"
#include "sim/lab/picture/relief.h"

enum {
    WIDTH_PX = 1200,
    MARGIN_PX = 40,
    HEAD_PX = 96,
    PANEL_WIDTH_MAX_PX = 556,
    PANEL_HEIGHT_MAX_PX = 400,
    GAP_PX = 8,
    SCORES_PX = 190,
    RELAY_PX = 170,
    BACKGROUND = 0x14161b,
    PANEL = 0x1d2027,
    TEXT = 0xe6e8ee,
    FAINT = 0x8b92a1,
    FACE = 0x6fb1ff,
    LANDMARK = 0xffd23f,
    GOOD = 0x3ddc84,
    BAD = 0xff5d5d,
};

struct picture {
    const struct sim_visit_view *view;
    cairo_t *cr;
    int n;                /* frames that are drawn */
    double width, height; /* of the panel of a frame, px */
    double score_max;
};

static void set_colour(const struct picture *p, uint32_t hex)
{
    sim_picture_set_colour(p->cr, sim_colour_hex(hex));
}

static void set_font(const struct picture *p, double size, bool bold)
{
    cairo_select_font_face(p->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(p->cr, size);
}

static void box(const struct picture *p, double x, double y, double width, double height)
{
    set_colour(p, PANEL);
    cairo_rectangle(p->cr, x, y, width, height);
    cairo_fill(p->cr);
}

static double panel_x(const struct picture *p, int i)
{
    return MARGIN_PX + i * (p->width + GAP_PX);
}

/* ---- a frame ---- */

/* What of the frame is shown, in pixels of the frame. */
struct window {
    double x, y, width, height;
};

static bool place(const struct iso_frame *frame, struct iso_vec3 point_mm, double *x, double *y)
{
    if (!iso_camera_project(&frame->camera, point_mm, x, y)) {
        return false;
    }
    *x += 0.5 - frame->crop_x_px;
    *y += 0.5 - frame->crop_y_px;
    return true;
}

/* Twice as high as the face; without one as high as the frame. */
static struct window window_of(const struct picture *p, const struct sim_visit_frame *f)
{
    const double aspect = p->width / p->height;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, x, y;
    for (int i = 0; f->ibug_mm && i < ISO_LANDMARKS_IBUG; i++) {
        if (place(f->frame, f->ibug_mm[i], &x, &y)) {
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
    /* The landmarks reach from the brows to the chin: the forehead is above them. */
    return (struct window){0.5 * (low[0] + high[0] - aspect * height),
                           0.5 * (low[1] + high[1] - 1.12 * height), aspect * height, height};
}

static uint32_t grey_of(const struct iso_frame *frame, int column, int row, double nearest_mm)
{
    if (column < 0 || row < 0 || column >= frame->width_px || row >= frame->height_px) {
        return PANEL;
    }
    const double depth_mm = (double)iso_frame_depth_at(frame, column, row);
    if (depth_mm <= 0.0) {
        return 0x0c1a33; /* not measured */
    }
    const double reach = 4.0 / iso_camera_pixel_mm(&frame->camera, depth_mm);
    double light = (double)sim_relief(frame, column, row, (int)fmin(fmax(rint(reach), 1.0), 4.0));
    light *= 1.0 - 0.6 * fmin((depth_mm - nearest_mm) / 900.0, 1.0);
    const uint32_t byte = (uint32_t)lrint(235.0 * light);
    return byte << 16 | byte << 8 | byte;
}

static double nearest_of(const struct iso_frame *frame)
{
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    double nearest_mm = INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double depth_mm = (double)frame->depth_mm[i];
        nearest_mm = depth_mm > 0.0 ? fmin(nearest_mm, depth_mm) : nearest_mm;
    }
    return nearest_mm;
}

/* The window's pixels as they are; Cairo enlarges them. */
static cairo_surface_t *new_relief(const struct iso_frame *frame, struct window window)
{
    const int width = (int)ceil(window.width) + 1, height = (int)ceil(window.height) + 1;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    if (cairo_surface_status(surface)) {
        return surface;
    }
    const double nearest_mm = nearest_of(frame);
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

/* The 68 points of a face are lines from point to point, some of them closed (Sagonas et al. 2013).
 */
static const struct {
    int first, last;
    bool closed;
} lines[] = {
    {0, 16, false}, {17, 21, false}, {22, 26, false}, {27, 30, false}, {31, 35, false},
    {36, 41, true}, {42, 47, true},  {48, 59, true},  {60, 67, true},
};

static void draw_face(const struct picture *p, const struct sim_visit_frame *f)
{
    double x, y;
    set_colour(p, FACE);
    cairo_new_path(p->cr);
    for (size_t l = 0; l < sizeof lines / sizeof *lines; l++) {
        cairo_new_sub_path(p->cr);
        for (int i = lines[l].first; i <= lines[l].last; i++) {
            if (place(f->frame, f->ibug_mm[i], &x, &y)) {
                cairo_line_to(p->cr, x, y);
            }
        }
        if (lines[l].closed) {
            cairo_close_path(p->cr);
        }
    }
}

static void draw_landmarks(const struct picture *p, const struct sim_visit_frame *f, double zoom)
{
    double x, y;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (place(f->frame, f->landmark_mm[l], &x, &y)) {
            cairo_new_path(p->cr);
            cairo_arc(p->cr, x, y, 3.6 / zoom, 0.0, 2.0 * M_PI);
            set_colour(p, LANDMARK);
            cairo_fill_preserve(p->cr);
            cairo_set_source_rgb(p->cr, 0.05, 0.05, 0.05);
            cairo_set_line_width(p->cr, 1.0 / zoom);
            cairo_stroke(p->cr);
        }
    }
}

static void draw_frame(const struct picture *p, int i, double top)
{
    const struct sim_visit_frame *f = &p->view->frames[i];
    const struct window window = window_of(p, f);
    const double zoom = p->height / window.height;
    cairo_surface_t *relief = new_relief(f->frame, window);
    char text[64];
    cairo_save(p->cr);
    cairo_rectangle(p->cr, panel_x(p, i), top, p->width, p->height);
    cairo_clip(p->cr);
    cairo_translate(p->cr, panel_x(p, i), top);
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
    cairo_rectangle(p->cr, panel_x(p, i), top + p->height - 26, p->width, 26);
    cairo_fill(p->cr);
    set_colour(p, TEXT);
    set_font(p, 13, false);
    sim_picture_text(p->cr, text, panel_x(p, i) + 10, top + p->height - 8, 0.0);
}

/* ---- scores ---- */

static double score_y(const struct picture *p, double score, double top)
{
    const double share = fmin(fmax(score / p->score_max, 0.0), 1.0);
    return top + SCORES_PX - 34 - share * (SCORES_PX - 64);
}

static void draw_score(const struct picture *p, int i, double top)
{
    const struct sim_visit_frame *f = &p->view->frames[i];
    const double middle = panel_x(p, i) + p->width / 2.0, base = top + SCORES_PX - 34;
    const bool reaches = f->scored && f->score >= p->view->threshold;
    char text[32];
    if (f->scored) {
        const double y = score_y(p, f->score, top);
        set_colour(p, reaches ? GOOD : BAD);
        cairo_rectangle(p->cr, middle - 34, y, 68, base - y);
        cairo_fill(p->cr);
        (void)snprintf(text, sizeof text, "%.2f", f->score);
        set_font(p, 17, true);
        sim_picture_text(p->cr, text, middle, y - 8, 0.5);
    }
    set_colour(p, TEXT);
    set_font(p, 13, false);
    sim_picture_text(p->cr, f->word, middle, base + 22, 0.5);
}

static void draw_scores(const struct picture *p, double top)
{
    const double right = panel_x(p, p->n - 1) + p->width;
    const double y = score_y(p, p->view->threshold, top);
    const double dashes[] = {7, 5};
    char text[48];
    for (int i = 0; i < p->n; i++) {
        box(p, panel_x(p, i), top, p->width, SCORES_PX);
        draw_score(p, i, top);
    }
    set_colour(p, TEXT);
    cairo_set_line_width(p->cr, 1.4);
    cairo_set_dash(p->cr, dashes, 2, 0);
    cairo_move_to(p->cr, MARGIN_PX, y);
    cairo_line_to(p->cr, right, y);
    cairo_stroke(p->cr);
    cairo_set_dash(p->cr, NULL, 0, 0);
    set_font(p, 13, false);
    (void)snprintf(text, sizeof text, "threshold %.2f", p->view->threshold);
    sim_picture_text(p->cr, text, MARGIN_PX + 10, y - 7, 0.0);
    set_colour(p, FAINT);
    sim_picture_text(p->cr, "score", MARGIN_PX + 10, top + 20, 0.0);
}

/* ---- the relay ---- */

struct lane {
    double left, right, high, low; /* px; of the curve */
    struct sim_axis axis;
};

static double lane_x(const struct lane *lane, double t_s)
{
    return lane->left + sim_axis_place(&lane->axis, t_s) * (lane->right - lane->left);
}

static void trace_relay(const struct picture *p, const struct lane *lane)
{
    const struct sim_visit_view *v = p->view;
    double y = lane->low;
    cairo_new_path(p->cr);
    cairo_move_to(p->cr, lane->left, y);
    for (int i = 0; i < v->n_switches; i++) {
        const double x = lane_x(lane, v->switches[i].t_s);
        cairo_line_to(p->cr, x, y);
        y = v->switches[i].active ? lane->high : lane->low;
        cairo_line_to(p->cr, x, y);
    }
    cairo_line_to(p->cr, lane->right, y);
}

static void draw_time_axis(const struct picture *p, const struct lane *lane)
{
    struct sim_tick ticks[SIM_TICKS_MAX];
    const size_t n = sim_axis_ticks(&lane->axis, ticks);
    set_colour(p, FAINT);
    set_font(p, 13, false);
    for (size_t i = 0; i < n; i++) {
        const double x = lane_x(lane, ticks[i].value);
        cairo_set_line_width(p->cr, 1.0);
        cairo_move_to(p->cr, x, lane->low + 8);
        cairo_line_to(p->cr, x, lane->low + 14);
        cairo_stroke(p->cr);
        sim_picture_text(p->cr, ticks[i].label, x, lane->low + 31, 0.5);
    }
    sim_picture_text(p->cr, "seconds since the visitor came", lane->right, lane->low + 50, 1.0);
}

/* When the frames came, and when it was decided. */
static void draw_moments(const struct picture *p, const struct lane *lane)
{
    const struct sim_visit_view *v = p->view;
    set_colour(p, LANDMARK);
    cairo_set_line_width(p->cr, 2.0);
    for (int i = 0; i < v->n_frames; i++) {
        const double x = lane_x(lane, v->frames[i].t_s);
        cairo_move_to(p->cr, x, lane->low + 2);
        cairo_line_to(p->cr, x, lane->low + 12);
        cairo_stroke(p->cr);
    }
    set_font(p, 13, false);
    sim_picture_text(p->cr, "frames", lane->left, lane->low + 50, 0.0);
    if (v->decided) {
        const double x = lane_x(lane, v->verdict_s);
        set_colour(p, v->allowed ? GOOD : BAD);
        cairo_move_to(p->cr, x, lane->high - 16);
        cairo_line_to(p->cr, x, lane->low);
        cairo_stroke(p->cr);
        sim_picture_text(p->cr, "verdict", x + 6, lane->high - 8, 0.0);
    }
}

static void draw_relay(const struct picture *p, double top)
{
    const double width = WIDTH_PX - 2 * MARGIN_PX;
    const struct lane lane = {
        .left = MARGIN_PX + 120,
        .right = WIDTH_PX - MARGIN_PX - 24,
        .high = top + 46,
        .low = top + 104,
        .axis = {NULL, SIM_SCALE_LINEAR, 0.0, fmax(1.05 * p->view->end_s, 0.1)},
    };
    box(p, MARGIN_PX, top, width, RELAY_PX);
    trace_relay(p, &lane);
    cairo_line_to(p->cr, lane.right, lane.low);
    sim_picture_set_colour(p->cr, sim_colour_scale(0.35f, sim_colour_hex(GOOD)));
    cairo_fill(p->cr);
    trace_relay(p, &lane);
    set_colour(p, p->view->n_switches > 0 ? GOOD : FAINT);
    cairo_set_line_width(p->cr, 2.4);
    cairo_stroke(p->cr);
    set_colour(p, TEXT);
    set_font(p, 14, true);
    sim_picture_text(p->cr, "relay", MARGIN_PX + 16, top + 80, 0.0);
    set_font(p, 13, false);
    set_colour(p, FAINT);
    sim_picture_text(p->cr, "open", lane.left - 12, lane.high + 5, 1.0);
    sim_picture_text(p->cr, "locked", lane.left - 12, lane.low + 4, 1.0);
    draw_time_axis(p, &lane);
    draw_moments(p, &lane);
}

/* ---- all of it ---- */

static void draw_head(const struct picture *p)
{
    set_colour(p, p->view->allowed ? GOOD : BAD);
    set_font(p, 30, true);
    sim_picture_text(p->cr, p->view->title, MARGIN_PX, 48, 0.0);
    set_colour(p, FAINT);
    set_font(p, 15, false);
    sim_picture_text(p->cr, p->view->subtitle, MARGIN_PX, 76, 0.0);
}

static double highest_score(const struct sim_visit_view *view)
{
    double highest = 1.25 * view->threshold;
    for (int i = 0; i < view->n_frames; i++) {
        highest = view->frames[i].scored ? fmax(highest, view->frames[i].score) : highest;
    }
    return highest;
}

int sim_picture_visit(const struct sim_visit_view *view, const char *path, struct iso_fault *fault)
{
    struct picture p = {.view = view, .score_max = highest_score(view)};
    p.n = view->n_frames < SIM_VISIT_PANELS ? view->n_frames : SIM_VISIT_PANELS;
    const int shown = p.n > 0 ? p.n : 1;
    p.width = fmin((WIDTH_PX - 2.0 * MARGIN_PX - (shown - 1) * GAP_PX) / shown, PANEL_WIDTH_MAX_PX);
    p.height = fmin(p.width, PANEL_HEIGHT_MAX_PX);
    const double scores = HEAD_PX + p.height + GAP_PX;
    const double relay = p.n > 0 ? scores + SCORES_PX + 2 * GAP_PX : HEAD_PX;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, WIDTH_PX,
                                                          (int)relay + RELAY_PX + MARGIN_PX);
    p.cr = cairo_create(surface);
    set_colour(&p, BACKGROUND);
    cairo_paint(p.cr);
    draw_head(&p);
    for (int i = 0; i < p.n; i++) {
        draw_frame(&p, i, HEAD_PX);
    }
    if (p.n > 0) {
        draw_scores(&p, scores);
    }
    draw_relay(&p, relay);
    cairo_destroy(p.cr);
    return sim_png_file_write(surface, path, fault);
}
