/* Draws the mirror: the silhouette of the person, the outline of the head, and the oval to fill. */
#ifndef ENROLL_SCREEN_DRAW_OUTLINE_H
#define ENROLL_SCREEN_DRAW_OUTLINE_H

#include <cairo.h>

#include "enroll/screen/draw/palette.h"
#include "enroll/screen/draw/text.h"

/* Draws it into the box. The record may have no outline: then there are the silhouette and the
 * oval. */
void screen_outline_draw(cairo_t *cairo, const struct iso_outline_record *record,
                         const struct screen_box *box, const struct screen_palette *palette);

#endif
