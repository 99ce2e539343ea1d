#include "sim/lab/picture/fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/raster.h"
#include "sim/lab/draw/bar.h"
#include "sim/lab/draw/canvas.h"
#include "sim/lab/draw/png_file.h"
#include "sim/lab/picture/relief.h"

enum {
    PANEL_PX = 440,
    GAP_PX = 8,
    BAR_PX = 84,
    LINE_PX = 22,
    SAMPLES = PANEL_PX * SIM_CANVAS_SUPERSAMPLING,
};

static const double residual_limit_mm = 8.0;
static const uint32_t found_hex = 0xffd23f, true_hex = 0x3ddc84, background_hex = 0x14161b;

/* The square of the frame that a panel shows: corner and side in pixels of the frame, whose upper
 * left pixel here reaches from (0, 0) to (1, 1). */
struct window {
    double x, y, side;
};

/* The fitted head as a panel sees it. */
struct head_raster {
    struct iso_raster raster;
    uint32_t *storage; /* of its three planes */
};

/* ---- where things are ------------------------------------------------------------- */

/* Where a point appears, in a window's units. */
static bool place(const struct iso_frame *frame, struct iso_vec3 point_mm, double *x, double *y)
{
    if (!iso_camera_project(&frame->camera, point_mm, x, y)) {
        return false;
    }
    *x += 0.5 - frame->crop_x_px;
    *y += 0.5 - frame->crop_y_px;
    return true;
}

/* The square about the places of some points, larger than their extent by a factor; false if none
 * of them can be placed. */
static bool window_about(const struct iso_frame *frame, const struct iso_vec3 *points_mm,
                         const bool *chosen, size_t n, double factor, struct window *out)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, x, y;
    for (size_t i = 0; i < n; i++) {
        if ((!chosen || chosen[i]) && place(frame, points_mm[i], &x, &y)) {
            low[0] = fmin(low[0], x);
            low[1] = fmin(low[1], y);
            high[0] = fmax(high[0], x);
            high[1] = fmax(high[1], y);
        }
    }
    if (!(high[0] >= low[0])) {
        return false;
    }
    double side = fmax(factor * fmax(high[0] - low[0], high[1] - low[1]), 16.0);
    *out = (struct window){0.5 * (low[0] + high[0] - side), 0.5 * (low[1] + high[1] - side), side};
    return true;
}

static struct window whole(const struct iso_frame *frame)
{
    double side = fmax(frame->width_px, frame->height_px);
    return (struct window){0.5 * (frame->width_px - side), 0.5 * (frame->height_px - side), side};
}

static struct window window_of(const struct sim_fit_view *view)
{
    struct window window;
    if (window_about(view->frame, view->vertices_mm, NULL, view->n_vertices, 1.15, &window) ||
        (view->true_mm &&
         window_about(view->frame, view->true_mm, view->true_known, ISO_LANDMARKS, 2.4, &window))) {
        return window;
    }
    return whole(view->frame);
}

/* ---- painting --------------------------------------------------------------------- */

/* Light and shade in grey, darker with distance; unmeasured pixels dark blue. */
static struct sim_colour *new_grey(const struct iso_frame *frame)
{
    const double fade_mm = 900.0; /* from the nearest point to where it is darkest */
    size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    struct sim_colour *grey = calloc(n, sizeof *grey);
    const struct sim_colour hole = sim_colour_hex(0x0c1a33);
    double nearest_mm = INFINITY;
    for (size_t i = 0; i < n; i++) {
        double depth = (double)frame->depth_mm[i];
        nearest_mm = depth > 0.0 ? fmin(nearest_mm, depth) : nearest_mm;
    }
    for (size_t i = 0; grey && i < n; i++) {
        int column = (int)(i % (size_t)frame->width_px), row = (int)(i / (size_t)frame->width_px);
        double depth = (double)frame->depth_mm[i];
        if (depth <= 0.0) {
            grey[i] = hole;
            continue;
        }
        /* A plane over about 8 mm. */
        double reach = 4.0 / iso_camera_pixel_mm(&frame->camera, depth);
        float light = sim_relief(frame, column, row, (int)fmin(fmax(rint(reach), 1.0), 4.0));
        light *= light; /* relief is meant for sRGB */
        light *= (float)(1.0 - 0.8 * fmin((depth - nearest_mm) / fade_mm, 1.0));
        grey[i] = sim_colour_scale(0.8f * light, (struct sim_colour){1.0f, 1.0f, 1.0f});
    }
    return grey;
}

