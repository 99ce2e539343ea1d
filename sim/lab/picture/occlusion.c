#include "sim/lab/picture/occlusion.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

static const double occlusion_step_mm = 5.6, occlusion_fade_mm = 45.0;

/* The input of the occlusion: the middle sample of each pixel, stored close together in memory. */
struct coarse {
    int width, height;
    float *depth_mm; /* [height * width], 0: no surface */
};

static int new_coarse(const struct sim_scene *scene, struct coarse *out)
{
    enum { S = SIM_CANVAS_SUPERSAMPLING };
    out->width = scene->raster.width_px / S;
    out->height = scene->raster.height_px / S;
    out->depth_mm = calloc((size_t)out->width * (size_t)out->height, sizeof *out->depth_mm);
    if (!out->depth_mm) {
        return -ENOMEM;
    }
    for (int y = 0; y < out->height; y++) {
        const float *row = scene->raster.depth_mm + (long)(S * y + S / 2) * scene->raster.width_px;
        for (int x = 0; x < out->width; x++) {
            out->depth_mm[(long)y * out->width + x] = row[S * x + S / 2];
        }
    }
    return 0;
}

/* The point seen at a pixel of depth z_mm. */
static struct iso_vec3 coarse_point(const struct sim_scene *scene, int x, int y, double z_mm)
{
    enum { S = SIM_CANVAS_SUPERSAMPLING };
    const struct iso_camera *camera = &scene->raster.camera;
    return iso_vec3((S * x + S / 2 - camera->cx_px) * z_mm / camera->fx_px,
                    (S * y + S / 2 - camera->cy_px) * z_mm / camera->fy_px, z_mm);
}

/* Sine of the highest horizon over the plane of normal n, seen from p in the direction (step_x,
 * step_y). A distant horizon counts less. */
static double horizon_of(const struct sim_scene *scene, const struct coarse *coarse, int x, int y,
                         struct iso_vec3 p, struct iso_vec3 n, double step_x, double step_y)
{
    enum { STEPS = 5 };
    double horizon = 0.0;
    for (int s = 1; s <= STEPS; s++) {
        const int i = x + (int)lrint(s * step_x), j = y + (int)lrint(s * step_y);
        if (i < 0 || j < 0 || i >= coarse->width || j >= coarse->height) {
            break;
        }
        const double z_mm = (double)coarse->depth_mm[(long)j * coarse->width + i];
        if (z_mm > 0.0 && (i != x || j != y)) {
            struct iso_vec3 to = iso_sub(coarse_point(scene, i, j, z_mm), p);
            const double length = iso_norm(to), fade = fmax(0.0, 1.0 - length / occlusion_fade_mm);
            horizon = fmax(horizon, fade * iso_dot(to, n) / length);
        }
    }
    return horizon;
}

static double openness(const struct sim_scene *scene, const struct coarse *coarse, int x, int y)
{
    enum { S = SIM_CANVAS_SUPERSAMPLING, DIRECTIONS = 16 };
    const struct iso_raster *r = &scene->raster;
    const long sample = (long)(S * y + S / 2) * r->width_px + S * x + S / 2;
    struct iso_vec3 p = coarse_point(scene, x, y, (double)r->depth_mm[sample]);
    struct iso_vec3 n = iso_unit(
        sim_scene_interpolate(scene, sample, r->triangle[sample], scene->normals));
    double step_px = occlusion_step_mm * r->camera.fx_px / p.z / S, hidden = 0.0;
    for (int d = 0; d < DIRECTIONS; d++) {
        /* A fixed pattern turns the directions from pixel to pixel, so that no direction becomes
         * visible in the picture. */
        const double angle = 2.0 * M_PI * (d + 0.25 * ((x + 2 * y) % 4)) / DIRECTIONS;
        hidden += horizon_of(scene, coarse, x, y, p, n, step_px * cos(angle),
                             step_px * sin(angle)) /
                  DIRECTIONS;
    }
    return fmax(0.0, 1.0 - 1.25 * hidden);
}

/* Mean over the surrounding 5 x 5 pixels. It removes the pattern of the directions. */
static float mean_open(const struct sim_occlusion *o, int x, int y)
{
    float sum = 0.0f, n = 0.0f;
    for (int j = y - 2; j <= y + 2; j++) {
        for (int i = x - 2; i <= x + 2; i++) {
            if (i >= 0 && j >= 0 && i < o->width && j < o->height) {
                sum += o->open[(long)j * o->width + i];
                n += 1.0f;
            }
        }
    }
    return sum / n;
}

int sim_occlusion_compute(const struct sim_scene *scene, struct sim_occlusion *out)
{
    struct coarse coarse = {0};
    int error = new_coarse(scene, &coarse);
    if (error) {
        return error;
    }
    struct sim_occlusion raw = {coarse.width, coarse.height, NULL}, smooth = raw;
    const size_t n_pixels = (size_t)raw.width * (size_t)raw.height;
    raw.open = calloc(n_pixels, sizeof *raw.open);
    smooth.open = calloc(n_pixels, sizeof *smooth.open);
    error = raw.open && smooth.open ? 0 : -ENOMEM;
    for (int y = 0; !error && y < raw.height; y++) {
        for (int x = 0; x < raw.width; x++) {
            const long pixel = (long)y * raw.width + x;
            const bool seen = coarse.depth_mm[pixel] > 0.0f;
            raw.open[pixel] = seen ? (float)openness(scene, &coarse, x, y) : 1.0f;
        }
    }
    for (int y = 0; !error && y < raw.height; y++) {
        for (int x = 0; x < raw.width; x++) {
            smooth.open[(long)y * raw.width + x] = mean_open(&raw, x, y);
        }
    }
    free(coarse.depth_mm);
    free(raw.open);
    if (error) {
        free(smooth.open);
        return error;
    }
    *out = smooth;
    return 0;
}
