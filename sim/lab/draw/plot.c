#include "sim/lab/draw/plot.h"

#include <cairo.h>
#include <math.h>
#include <stdbool.h>

#include "sim/lab/draw/png_file.h"

enum { WIDTH_PX = 900, HEIGHT_PX = 640 };

/* The axes' box. */
static const double left_px = 86, right_px = WIDTH_PX - 30, top_px = 84, bottom_px = HEIGHT_PX - 74;

struct colour {
    double r, g, b;
};

/* Okabe and Ito 2008: distinguishable with any colour vision. */
static const struct colour series_colours[] = {
    {0.00, 0.45, 0.70}, {0.84, 0.37, 0.00}, {0.00, 0.62, 0.45}, {0.80, 0.47, 0.65},
    {0.90, 0.62, 0.00}, {0.34, 0.71, 0.91}, {0.10, 0.10, 0.10}, {0.55, 0.35, 0.20},
};
static const struct colour ink = {0.13, 0.15, 0.18}, faint = {0.45, 0.48, 0.52},
                           grid = {0.90, 0.91, 0.92};

static void set_colour(cairo_t *cr, struct colour c, double alpha)
{
    cairo_set_source_rgba(cr, c.r, c.g, c.b, alpha);
}

static double place_x(const struct sim_plot *plot, double x)
{
    return left_px + (right_px - left_px) * sim_axis_place(&plot->x, x);
}

static double place_y(const struct sim_plot *plot, double y)
{
    return bottom_px - (bottom_px - top_px) * sim_axis_place(&plot->y, y);
}

static void draw_line(cairo_t *cr, double x0, double y0, double x1, double y1)
{
    cairo_move_to(cr, x0, y0);
    cairo_line_to(cr, x1, y1);
    cairo_stroke(cr);
}

static void draw_ticks(cairo_t *cr, const struct sim_plot *plot)
{
    struct sim_tick ticks[SIM_TICKS_MAX];
    cairo_set_line_width(cr, 1.0);
    cairo_set_font_size(cr, 14.0);
    size_t n = sim_axis_ticks(&plot->x, ticks);
    for (size_t i = 0; i < n; i++) {
        const double x = floor(place_x(plot, ticks[i].value)) + 0.5;
        set_colour(cr, grid, 1.0);
        draw_line(cr, x, top_px, x, bottom_px);
        set_colour(cr, faint, 1.0);
        sim_picture_text(cr, ticks[i].label, x, bottom_px + 22.0, 0.5);
    }
    n = sim_axis_ticks(&plot->y, ticks);
    for (size_t i = 0; i < n; i++) {
        const double y = floor(place_y(plot, ticks[i].value)) + 0.5;
        set_colour(cr, grid, 1.0);
        draw_line(cr, left_px, y, right_px, y);
        set_colour(cr, faint, 1.0);
        sim_picture_text(cr, ticks[i].label, left_px - 10.0, y + 5.0, 1.0);
    }
}

