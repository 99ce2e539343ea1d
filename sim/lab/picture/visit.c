#include "sim/lab/picture/visit.h"

#include <math.h>
#include <stdio.h>

#include "sim/lab/draw/scale.h"
#include "sim/lab/picture/visit_parts.h"

void sim_visit_colour(const struct sim_visit_picture *p, uint32_t hex)
{
    sim_picture_set_colour(p->cr, sim_colour_hex(hex));
}

void sim_visit_font(const struct sim_visit_picture *p, double size, bool bold)
{
    cairo_select_font_face(p->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(p->cr, size);
}

void sim_visit_box(const struct sim_visit_picture *p, double x, double y, double width,
                   double height)
{
    sim_visit_colour(p, VISIT_PANEL);
    cairo_rectangle(p->cr, x, y, width, height);
    cairo_fill(p->cr);
}

double sim_visit_panel_x(const struct sim_visit_picture *p, int i)
{
    return VISIT_MARGIN_PX + i * (p->width + VISIT_GAP_PX);
}

static double score_y(const struct sim_visit_picture *p, double score, double top)
{
    const double share = fmin(fmax(score / p->score_max, 0.0), 1.0);
    return top + VISIT_SCORES_PX - 34 - share * (VISIT_SCORES_PX - 64);
}

static void draw_score(const struct sim_visit_picture *p, int i, double top)
{
    const struct sim_visit_frame *f = &p->view->frames[i];
    const double middle = sim_visit_panel_x(p, i) + p->width / 2.0,
                 base = top + VISIT_SCORES_PX - 34;
    const bool reaches = f->scored && f->score >= p->view->threshold;
    char text[32];
    if (f->scored) {
        const double y = score_y(p, f->score, top);
        sim_visit_colour(p, reaches ? VISIT_GOOD : VISIT_BAD);
        cairo_rectangle(p->cr, middle - 34, y, 68, base - y);
        cairo_fill(p->cr);
        (void)snprintf(text, sizeof text, "%.2f", f->score);
        sim_visit_font(p, 17, true);
        sim_picture_text(p->cr, text, middle, y - 8, 0.5);
    }
    sim_visit_colour(p, VISIT_TEXT);
    sim_visit_font(p, 13, false);
    sim_picture_text(p->cr, f->word, middle, base + 22, 0.5);
}

static void draw_scores(const struct sim_visit_picture *p, double top)
{
    const double right = sim_visit_panel_x(p, p->n - 1) + p->width;
    const double y = score_y(p, p->view->threshold, top);
    const double dashes[] = {7, 5};
    char text[48];
    for (int i = 0; i < p->n; i++) {
        sim_visit_box(p, sim_visit_panel_x(p, i), top, p->width, VISIT_SCORES_PX);
        draw_score(p, i, top);
    }
    sim_visit_colour(p, VISIT_TEXT);
    cairo_set_line_width(p->cr, 1.4);
    cairo_set_dash(p->cr, dashes, 2, 0);
    cairo_move_to(p->cr, VISIT_MARGIN_PX, y);
    cairo_line_to(p->cr, right, y);
    cairo_stroke(p->cr);
    cairo_set_dash(p->cr, NULL, 0, 0);
    sim_visit_font(p, 13, false);
    (void)snprintf(text, sizeof text, "threshold %.2f", p->view->threshold);
    sim_picture_text(p->cr, text, VISIT_MARGIN_PX + 10, y - 7, 0.0);
    sim_visit_colour(p, VISIT_FAINT);
    sim_picture_text(p->cr, "score", VISIT_MARGIN_PX + 10, top + 20, 0.0);
}

static void draw_head(const struct sim_visit_picture *p)
{
    sim_visit_colour(p, p->view->allowed ? VISIT_GOOD : VISIT_BAD);
    sim_visit_font(p, 30, true);
    sim_picture_text(p->cr, p->view->title, VISIT_MARGIN_PX, 48, 0.0);
    sim_visit_colour(p, VISIT_FAINT);
    sim_visit_font(p, 15, false);
    sim_picture_text(p->cr, p->view->subtitle, VISIT_MARGIN_PX, 76, 0.0);
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
    struct sim_visit_picture p = {.view = view, .score_max = highest_score(view)};
    p.n = view->n_frames < SIM_VISIT_PANELS ? view->n_frames : SIM_VISIT_PANELS;
    const int shown = p.n > 0 ? p.n : 1;
    p.width = fmin((VISIT_WIDTH_PX - 2.0 * VISIT_MARGIN_PX - (shown - 1) * VISIT_GAP_PX) / shown,
                   VISIT_PANEL_WIDTH_MAX_PX);
    p.height = fmin(p.width, VISIT_PANEL_HEIGHT_MAX_PX);
    const double scores = VISIT_HEAD_PX + p.height + VISIT_GAP_PX;
    const double relay = p.n > 0 ? scores + VISIT_SCORES_PX + 2 * VISIT_GAP_PX : VISIT_HEAD_PX;
    cairo_surface_t *surface = cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, VISIT_WIDTH_PX, (int)relay + VISIT_RELAY_PX + VISIT_MARGIN_PX);
    p.cr = cairo_create(surface);
    sim_visit_colour(&p, VISIT_BACKGROUND);
    cairo_paint(p.cr);
    draw_head(&p);
    for (int i = 0; i < p.n; i++) {
        sim_visit_draw_frame(&p, i, VISIT_HEAD_PX);
    }
    if (p.n > 0) {
        draw_scores(&p, scores);
    }
    sim_visit_draw_relay(&p, relay);
    cairo_destroy(p.cr);
    return sim_png_file_write(surface, path, fault);
}
