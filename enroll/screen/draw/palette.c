#include "enroll/screen/draw/palette.h"

#include <math.h>

static struct screen_colour of_hex(unsigned rgb)
{
    return (struct screen_colour){(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0,
                                  (rgb & 255) / 255.0};
}

struct screen_palette screen_palette_of(enum screen_scene_kind kind)
{
    struct screen_palette palette = {
        .ground = of_hex(0x0f1720),
        .text = of_hex(0xf4f7fa),
        .accent = of_hex(0x8fd0ff),
        .quiet = of_hex(0xb9c6d3),
    };
    if (kind == SCREEN_ALLOWED) {
        palette.ground = of_hex(0x053b44); /* teal, light on dark */
        palette.accent = of_hex(0x8ff0d8);
        palette.quiet = of_hex(0xd5ece8);
    } else if (kind == SCREEN_REFUSED || kind == SCREEN_CLOSED) {
        palette.ground = of_hex(0x2b1708); /* orange, light on dark */
        palette.accent = of_hex(0xffb870);
        palette.quiet = of_hex(0xeedccb);
    } else if (kind == SCREEN_OUT_OF_SERVICE) {
        palette.ground = of_hex(0x17181a);
        palette.accent = of_hex(0xd7dadd);
    }
    return palette;
}

static double linear(double value)
{
    return value <= 0.03928 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static double luminance(struct screen_colour c)
{
    return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

double screen_contrast(struct screen_colour a, struct screen_colour b)
{
    const double la = luminance(a);
    const double lb = luminance(b);
    return (fmax(la, lb) + 0.05) / (fmin(la, lb) + 0.05);
}
