/* Colours in linear light, and maps from numbers to colours. */
#ifndef SIM_LAB_DRAW_COLOUR_H
#define SIM_LAB_DRAW_COLOUR_H

#include <stdint.h>

/* Linear-light red, green, blue of the sRGB primaries; 1 is white. */
struct sim_colour {
    float r, g, b;
};

/* From the usual hexadecimal notation, 0xRRGGBB in sRGB. */
struct sim_colour sim_colour_hex(uint32_t rgb);

/* The sRGB byte of a linear value, clipped (IEC 61966-2-1). */
uint8_t sim_colour_byte(float linear);

static inline struct sim_colour sim_colour_scale(float s, struct sim_colour c)
{
    return (struct sim_colour){s * c.r, s * c.g, s * c.b};
}

/* a at share = 0, b at 1. */
static inline struct sim_colour sim_colour_mix(struct sim_colour a, struct sim_colour b,
                                               float share)
{
    return (struct sim_colour){a.r + share * (b.r - a.r), a.g + share * (b.g - a.g),
                               a.b + share * (b.b - a.b)};
}

/* Colour maps of 0..1 (clipped): depth from dark (0: far) to bright (1: near), heat from cold (0)
 * to hot (1). */
struct sim_colour sim_colour_depth(double value);
struct sim_colour sim_colour_heat(double value);

/* Blue over white to red, for deviations from the middle value, 0.5. */
struct sim_colour sim_colour_difference(double value);

/* A colour for each of the twelve landmarks; both landmarks of a pair have similar colours. */
struct sim_colour sim_colour_landmark(int landmark);

#endif
