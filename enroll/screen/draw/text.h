/* Text that fits its box, in any script: shaped by Pango. */
#ifndef ENROLL_SCREEN_DRAW_TEXT_H
#define ENROLL_SCREEN_DRAW_TEXT_H

#include <pango/pangocairo.h>
#include <stdbool.h>

struct screen_box {
    double x, y, width, height; /* pixels */
};

struct screen_text {
    const char *text; /* UTF-8 */
    double size_px;   /* of the font; the text is drawn smaller if the box is too small for it */
    bool bold;
    bool middle; /* centred; else it begins at the side where its script begins */
};

/* Draws the text in the present colour at the top of the box. Lines are broken at words. Returns
 * the height that it takes, pixels. A text that does not fit at a third of its size is cut with
 * "...". */
double screen_text_draw(cairo_t *cairo, const struct screen_text *text,
                        const struct screen_box *box);

/* The height that it would take. */
double screen_text_height(cairo_t *cairo, const struct screen_text *text,
                          const struct screen_box *box);

#endif
