#include "sim/lab/draw/colour.h"

#include <math.h>
#include <stddef.h>

static float linear_of(uint32_t byte)
{
    const double s = (double)byte / 255.0;
    return (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
}

struct sim_colour sim_colour_hex(uint32_t rgb)
{
    return (struct sim_colour){linear_of(rgb >> 16 & 255), linear_of(rgb >> 8 & 255),
                               linear_of(rgb & 255)};
}

uint8_t sim_colour_byte(float linear)
{
    const double x = fmin(fmax((double)linear, 0.0), 1.0);
    const double s = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
    return (uint8_t)lrint(255.0 * s);
}

/* Interpolates between colours at equal steps. */
static struct sim_colour interpolate(const uint32_t *stops, size_t n, double value)
{
    const double at = fmin(fmax(value, 0.0), 1.0) * (double)(n - 1);
    const size_t i = at < (double)(n - 1) ? (size_t)at : n - 2;
    return sim_colour_mix(sim_colour_hex(stops[i]), sim_colour_hex(stops[i + 1]),
                          (float)(at - (double)i));
}

struct sim_colour sim_colour_depth(double value)
{
    /* viridis: equal steps look equal, also in grey. */
    static const uint32_t stops[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                     0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725};
    return interpolate(stops, sizeof stops / sizeof *stops, value);
}

struct sim_colour sim_colour_heat(double value)
{
    static const uint32_t stops[] = {0x2b1b6b, 0x6a1b8a, 0xb0235f, 0xe4502e,
                                     0xf98e09, 0xfcc944, 0xfdf6c5};
    return interpolate(stops, sizeof stops / sizeof *stops, value);
}

struct sim_colour sim_colour_difference(double value)
{
    /* ColorBrewer's RdBu reversed (Harrower and Brewer 2003). */
    static const uint32_t stops[] = {0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7,
                                     0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};
    return interpolate(stops, sizeof stops / sizeof *stops, value);
}

struct sim_colour sim_colour_landmark(int landmark)
{
    static const uint32_t colours[] = {
        0xffd23f,           /* nasion */
        0xff5a36,           /* nose tip */
        0xff8fb1,           /* subnasale */
        0xff9f1c, 0xff9f1c, /* alae */
        0x2ec4ff, 0x2ec4ff, /* inner eye corners */
        0x7b8cff, 0x7b8cff, /* outer eye corners */
        0xf25fe0,           /* upper lip */
        0x3ddc84, 0x3ddc84, /* mouth corners */
    };
    return sim_colour_hex(colours[landmark]);
}
