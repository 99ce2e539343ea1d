#include "enroll/screen/draw/text.h"

static PangoLayout *layout_at(cairo_t *cairo, const struct screen_text *text,
                              const struct screen_box *box, double size_px)
{
    PangoLayout *layout = pango_cairo_create_layout(cairo);
    PangoFontDescription *font = pango_font_description_new();
    pango_font_description_set_family_static(font,
                                             "Noto Sans, Noto Sans Arabic, DejaVu Sans, sans");
    pango_font_description_set_absolute_size(font, size_px * PANGO_SCALE);
    pango_font_description_set_weight(font, text->bold ? PANGO_WEIGHT_BOLD : PANGO_WEIGHT_NORMAL);
    pango_layout_set_font_description(layout, font);
    pango_layout_set_text(layout, text->text, -1);
    pango_layout_set_width(layout, (int)(box->width * PANGO_SCALE));
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
    pango_layout_set_alignment(layout, text->middle ? PANGO_ALIGN_CENTER : PANGO_ALIGN_LEFT);
    pango_font_description_free(font);
    return layout;
}

static bool fits(PangoLayout *layout, const struct screen_box *box)
{
    int width = 0;
    int height = 0;
    pango_layout_get_pixel_size(layout, &width, &height);
    return height <= box->height && width <= box->width;
}

/* A word of a size at which it would be broken counts as too large as well. */
static bool breaks_words(PangoLayout *layout, const struct screen_box *box)
{
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD);
    const bool broken = !fits(layout, box);
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
    return broken;
}

static PangoLayout *fitted(cairo_t *cairo, const struct screen_text *text,
                           const struct screen_box *box)
{
    double size_px = text->size_px;
    PangoLayout *layout = layout_at(cairo, text, box, size_px);
    while (size_px > text->size_px / 3.0 && (!fits(layout, box) || breaks_words(layout, box))) {
        size_px *= 0.93;
        g_object_unref(layout);
        layout = layout_at(cairo, text, box, size_px);
    }
    if (!fits(layout, box)) {
        pango_layout_set_height(layout, (int)(box->height * PANGO_SCALE));
        pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
    }
    return layout;
}

double screen_text_height(cairo_t *cairo, const struct screen_text *text,
                          const struct screen_box *box)
{
    int height = 0;
    PangoLayout *layout = fitted(cairo, text, box);
    pango_layout_get_pixel_size(layout, NULL, &height);
    g_object_unref(layout);
    return height;
}

double screen_text_draw(cairo_t *cairo, const struct screen_text *text,
                        const struct screen_box *box)
{
    int height = 0;
    PangoLayout *layout = fitted(cairo, text, box);
    pango_layout_get_pixel_size(layout, NULL, &height);
    cairo_move_to(cairo, box->x, box->y);
    pango_cairo_show_layout(cairo, layout);
    g_object_unref(layout);
    return height;
}