static void draw_frame(cairo_t *cr, const struct sim_plot *plot)
{
    cairo_set_line_width(cr, 1.0);
    set_colour(cr, faint, 1.0);
    draw_line(cr, left_px, bottom_px + 0.5, right_px, bottom_px + 0.5);
    draw_line(cr, left_px - 0.5, top_px, left_px - 0.5, bottom_px);
    set_colour(cr, ink, 1.0);
    cairo_set_font_size(cr, 15.0);
    sim_picture_text(cr, plot->x.label, 0.5 * (left_px + right_px), HEIGHT_PX - 22.0, 0.5);
    cairo_save(cr);
    cairo_translate(cr, 24.0, 0.5 * (top_px + bottom_px));
    cairo_rotate(cr, -M_PI_2);
    sim_picture_text(cr, plot->y.label, 0.0, 0.0, 0.5);
    cairo_restore(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    cairo_set_font_size(cr, 20.0);
    sim_picture_text(cr, plot->title, left_px, 38.0, 0.0);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    if (plot->subtitle) {
        set_colour(cr, faint, 1.0);
        cairo_set_font_size(cr, 14.0);
        sim_picture_text(cr, plot->subtitle, left_px, 62.0, 0.0);
    }
}

static void trace_series(cairo_t *cr, const struct sim_plot *plot, const struct sim_series *series)
{
    cairo_new_path(cr);
    for (size_t i = 0; i < series->n; i++) {
        cairo_line_to(cr, place_x(plot, series->x[i]), place_y(plot, series->y[i]));
    }
}

/* After all colours were used once, lines are dashed, then dotted, then both. */
static void set_dash(cairo_t *cr, size_t number)
{
    static const double dashes[][4] = {
        {9.0, 4.0, 9.0, 4.0}, {2.5, 3.5, 2.5, 3.5}, {10.0, 3.5, 2.5, 3.5}};
    const size_t turn = number / (sizeof series_colours / sizeof *series_colours);
    if (turn == 0) {
        cairo_set_dash(cr, NULL, 0, 0.0);
    } else {
        cairo_set_dash(cr, dashes[(turn - 1) % 3], 4, 0.0);
    }
}

static void draw_series(cairo_t *cr, const struct sim_plot *plot, size_t number)
{
    const struct sim_series *series = &plot->series[number];
    const struct colour colour =
        series_colours[number % (sizeof series_colours / sizeof *series_colours)];
    if (series->n == 0) {
        return;
    }
    if (series->style == SIM_SERIES_FILLED) {
        trace_series(cr, plot, series);
        cairo_line_to(cr, place_x(plot, series->x[series->n - 1]), bottom_px);
        cairo_line_to(cr, place_x(plot, series->x[0]), bottom_px);
        set_colour(cr, colour, 0.25);
        cairo_fill(cr);
    }
    const double dash[] = {5.0, 5.0};
    const bool dashed = series->style == SIM_SERIES_DASHED;
    set_colour(cr, dashed ? faint : colour, 1.0);
    if (dashed) {
        cairo_set_line_width(cr, 1.0);
        cairo_set_dash(cr, dash, 2, 0.0);
    } else {
        cairo_set_line_width(cr, 2.5);
        set_dash(cr, number);
    }
    trace_series(cr, plot, series);
    cairo_stroke(cr);
    cairo_set_dash(cr, NULL, 0, 0.0);
    for (size_t i = 0; series->style == SIM_SERIES_MARKED && i < series->n; i++) {
        cairo_arc(cr, place_x(plot, series->x[i]), place_y(plot, series->y[i]), 4.0, 0.0,
                  2.0 * M_PI);
        cairo_fill(cr);
    }
}

/* Draws the legend along the top, right of the subtitle. */
static void draw_legend(cairo_t *cr, const struct sim_plot *plot)
{
    double x = right_px;
    cairo_set_font_size(cr, 14.0);
    for (size_t i = plot->n_series; i-- > 0;) {
        const struct sim_series *series = &plot->series[i];
        if (!series->label) {
            continue;
        }
        cairo_text_extents_t extents;
        cairo_text_extents(cr, series->label, &extents);
        x -= extents.x_advance;
        set_colour(cr, ink, 1.0);
        sim_picture_text(cr, series->label, x, 62.0, 0.0);
        const size_t n_colours = sizeof series_colours / sizeof *series_colours;
        set_colour(cr, series_colours[i % n_colours], 1.0);
        cairo_set_line_width(cr, 4.0);
        draw_line(cr, x - 30.0, 57.0, x - 8.0, 57.0);
        x -= 52.0;
    }
}

/* Draws the legend in a corner of the axes' box, one line for each series. */
static void draw_legend_lines(cairo_t *cr, const struct sim_plot *plot)
{
    enum { LINE_PX = 22, WIDTH_MIN = 190 };
    size_t n_colours = sizeof series_colours / sizeof *series_colours, n_lines = 0;
    double width = WIDTH_MIN;
    cairo_set_font_size(cr, 14.0);
    for (size_t i = 0; i < plot->n_series; i++) {
        cairo_text_extents_t extents = {.width = 0.0};
        if (plot->series[i].label) {
            n_lines++;
            cairo_text_extents(cr, plot->series[i].label, &extents);
            width = fmax(width, extents.x_advance + 48.0);
        }
    }
    const double height = LINE_PX * (double)n_lines, x = right_px - width;
    double y = plot->legend == SIM_LEGEND_UPPER ? top_px + 12.0 : bottom_px - 12.0 - height;
    cairo_set_source_rgba(cr, 1.0, 1.0, 1.0, 0.85);
    cairo_rectangle(cr, x - 8.0, y - 4.0, width, height + 8.0);
    cairo_fill(cr);
    cairo_set_font_size(cr, 14.0);
    cairo_set_line_width(cr, 4.0);
    for (size_t i = 0; i < plot->n_series; i++) {
        if (plot->series[i].label) {
            y += LINE_PX;
            set_colour(cr, series_colours[i % n_colours], 1.0);
            set_dash(cr, i);
            draw_line(cr, x, y - 10.0, x + 24.0, y - 10.0);
            cairo_set_dash(cr, NULL, 0, 0.0);
            set_colour(cr, ink, 1.0);
            sim_picture_text(cr, plot->series[i].label, x + 34.0, y - 5.0, 0.0);
        }
    }
}

int sim_plot_write(const struct sim_plot *plot, const char *path, struct iso_fault *fault)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, WIDTH_PX, HEIGHT_PX);
    cairo_t *cr = cairo_create(surface);
    cairo_set_source_rgb(cr, 1.0, 1.0, 1.0);
    cairo_paint(cr);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    draw_ticks(cr, plot);
    for (size_t i = 0; i < plot->n_series; i++) {
        draw_series(cr, plot, i);
    }
    draw_frame(cr, plot);
    if (plot->legend == SIM_LEGEND_LINE) {
        draw_legend(cr, plot);
    } else {
        draw_legend_lines(cr, plot);
    }
    cairo_destroy(cr);
    return sim_png_file_write(surface, path, fault);
}
