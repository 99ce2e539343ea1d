/* Shades the visible part of a scene. */
#include <errno.h>
#include <stdlib.h>

#include "sim/lab/picture/occlusion.h"
#include "sim/lab/picture/scene_data.h"

/* Camera frame: x right, y down, z away from the viewer. `towards` points to the light. */
struct light {
    struct iso_vec3 towards;
    struct sim_colour colour;
};

static const struct light key = {{-0.50, -0.62, -0.62}, {0.98f, 0.95f, 0.90f}};
static const struct light fill = {{0.80, 0.05, -0.60}, {0.15f, 0.19f, 0.25f}};
static const struct light rim = {{0.72, -0.50, 0.48}, {0.30f, 0.36f, 0.46f}};
static const struct sim_colour sky = {0.17f, 0.18f, 0.20f}, ground = {0.055f, 0.05f, 0.05f};

static struct iso_vec3 point_at(const struct sim_scene *scene, int x, int y)
{
    const struct iso_raster *r = &scene->raster;
    const double z = (double)r->depth_mm[(long)y * r->width_px + x];
    return iso_vec3((x - r->camera.cx_px) * z / r->camera.fx_px,
                    (y - r->camera.cy_px) * z / r->camera.fy_px, z);
}

static void add_light(struct sim_colour *sum, struct sim_colour light, double amount)
{
    sum->r += light.r * (float)amount;
    sum->g += light.g * (float)amount;
    sum->b += light.b * (float)amount;
}

/* Light that a surface of the given colour and normal sends towards the viewer. */
static struct sim_colour lit(struct sim_colour base, struct iso_vec3 n, struct iso_vec3 to_viewer,
                             double open)
{
    /* The sky is above, -y. A half-Lambert wrap of a fifth keeps the relief of the shadow side
     * visible. */
    struct sim_colour light = sim_colour_scale(
        (float)open, sim_colour_mix(sky, ground, (float)(0.5 + 0.5 * n.y)));
    const struct light *const lights[] = {&key, &fill, &rim};
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        struct iso_vec3 towards = iso_unit(lights[i]->towards);
        const double lambert = fmax(0.0, (iso_dot(n, towards) + 0.2) / 1.2);
        add_light(&light, lights[i]->colour, lambert * (0.4 + 0.6 * open));
    }
    struct sim_colour out = {base.r * light.r, base.g * light.g, base.b * light.b};
    struct iso_vec3 half = iso_unit(iso_add(iso_unit(key.towards), to_viewer));
    const double highlight = 0.075 * pow(fmax(0.0, iso_dot(n, half)), 28.0);
    add_light(&out, key.colour, highlight * open);
    return out;
}

static struct sim_colour base_of(const struct sim_scene *scene,
                                 const struct sim_surface_style *style, long sample,
                                 int32_t triangle)
{
    const int32_t *c = scene->mesh->triangles[triangle];
    const float w1 = scene->raster.weight[sample][0], w2 = scene->raster.weight[sample][1];
    struct sim_colour base = style->base;
    if (style->vertex) {
        const struct sim_colour *a = &style->vertex[c[0]], *b = &style->vertex[c[1]],
                                *d = &style->vertex[c[2]];
        const float w0 = 1.0f - w1 - w2;
        base = (struct sim_colour){w0 * a->r + w1 * b->r + w2 * d->r,
                                   w0 * a->g + w1 * b->g + w2 * d->g,
                                   w0 * a->b + w1 * b->b + w2 * d->b};
    }
    if (style->edges) {
        const float nearest = fminf(fminf(w1, w2), 1.0f - w1 - w2);
        const float on_edge = fmaxf(0.0f, 1.0f - nearest / 0.06f);
        base = sim_colour_scale(1.0f - 0.75f * on_edge, base);
    }
    return base;
}

static float opacity_of(const struct sim_scene *scene, const struct sim_surface_style *style,
                        long sample, int32_t triangle)
{
    if (!style->opacity) {
        return 1.0f;
    }
    const int32_t *c = scene->mesh->triangles[triangle];
    const float w1 = scene->raster.weight[sample][0], w2 = scene->raster.weight[sample][1];
    const float opacity = (1.0f - w1 - w2) * style->opacity[c[0]] + w1 * style->opacity[c[1]] +
                          w2 * style->opacity[c[2]];
    return fminf(fmaxf(opacity, 0.0f), 1.0f);
}

int sim_scene_shade(const struct sim_scene *scene, const struct sim_surface_style *style)
{
    struct sim_occlusion occlusion = {0};
    const int error = sim_occlusion_compute(scene, &occlusion);
    if (error) {
        return error;
    }
    for (int y = 0; y < scene->raster.height_px; y++) {
        for (int x = 0; x < scene->raster.width_px; x++) {
            const long sample = (long)y * scene->raster.width_px + x;
            const int32_t triangle = scene->raster.triangle[sample];
            if (triangle < 0) {
                continue;
            }
            struct iso_vec3 n = iso_unit(
                sim_scene_interpolate(scene, sample, triangle, scene->normals));
            struct iso_vec3 to_viewer = iso_unit(iso_scale(-1.0, point_at(scene, x, y)));
            const long pixel = (long)(y / SIM_CANVAS_SUPERSAMPLING) * occlusion.width +
                               x / SIM_CANVAS_SUPERSAMPLING;
            const double open = (double)occlusion.open[pixel];
            struct sim_colour base = base_of(scene, style, sample, triangle);
            sim_canvas_blend(scene->canvas, x, y, lit(base, n, to_viewer, open),
                             opacity_of(scene, style, sample, triangle));
        }
    }
    free(occlusion.open);
    return 0;
}