static void paint_frame(struct sim_canvas *canvas, const struct iso_frame *frame,
                        const struct sim_colour *grey, struct window window)
{
    for (int y = 0; y < canvas->height; y++) {
        int row = (int)floor(window.y + (y + 0.5) * window.side / canvas->height);
        for (int x = 0; x < canvas->width; x++) {
            int column = (int)floor(window.x + (x + 0.5) * window.side / canvas->width);
            if (row >= 0 && row < frame->height_px && column >= 0 && column < frame->width_px) {
                sim_canvas_blend(canvas, x, y, grey[(long)row * frame->width_px + column], 1.0f);
            }
        }
    }
}

/* The frame's camera, so that the window fills so many samples. */
static struct iso_camera camera_of(const struct iso_frame *frame, struct window window)
{
    double zoom = SAMPLES / window.side;
    struct iso_camera camera = frame->camera;
    camera.width_px = camera.height_px = SAMPLES;
    camera.fx_px *= zoom;
    camera.fy_px *= zoom;
    camera.pitch_mm /= zoom;
    camera.cx_px = (camera.cx_px - frame->crop_x_px + 0.5 - window.x) * zoom - 0.5;
    camera.cy_px = (camera.cy_px - frame->crop_y_px + 0.5 - window.y) * zoom - 0.5;
    return camera;
}

static int draw_head(const struct sim_fit_view *view, struct window window, struct head_raster *out)
{
    enum { PLANES = 4 }; /* depth, triangle, two weights */
    size_t n = (size_t)SAMPLES * SAMPLES;
    out->storage = calloc(PLANES * n, sizeof *out->storage);
    if (!out->storage) {
        return -ENOMEM;
    }
    out->raster = (struct iso_raster){
        .camera = camera_of(view->frame, window),
        .width_px = SAMPLES,
        .height_px = SAMPLES,
        .depth_mm = (float *)out->storage,
        .triangle = (int32_t *)(out->storage + n),
        .weight = (float(*)[2])(out->storage + 2 * n),
    };
    iso_raster_clear(&out->raster);
    iso_raster_triangles(&out->raster, view->vertices_mm, view->triangles,
                         (int32_t)view->n_triangles, 0, 1.0, 1);
    return 0;
}

/* How bright a triangle is under a light at the upper left. */
static float triangle_light(const struct sim_fit_view *view, int32_t triangle)
{
    const uint32_t *c = view->triangles[triangle];
    struct iso_vec3 a = view->vertices_mm[c[0]];
    struct iso_vec3 normal = iso_unit(
        iso_cross(iso_sub(view->vertices_mm[c[1]], a), iso_sub(view->vertices_mm[c[2]], a)));
    return (float)fmax(0.12, iso_dot(normal, iso_unit(iso_vec3(-1.0, -1.0, -2.0))));
}

static void paint_mesh(struct sim_canvas *canvas, const struct sim_fit_view *view,
                       const struct head_raster *head)
{
    const struct sim_colour base = sim_colour_hex(0x8fb8ff), edge = sim_colour_hex(0x10306b);
    for (long i = 0; i < (long)SAMPLES * SAMPLES; i++) {
        int32_t triangle = head->raster.triangle[i];
        if (triangle >= 0) {
            const float *w = head->raster.weight[i];
            float nearest = fminf(fminf(w[0], w[1]), 1.0f - w[0] - w[1]);
            bool on_edge = nearest < 0.05f;
            struct sim_colour colour = sim_colour_scale(triangle_light(view, triangle), base);
            int x = (int)(i % SAMPLES), y = (int)(i / SAMPLES);
            sim_canvas_blend(canvas, x, y, on_edge ? edge : colour, 0.6f);
        }
    }
}

/* The colour of the residual between the corners of a triangle; grey towards those not measured. */
static struct sim_colour residual_colour(const struct sim_fit_view *view, int32_t triangle,
                                         const float weight[2])
{
    const struct sim_colour unknown = sim_colour_hex(0x4a4d55);
    const float share[3] = {1.0f - weight[0] - weight[1], weight[0], weight[1]};
    float sum_mm = 0.0f, measured = 0.0f;
    for (int k = 0; k < 3; k++) {
        uint32_t corner = view->triangles[triangle][k];
        if (view->measured[corner]) {
            sum_mm += share[k] * view->residual_mm[corner];
            measured += share[k];
        }
    }
    if (measured <= 0.0f) {
        return unknown;
    }
    double value = 0.5 + 0.5 * (double)(sum_mm / measured) / residual_limit_mm;
    return sim_colour_mix(unknown, sim_colour_difference(value), measured);
}

