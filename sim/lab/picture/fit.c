#include "sim/lab/picture/fit.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/bar.h"
#include "sim/lab/draw/png_file.h"
#include "sim/lab/picture/fit_paint.h"
#include "sim/lab/picture/relief.h"

enum { GAP_PX = 8, BAR_PX = 84, LINE_PX = 22 };

static const uint32_t found_hex = 0xffd23f, true_hex = 0x3ddc84, background_hex = 0x14161b;

/* The square around the positions of some points, larger than their extent by a factor. False if
 * none of the points has a position. */
static bool window_about(const struct iso_frame *frame, const struct iso_vec3 *points_mm,
                         const bool *chosen, size_t n, double factor, struct sim_fit_window *out)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, x, y;
    for (size_t i = 0; i < n; i++) {
        if ((!chosen || chosen[i]) && sim_relief_place(frame, points_mm[i], &x, &y)) {
            low[0] = fmin(low[0], x);
            low[1] = fmin(low[1], y);
            high[0] = fmax(high[0], x);
            high[1] = fmax(high[1], y);
        }
    }
    if (!(high[0] >= low[0])) {
        return false;
    }
    const double side = fmax(factor * fmax(high[0] - low[0], high[1] - low[1]), 16.0);
    *out = (struct sim_fit_window){0.5 * (low[0] + high[0] - side), 0.5 * (low[1] + high[1] - side),
                                   side};
    return true;
}

static struct sim_fit_window whole_window(const struct iso_frame *frame)
{
    const double side = fmax(frame->width_px, frame->height_px);
    return (struct sim_fit_window){0.5 * (frame->width_px - side), 0.5 * (frame->height_px - side),
                                   side};
}

static struct sim_fit_window window_of(const struct sim_fit_view *view)
{
    struct sim_fit_window window;
    if (window_about(view->frame, view->vertices_mm, NULL, view->n_vertices, 1.15, &window) ||
        (view->true_mm &&
         window_about(view->frame, view->true_mm, view->true_known, ISO_LANDMARKS, 2.4, &window))) {
        return window;
    }
    return whole_window(view->frame);
}

struct picture {
    const struct sim_fit_view *view;
    struct sim_fit_window window;
    struct sim_colour *grey; /* of the frame */
    struct sim_fit_head head;
    cairo_t *cr;
};

enum panel { PANEL_FRAME, PANEL_LANDMARKS, PANEL_MESH, PANEL_RESIDUALS, PANELS };

/* Draws a dark strip at the bottom of a panel, for text, and sets the size of the text. */
static void draw_strip(const struct picture *p)
{
    cairo_set_source_rgba(p->cr, 0.05, 0.055, 0.07, 0.75);
    cairo_rectangle(p->cr, 0.0, SIM_FIT_PANEL_PX - 30.0, SIM_FIT_PANEL_PX, 30.0);
    cairo_fill(p->cr);
    cairo_set_font_size(p->cr, 14.0);
}

static void draw_note(const struct picture *p, const char *text)
{
    draw_strip(p);
    cairo_set_source_rgb(p->cr, 0.86, 0.88, 0.91);
    sim_picture_text(p->cr, text, 10.0, SIM_FIT_PANEL_PX - 10.0, 0.0);
}

static void draw_mark(cairo_t *cr, double x, double y, double radius, uint32_t hex, bool filled)
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

/* Draws rings at the true landmarks, dots at the found ones, and lines between them. */
static void draw_landmarks(const struct picture *p)
{
    const struct sim_fit_view *v = p->view;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        double x[2], y[2];
        const bool found = v->found_mm && sim_relief_place(v->frame, v->found_mm[l], &x[0], &y[0]);
        const bool known = v->true_mm && v->true_known[l] &&
                           sim_relief_place(v->frame, v->true_mm[l], &x[1], &y[1]);
        for (int k = 0; k < 2; k++) {
            if (k == 0 ? found : known) {
                x[k] = (x[k] - p->window.x) * SIM_FIT_PANEL_PX / p->window.side;
                y[k] = (y[k] - p->window.y) * SIM_FIT_PANEL_PX / p->window.side;
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
            draw_mark(p->cr, x[1], y[1], 5.5, true_hex, false);
        }
        if (found) {
            draw_mark(p->cr, x[0], y[0], 3.4, found_hex, true);
        }
    }
    draw_strip(p);
    sim_picture_set_colour(p->cr, sim_colour_hex(found_hex));
    sim_picture_text(p->cr, v->found_mm ? "landmarks found" : "no landmarks found", 10.0,
                     SIM_FIT_PANEL_PX - 10.0, 0.0);
    sim_picture_set_colour(p->cr, sim_colour_hex(true_hex));
    sim_picture_text(p->cr, v->true_mm ? "true ones" : "no ground truth", SIM_FIT_PANEL_PX - 10.0,
                     SIM_FIT_PANEL_PX - 10.0, 1.0);
}

