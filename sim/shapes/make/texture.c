#include "sim/shapes/make/texture.h"

#include "sim/base/noise3.h"

const char *sim_texture_name(enum sim_texture texture)
{
    static const char *const names[SIM_TEXTURES] = {"stripes", "spots", "patches", "shaded",
                                                    "marbled"};
    return (unsigned)texture < SIM_TEXTURES ? names[texture] : NULL;
}

/* 0 below -width, 1 above width, smooth between. */
static double step(double x, double width)
{
    const double s = fmin(fmax(0.5 + 0.5 * x / width, 0.0), 1.0);
    return s * s * (3.0 - 2.0 * s);
}

/* The share of the second colour at a point, 0..1. */
static double pattern(enum sim_texture texture, uint64_t key, struct iso_vec3 p)
{
    const double waves = sim_noise3(key, iso_scale(1.0 / 40.0, p));
    switch (texture) {
    case SIM_TEXTURE_STRIPES:
        return step(sin(0.45 * (p.z + 0.5 * p.y) + 3.0 * waves), 0.3);
    case SIM_TEXTURE_SPOTS:
        return step(sim_noise3(key, iso_scale(1.0 / 9.0, p)) - 0.25, 0.1);
    case SIM_TEXTURE_PATCHES:
        return step(sim_noise3(key, iso_scale(1.0 / 30.0, p)) + 0.3 * waves, 0.05);
    case SIM_TEXTURE_SHADED:
        return step(p.y - 50.0 + 30.0 * waves, 45.0);
    default:
        return step(0.18 - fabs(sim_noise3(key, iso_scale(1.0 / 22.0, p))), 0.1);
    }
}

struct iso_colour sim_texture_colour(enum sim_texture texture, uint64_t key,
                                     struct iso_vec3 rest_mm)
{
    static const float colours[SIM_TEXTURES][2][3] = {
        {{0.86f, 0.72f, 0.48f}, {0.16f, 0.12f, 0.10f}},
        {{0.83f, 0.58f, 0.22f}, {0.22f, 0.13f, 0.06f}},
        {{0.93f, 0.91f, 0.87f}, {0.42f, 0.25f, 0.15f}},
        {{0.88f, 0.88f, 0.66f}, {0.20f, 0.42f, 0.18f}},
        {{0.66f, 0.68f, 0.72f}, {0.16f, 0.27f, 0.62f}},
    };
    const float share = (float)pattern(texture, key, rest_mm);
    struct iso_colour out;
    for (int k = 0; k < 3; k++) {
        const float plain = colours[texture][0][k];
        out.channel[k] = plain + share * (colours[texture][1][k] - plain);
    }
    return out;
}
