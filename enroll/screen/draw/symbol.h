/* Draws a symbol of words.h with lines of one width. */
#ifndef ENROLL_SCREEN_DRAW_SYMBOL_H
#define ENROLL_SCREEN_DRAW_SYMBOL_H

#include <cairo.h>

#include "enroll/screen/scene/words.h"

/* Draws it in the present colour, in the square of this side about (x, y). NO_SYMBOL draws
 * nothing. */
void screen_symbol_draw(cairo_t *cairo, enum screen_symbol symbol, double x, double y, double side);

#endif