/* Lit a little, so that the face can be made out. */
static void paint_residuals(struct sim_canvas *canvas, const struct sim_fit_view *view,
                            const struct head_raster *head)
{
    for (long i = 0; i < (long)SAMPLES * SAMPLES; i++) {
        int32_t triangle = head->raster.triangle[i];
        if (triangle >= 0) {
            float light = 0.65f + 0.35f * triangle_light(view, triangle);
            struct sim_colour colour = residual_colour(view, triangle, head->raster.weight[i]);
            sim_canvas_blend(canvas, (int)(i % SAMPLES), (int)(i / SAMPLES),
                             sim_colour_scale(light, colour), 1.0f);
        }
    }
}

/* ---- panels ----------------------------------------------------------------------- */

struct picture {
    const struct sim_fit_view *view;
    struct window window;
    struct sim_colour *grey; /* of the frame */
    struct head_raster head;
    cairo_t *cr;
};

enum panel { PANEL_FRAME, PANEL_LANDMARKS, PANEL_MESH, PANEL_RESIDUALS, PANELS };

/* A dark strip at the bottom of a panel, for words. */
static void strip(const struct picture *p)
{
    cairo_set_source_rgba(p->cr, 0.05, 0.055, 0.07, 0.75);
    cairo_rectangle(p->cr, 0.0, PANEL_PX - 30.0, PANEL_PX, 30.0);
    cairo_fill(p->cr);
    cairo_set_font_size(p->cr, 14.0);
}

static void note(const struct picture *p, const char *text)
{
    strip(p);
    cairo_set_source_rgb(p->cr, 0.86, 0.88, 0.91);
    sim_picture_text(p->cr, text, 10.0, PANEL_PX - 10.0, 0.0);
}

static void mark(cairo_t *cr, double x, double y, double radius, uint32_t hex, bool filled)
{
    cairo_new_path(cr);
    cairo_arc(cr, x, y, radius, 0.0, 2.0 * M_PI);
    sim_picture_set_colour(cr, sim_colour_hex(hex));
    if (filled) {
        cairo_fill_preserve(cr);
        cairo_set_source_rgb(cr, 0.05, 0.05, 0.05);
    }
    cairo_set_line_width(cr, filled ? 1.0 : 2.2);
    cairo_stroke(cr);
}

/* Rings where the landmarks are, dots where they were found, and what lies between. */
static void draw_landmarks(const struct picture *p)
{
    const struct sim_fit_view *v = p->view;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        double x[2], y[2];
        bool found = v->found_mm && place(v->frame, v->found_mm[l], &x[0], &y[0]);
        bool known = v->true_mm && v->true_known[l] && place(v->frame, v->true_mm[l], &x[1], &y[1]);
        for (int k = 0; k < 2; k++) {
            if (k == 0 ? found : known) {
                x[k] = (x[k] - p->window.x) * PANEL_PX / p->window.side;
                y[k] = (y[k] - p->window.y) * PANEL_PX / p->window.side;
            }
        }
        if (found && known) {
            cairo_set_source_rgb(p->cr, 1.0, 0.25, 0.2);
            cairo_set_line_width(p->cr, 2.0);
            cairo_move_to(p->cr, x[0], y[0]);
            cairo_line_to(p->cr, x[1], y[1]);
            cairo_stroke(p->cr);
        }
        if (known) {
            mark(p->cr, x[1], y[1], 5.5, true_hex, false);
        }
        if (found) {
            mark(p->cr, x[0], y[0], 3.4, found_hex, true);
        }
    }
    strip(p);
    sim_picture_set_colour(p->cr, sim_colour_hex(found_hex));
    sim_picture_text(p->cr, v->found_mm ? "landmarks found" : "no landmarks found", 10.0,
                     PANEL_PX - 10.0, 0.0);
    sim_picture_set_colour(p->cr, sim_colour_hex(true_hex));
    sim_picture_text(p->cr, v->true_mm ? "true ones" : "no ground truth", PANEL_PX - 10.0,
                     PANEL_PX - 10.0, 1.0);
}

