#include <math.h>
#include <stddef.h>

#include "sim/lab/draw/scale.h"
#include "sim/lab/picture/visit_parts.h"

struct lane {
    double left, right, high, low; /* px: the curve's ends; its height with power, without */
    struct sim_axis axis;
};

static double lane_x(const struct lane *lane, double t_s)
{
    return lane->left + sim_axis_place(&lane->axis, t_s) * (lane->right - lane->left);
}

static void trace_relay(const struct sim_visit_picture *p, const struct lane *lane)
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

static void draw_time_axis(const struct sim_visit_picture *p, const struct lane *lane)
{
    struct sim_tick ticks[SIM_TICKS_MAX];
    const size_t n = sim_axis_ticks(&lane->axis, ticks);
    sim_visit_colour(p, VISIT_FAINT);
    sim_visit_font(p, 13, false);
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

/* Draws the times of the frames and of the verdict. */
static void draw_moments(const struct sim_visit_picture *p, const struct lane *lane)
{
    const struct sim_visit_view *v = p->view;
    sim_visit_colour(p, VISIT_LANDMARK);
    cairo_set_line_width(p->cr, 2.0);
    for (int i = 0; i < v->n_frames; i++) {
        const double x = lane_x(lane, v->frames[i].t_s);
        cairo_move_to(p->cr, x, lane->low + 2);
        cairo_line_to(p->cr, x, lane->low + 12);
        cairo_stroke(p->cr);
    }
    sim_visit_font(p, 13, false);
    sim_picture_text(p->cr, "frames", lane->left, lane->low + 50, 0.0);
    if (v->decided) {
        const double x = lane_x(lane, v->verdict_s);
        sim_visit_colour(p, v->allowed ? VISIT_GOOD : VISIT_BAD);
        cairo_move_to(p->cr, x, lane->high - 16);
        cairo_line_to(p->cr, x, lane->low);
        cairo_stroke(p->cr);
        sim_picture_text(p->cr, "verdict", x + 6, lane->high - 8, 0.0);
    }
}

void sim_visit_draw_relay(const struct sim_visit_picture *p, double top)
{
    const double width = VISIT_WIDTH_PX - 2 * VISIT_MARGIN_PX;
    const struct lane lane = {
        .left = VISIT_MARGIN_PX + 120,
        .right = VISIT_WIDTH_PX - VISIT_MARGIN_PX - 24,
        .high = top + 46,
        .low = top + 104,
        .axis = {NULL, SIM_SCALE_LINEAR, 0.0, fmax(1.05 * p->view->end_s, 0.1)},
    };
    sim_visit_box(p, VISIT_MARGIN_PX, top, width, VISIT_RELAY_PX);
    trace_relay(p, &lane);
    cairo_line_to(p->cr, lane.right, lane.low);
    sim_picture_set_colour(p->cr, sim_colour_scale(0.35f, sim_colour_hex(VISIT_GOOD)));
    cairo_fill(p->cr);
    trace_relay(p, &lane);
    sim_visit_colour(p, p->view->n_switches > 0 ? VISIT_GOOD : VISIT_FAINT);
    cairo_set_line_width(p->cr, 2.4);
    cairo_stroke(p->cr);
    sim_visit_colour(p, VISIT_TEXT);
    sim_visit_font(p, 14, true);
    sim_picture_text(p->cr, "relay", VISIT_MARGIN_PX + 16, top + 80, 0.0);
    sim_visit_font(p, 13, false);
    sim_visit_colour(p, VISIT_FAINT);
    sim_picture_text(p->cr, "open", lane.left - 12, lane.high + 5, 1.0);
    sim_picture_text(p->cr, "locked", lane.left - 12, lane.low + 4, 1.0);
    draw_time_axis(p, &lane);
    draw_moments(p, &lane);
}