/* Draws the marks and text on top of a panel's pixels. */
static void draw_marks(const struct picture *p, enum panel panel)
{
    const struct sim_fit_window all = whole_window(p->view->frame);
    const bool head = p->view->n_vertices > 0;
    switch (panel) {
    case PANEL_FRAME:
        sim_picture_set_colour(p->cr, sim_colour_hex(found_hex));
        cairo_set_line_width(p->cr, 1.2);
        cairo_rectangle(p->cr, (p->window.x - all.x) * SIM_FIT_PANEL_PX / all.side,
                        (p->window.y - all.y) * SIM_FIT_PANEL_PX / all.side,
                        p->window.side * SIM_FIT_PANEL_PX / all.side,
                        p->window.side * SIM_FIT_PANEL_PX / all.side);
        cairo_stroke(p->cr);
        draw_note(p, "depth, lit from the upper left");
        break;
    case PANEL_LANDMARKS:
        draw_landmarks(p);
        break;
    case PANEL_MESH:
        draw_note(p, head ? "fitted head" : "no head was fitted");
        break;
    case PANEL_RESIDUALS:
        draw_note(p, head ? "residual; grey: not compared" : "no head was fitted");
        break;
    case PANELS:
        break;
    }
}

static int draw_panel(const struct picture *p, enum panel panel)
{
    struct sim_canvas *canvas = NULL;
    const struct sim_colour background = sim_colour_hex(background_hex);
    const int error = sim_canvas_new(SIM_FIT_PANEL_PX, SIM_FIT_PANEL_PX, background, background,
                                     &canvas);
    if (error) {
        return error;
    }
    const struct sim_fit_view *view = p->view;
    sim_fit_paint_frame(canvas, view->frame, p->grey,
                        panel == PANEL_FRAME ? whole_window(view->frame) : p->window);
    if (view->n_vertices > 0 && panel == PANEL_MESH) {
        sim_fit_paint_mesh(canvas, view, &p->head);
    }
    if (view->n_vertices > 0 && panel == PANEL_RESIDUALS) {
        sim_fit_paint_residuals(canvas, view, &p->head);
    }
    cairo_surface_t *surface = sim_canvas_surface(canvas);
    sim_canvas_free(canvas);
    cairo_save(p->cr);
    cairo_translate(p->cr, (int)panel % 2 * (SIM_FIT_PANEL_PX + GAP_PX),
                    (int)panel / 2 * (SIM_FIT_PANEL_PX + GAP_PX));
    cairo_rectangle(p->cr, 0.0, 0.0, SIM_FIT_PANEL_PX, SIM_FIT_PANEL_PX);
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
    const int side = 2 * SIM_FIT_PANEL_PX + GAP_PX;
    struct picture p = {
        .view = view, .window = window_of(view), .grey = sim_fit_grey_new(view->frame)};
    int error = p.grey ? 0 : -ENOMEM;
    if (!error && view->n_vertices > 0) {
        error = sim_fit_head_new(view, p.window, &p.head);
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
            .axis = {"mm", SIM_SCALE_LINEAR, -SIM_FIT_RESIDUAL_LIMIT_MM, SIM_FIT_RESIDUAL_LIMIT_MM},
            .colour = sim_colour_difference,
        };
        sim_picture_bar(p.cr, &bar, side + 12.0, SIM_FIT_PANEL_PX + GAP_PX + 40.0, side - 24.0);
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