/* What is drawn on top of a panel's pixels. */
static void draw_marks(const struct picture *p, enum panel panel)
{
    const struct window all = whole(p->view->frame);
    bool head = p->view->n_vertices > 0;
    switch (panel) {
    case PANEL_FRAME:
        sim_picture_set_colour(p->cr, sim_colour_hex(found_hex));
        cairo_set_line_width(p->cr, 1.2);
        cairo_rectangle(p->cr, (p->window.x - all.x) * PANEL_PX / all.side,
                        (p->window.y - all.y) * PANEL_PX / all.side,
                        p->window.side * PANEL_PX / all.side, p->window.side * PANEL_PX / all.side);
        cairo_stroke(p->cr);
        note(p, "depth, lit from the upper left");
        break;
    case PANEL_LANDMARKS:
        draw_landmarks(p);
        break;
    case PANEL_MESH:
        note(p, head ? "fitted head" : "no head was fitted");
        break;
    case PANEL_RESIDUALS:
        note(p, head ? "residual; grey: not compared" : "no head was fitted");
        break;
    case PANELS:
        break;
    }
}

static int draw_panel(const struct picture *p, enum panel panel)
{
    struct sim_canvas *canvas = NULL;
    const struct sim_colour background = sim_colour_hex(background_hex);
    int error = sim_canvas_new(PANEL_PX, PANEL_PX, background, background, &canvas);
    if (error) {
        return error;
    }
    const struct sim_fit_view *view = p->view;
    paint_frame(canvas, view->frame, p->grey,
                panel == PANEL_FRAME ? whole(view->frame) : p->window);
    if (view->n_vertices > 0 && panel == PANEL_MESH) {
        paint_mesh(canvas, view, &p->head);
    }
    if (view->n_vertices > 0 && panel == PANEL_RESIDUALS) {
        paint_residuals(canvas, view, &p->head);
    }
    cairo_surface_t *surface = sim_canvas_surface(canvas);
    sim_canvas_free(canvas);
    cairo_save(p->cr);
    cairo_translate(p->cr, (int)panel % 2 * (PANEL_PX + GAP_PX),
                    (int)panel / 2 * (PANEL_PX + GAP_PX));
    cairo_rectangle(p->cr, 0.0, 0.0, PANEL_PX, PANEL_PX);
    cairo_clip(p->cr);
    cairo_set_source_surface(p->cr, surface, 0.0, 0.0);
    cairo_paint(p->cr);
    cairo_surface_destroy(surface);
    draw_marks(p, panel);
    cairo_restore(p->cr);
    return 0;
}

static void draw_caption(const struct picture *p, double y)
{
    for (int i = 0; i < SIM_FIT_CAPTIONS; i++) {
        if (p->view->caption[i]) {
            cairo_select_font_face(p->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                                   i == 0 ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
            cairo_set_font_size(p->cr, 14.0);
            cairo_set_source_rgb(p->cr, 0.9, 0.91, 0.94);
            sim_picture_text(p->cr, p->view->caption[i], 10.0, y + LINE_PX * (i + 1), 0.0);
        }
    }
}

int sim_picture_fit(const struct sim_fit_view *view, const char *path, struct iso_fault *fault)
{
    const int side = 2 * PANEL_PX + GAP_PX;
    struct picture p = {.view = view, .window = window_of(view), .grey = new_grey(view->frame)};
    int error = p.grey ? 0 : -ENOMEM;
    if (!error && view->n_vertices > 0) {
        error = draw_head(view, p.window, &p.head);
    }
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, side + BAR_PX,
                                                          side + LINE_PX * SIM_FIT_CAPTIONS + 14);
    p.cr = cairo_create(surface);
    cairo_select_font_face(p.cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    sim_picture_set_colour(p.cr, sim_colour_hex(background_hex));
    cairo_paint(p.cr);
    for (int panel = 0; !error && panel < PANELS; panel++) {
        error = draw_panel(&p, (enum panel)panel);
    }
    if (view->n_vertices > 0) {
        const struct sim_bar bar = {
            .axis = {"mm", SIM_SCALE_LINEAR, -residual_limit_mm, residual_limit_mm},
            .colour = sim_colour_difference,
        };
        sim_picture_bar(p.cr, &bar, side + 12.0, PANEL_PX + GAP_PX + 40.0, side - 24.0);
    }
    draw_caption(&p, side);
    cairo_destroy(p.cr);
    free(p.grey);
    free(p.head.storage);
    if (error) {
        cairo_surface_destroy(surface);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return sim_png_file_write(surface, path, fault);
}
