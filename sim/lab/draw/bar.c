#include "sim/lab/draw/bar.h"

#include "sim/lab/draw/png_file.h"

void sim_picture_set_colour(cairo_t *cr, struct sim_colour colour)
{
    cairo_set_source_rgb(cr, sim_colour_byte(colour.r) / 255.0, sim_colour_byte(colour.g) / 255.0,
                         sim_colour_byte(colour.b) / 255.0);
}

void sim_picture_bar(cairo_t *cr, const struct sim_bar *bar, double x, double top, double bottom)
{
    for (double y = top; y < bottom; y += 1.0) {
        const double down = (y - top) / (bottom - top);
        sim_picture_set_colour(cr, bar->colour(bar->falling ? down : 1.0 - down));
        cairo_rectangle(cr, x, y, 18.0, 1.0);
        cairo_fill(cr);
    }
    cairo_set_source_rgb(cr, 0.85, 0.87, 0.9);
    cairo_set_font_size(cr, 13.0);
    sim_picture_text(cr, bar->axis.label, x, top - 16.0, 0.0);
    struct sim_tick ticks[SIM_TICKS_MAX];
    const size_t n = sim_axis_ticks(&bar->axis, ticks);
    for (size_t i = 0; i < n; i++) {
        const double share = sim_axis_place(&bar->axis, ticks[i].value);
        const double y = top + (bottom - top) * (bar->falling ? share : 1.0 - share);
        sim_picture_text(cr, ticks[i].label, x + 26.0, y + 5.0, 0.0);
    }
}
