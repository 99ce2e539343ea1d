/* The colours of the screen. Text and symbols have a contrast of at least 7 to 1 with the ground
 * that they stand on (WCAG 2.1, 1.4.6), and the kinds of scene differ in lightness and in their
 * symbol, too, so that nobody has to tell colours apart. */
#ifndef ENROLL_SCREEN_DRAW_PALETTE_H
#define ENROLL_SCREEN_DRAW_PALETTE_H

#include "enroll/screen/scene/scene.h"

struct screen_colour {
    double r, g, b; /* sRGB, 0..1 */
};

struct screen_palette {
    struct screen_colour ground, text, accent; /* accent: symbols and outlines */
    struct screen_colour quiet;                /* less important text */
};

/* The colours of a kind of scene. */
struct screen_palette screen_palette_of(enum screen_scene_kind kind);

/* The contrast of two colours, 1..21 (WCAG 2.1, "contrast ratio"). */
double screen_contrast(struct screen_colour a, struct screen_colour b);

#endif
