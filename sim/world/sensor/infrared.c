#include "sim/world/sensor/infrared.h"

#include "sim/world/sensor/sensor.h"

/* The share of the pixels that are the middle of a dot. */
static const double dot_share = 0.1;

/* Albedo of each material without paint (assumed). */
static double material_albedo(enum sim_material material)
{
    switch (material) {
    case SIM_NOTHING:
    case SIM_MIRROR:
        return 0.0;
    case SIM_GLASS:
        return 0.1;
    case SIM_SKIN:
        return 0.6;
    case SIM_HAIR:
        return 0.2;
    case SIM_PAPER:
        return 0.8;
    default:
        return 0.5;
    }
}

/* Light that returns to one pixel of the view, before the sensor's own level. */
static double returned(const struct sim_infrared *infrared, const struct sim_view *view, int column,
                       int row)
{
    const struct iso_camera *camera = &view->camera;
    const size_t i = (size_t)row * (size_t)camera->width_px + (size_t)column;
    if (view->facet[i] < 0) {
        return 0.0;
    }
    const struct sim_facet *facet = &view->facets[view->facet[i]];
    const double albedo = facet->albedo > 0.0F ? (double)facet->albedo
                                               : material_albedo(facet->material);
    double light = albedo * (double)view->cosine[i];
    if (!infrared->ambient) {
        struct iso_vec3 p = iso_camera_back_project(camera, column, row, (double)view->depth_mm[i]);
        light /= 1e-6 * iso_dot(p, p);
    }
    return light;
}

static double mean_returned(const struct sim_infrared *infrared, const struct sim_view *view,
                            int column, int row)
{
    const int s = view->supersample;
    double sum = 0.0;
    for (int k = 0; k < s * s; k++) {
        sum += returned(infrared, view, column * s + k % s, row * s + k / s);
    }
    return sum / (s * s);
}

/* A plane of mean 1: dots that the lens blurs into the neighbouring pixels. */
static void draw_dots(int width, int height, double share, struct sim_random *random,
                      float *scratch, float *out)
{
    const size_t n = (size_t)width * (size_t)height;
    for (size_t i = 0; i < n; i++) {
        const bool dot = sim_random_unit(random) < dot_share;
        scratch[i] = (float)(1.0 - share + (dot ? share / dot_share : 0.0));
    }
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            double sum = 0.0;
            for (int k = 0; k < 9; k++) {
                const int c = (column + k % 3 - 1 + width) % width;
                const int r = (row + k / 3 - 1 + height) % height;
                const int weight = (k % 3 == 1 ? 2 : 1) * (k / 3 == 1 ? 2 : 1);
                sum += weight * (double)scratch[(size_t)r * (size_t)width + (size_t)c];
            }
            out[(size_t)row * (size_t)width + (size_t)column] = (float)(sum / 16.0);
        }
    }
}

void sim_infrared_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                          double noise_scale, struct sim_random *random,
                          struct sim_sensor_workspace *workspace, float *intensity)
{
    if (sensor->picture) {
        sensor->picture(workspace->own, intensity);
        return;
    }
    const struct sim_infrared *infrared = &sensor->infrared;
    const int width = view->camera.width_px / view->supersample;
    const int height = view->camera.height_px / view->supersample;
    float *dots = workspace->plane[1];
    const double counts = (double)((1L << infrared->bits) - 1);
    if (infrared->dots > 0.0) {
        draw_dots(width, height, infrared->dots, random, workspace->plane[0], dots);
    }
    size_t i = 0;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++, i++) {
            double light = infrared->level * mean_returned(infrared, view, column, row);
            light *= infrared->dots > 0.0 ? (double)dots[i] : 1.0;
            const double sd = sqrt(infrared->shot * light + infrared->dark * infrared->dark);
            light += noise_scale * sd * sim_random_normal(random);
            light = nearbyint(counts * fmin(fmax(light, 0.0), 1.0)) / counts;
            intensity[i] = (float)light;
        }
    }
}
