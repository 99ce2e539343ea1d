#include "enroll/screen/draw/outline.h"

#include <math.h>

/* Transforms the context so that silhouette points become the box, as a mirror shows them. */
static void enter_mirror(cairo_t *cairo, const struct screen_box *box)
{
    const double scale = fmin(box->width / ISO_SILHOUETTE_COLUMNS,
                              box->height / ISO_SILHOUETTE_ROWS);
    const double zoom = fmin(1.6,
                             box->height / (scale * ISO_SILHOUETTE_ROWS)); /* cut at the sides */
    cairo_save(cairo);
    cairo_rectangle(cairo, box->x, box->y, box->width, box->height);
    cairo_clip(cairo);
    cairo_translate(cairo, box->x + 0.5 * box->width, box->y + 0.5 * box->height);
    cairo_scale(cairo, -scale * zoom, scale * zoom);
    cairo_translate(cairo, -0.5 * ISO_SILHOUETTE_COLUMNS, -0.5 * ISO_SILHOUETTE_ROWS);
}

static void fill_silhouette(cairo_t *cairo, const struct iso_outline_record *record)
{
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        int begin = -1;
        for (int column = 0; column <= ISO_SILHOUETTE_COLUMNS; column++) {
            const bool set = column < ISO_SILHOUETTE_COLUMNS &&
                             iso_silhouette_is_set(record->silhouette, column, row);
            if (set && begin < 0) {
                begin = column;
            } else if (!set && begin >= 0) {
                cairo_rectangle(cairo, begin, row, column - begin, 1.05);
                begin = -1;
            }
        }
    }
    cairo_fill(cairo);
}

static void stroke_outline(cairo_t *cairo, const struct iso_outline_record *record)
{
    for (int i = 0; i < record->n_points; i++) {
        cairo_line_to(cairo, (double)record->outline[i][0] / ISO_OUTLINE_UNITS,
                      (double)record->outline[i][1] / ISO_OUTLINE_UNITS);
    }
    cairo_close_path(cairo);
    cairo_stroke(cairo);
}

/* Where the head is to be: in the middle, as large as at 550 mm before a usual camera. */
static void stroke_oval(cairo_t *cairo)
{
    static const double dashes[] = {2.2, 2.2};
    cairo_save(cairo);
    cairo_translate(cairo, 0.5 * ISO_SILHOUETTE_COLUMNS, 0.5 * ISO_SILHOUETTE_ROWS);
    cairo_scale(cairo, 11.0, 15.0);
    cairo_arc(cairo, 0, 0, 1.0, 0.0, 2.0 * M_PI);
    cairo_restore(cairo);
    cairo_set_dash(cairo, dashes, 2, 0.0);
    cairo_stroke(cairo);
    cairo_set_dash(cairo, NULL, 0, 0.0);
}

void screen_outline_draw(cairo_t *cairo, const struct iso_outline_record *record,
                         const struct screen_box *box, const struct screen_palette *palette)
{
    const struct screen_colour c = palette->accent;
    enter_mirror(cairo, box);
    cairo_set_antialias(cairo, CAIRO_ANTIALIAS_GOOD);
    cairo_set_source_rgba(cairo, c.r, c.g, c.b, 0.22);
    fill_silhouette(cairo, record);
    cairo_set_line_width(cairo, 0.9);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_source_rgb(cairo, palette->quiet.r, palette->quiet.g, palette->quiet.b);
    stroke_oval(cairo);
    if (record->n_points > 0) {
        cairo_set_source_rgb(cairo, c.r, c.g, c.b);
        stroke_outline(cairo, record);
    }
    cairo_restore(cairo);
}
