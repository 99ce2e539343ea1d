#include "sim/world/sensor/triangulation.h"

#include "sim/world/sensor/noise_plane.h"

/* Depths with a smaller difference belong to one surface. */
static const float jump_mm = 12.0f;

struct size {
    int width, height;
};

static struct size size_of(const struct sim_view *view)
{
    return (struct size){view->camera.width_px, view->camera.height_px};
}

static int clamped(int value, int last)
{
    if (value < 0) {
        return 0;
    }
    return value > last ? last : value;
}

/* Step 1. du, dv: unit noise planes. */
static void jitter_outlines(const struct sim_view *view, double edge_px, const float *du,
                            const float *dv, float *out)
{
    struct size s = size_of(view);
    size_t i = 0;
    for (int row = 0; row < s.height; row++) {
        for (int column = 0; column < s.width; column++, i++) {
            const int u = clamped(column + (int)lrint(edge_px * (double)du[i]), s.width - 1);
            const int v = clamped(row + (int)lrint(edge_px * (double)dv[i]), s.height - 1);
            const float own = view->depth_mm[i];
            const float other = view->depth_mm[(size_t)v * (size_t)s.width + (size_t)u];
            out[i] = fabsf(other - own) > jump_mm ? other : own;
        }
    }
}

/* Step 2 along one line of n values, `stride` apart: means over the part of the window that lies
 * on the same surface as its middle. */
static void smooth_line(const float *in, int n, size_t stride, int radius, float *out)
{
    for (int i = 0; i < n; i++) {
        float middle = in[(size_t)i * stride], sum = 0.0f;
        int count = 0;
        const int from = i < radius ? 0 : i - radius, to = i + radius < n ? i + radius : n - 1;
        for (int k = from; middle > 0.0f && k <= to; k++) {
            const float value = in[(size_t)k * stride];
            if (fabsf(value - middle) < jump_mm) {
                sum += value;
                count++;
            }
        }
        out[(size_t)i * stride] = count > 0 ? sum / (float)count : 0.0f;
    }
}

static void smooth_windows(struct size s, int window_u, int window_v, float *scratch, float *plane)
{
    const size_t width = (size_t)s.width;
    for (size_t row = 0; row < (size_t)s.height; row++) {
        smooth_line(plane + row * width, s.width, 1, window_u, scratch + row * width);
    }
    for (size_t column = 0; column < width; column++) {
        smooth_line(scratch + column, s.height, width, window_v, plane + column);
    }
}

/* Step 3. Seen from a second eye at the left, a pixel moves right by its disparity. The loop
 * walks to the right; a pixel that lands behind the position of an earlier pixel is hidden by
 * it. For a second eye at the right everything is mirrored. */
static void cast_shadows(struct size s, const struct sim_triangulation *model, float *depth_mm)
{
    const double fb = model->focal_px * model->baseline_mm;
    for (int row = 0; row < s.height; row++) {
        float *line = depth_mm + (size_t)row * (size_t)s.width;
        double farthest = -1e9;
        for (int i = 0; i < s.width; i++) {
            const int column = model->second_eye < 0 ? i : s.width - 1 - i;
            if (!(line[column] > 0.0f)) {
                continue;
            }
            const double landing = i + fb / (double)line[column];
            if (landing < farthest - 0.5) {
                line[column] = 0.0f;
            } else {
                farthest = fmax(farthest, landing);
            }
        }
    }
}

/* Growth of the noise with the angle between surface normal and line of sight: slow below 60
 * degrees, then steep (the form of Nguyen, Izadi and Lovell 2012, eq. 3). */
static double grazing_factor(double cosine)
{
    const double angle = acos(fmin(cosine, 1.0)), rest = 1.5707963 - angle;
    return 1.0 + 0.12 * angle * angle / (rest * rest + 1e-3);
}

/* Step 6: the level of a unit noise plane above which a pixel drops out. */
static double dropout_level(double cosine, enum sim_material material)
{
    /* No pixel drops out below about 70 degrees, half of them at 83, nearly all at 90. */
    const double level = 5.0 * (cosine - 0.12) / 0.25;
    switch (material) {
    case SIM_HAIR:
        return fmin(level, 1.1 + 0.8 * cosine);
    case SIM_GLASS:
        return fmin(level, 0.9);
    case SIM_MIRROR:
        return -1e9;
    default:
        return level;
    }
}

/* Factor on the noise: light from within hair, or from behind glass, blurs the pattern. */
static double roughness_of(enum sim_material material)
{
    if (material == SIM_HAIR) {
        return 3.0;
    }
    return material == SIM_GLASS ? 2.5 : 1.0;
}

static float measured(const struct sim_triangulation *model, const struct sim_view *view, size_t i,
                      double depth_mm, double noise, double dropout)
{
    const double cosine = (double)view->cosine[i];
    const enum sim_material material = (enum sim_material)view->material[i];
    if (depth_mm < model->near_mm || depth_mm > model->far_mm ||
        dropout > dropout_level(cosine, material)) {
        return 0.0f;
    }
    const double fb = model->focal_px * model->baseline_mm;
    double disparity = fb / depth_mm +
                       noise * model->noise_px * roughness_of(material) * grazing_factor(cosine);
    if (model->step_px > 0.0) {
        disparity = model->step_px * nearbyint(disparity / model->step_px);
    }
    return disparity > 0.0 ? (float)(fb / disparity) : 0.0f;
}

void sim_triangulation_measure(const struct sim_triangulation *model, const struct sim_view *view,
                               double noise_scale, struct sim_random *random,
                               struct sim_sensor_workspace *workspace, float *depth_mm)
{
    struct size s = size_of(view);
    float *scratch = workspace->plane[0], *a = workspace->plane[1], *b = workspace->plane[2];
    sim_noise_plane(random, s.width, s.height, 1, 1, scratch, a);
    sim_noise_plane(random, s.width, s.height, 1, 1, scratch, b);
    jitter_outlines(view, noise_scale * model->edge_px, a, b, depth_mm);
    smooth_windows(s, model->window_u, model->window_v, scratch, depth_mm);
    cast_shadows(s, model, depth_mm);
    sim_noise_plane(random, s.width, s.height, model->window_u, model->window_v, scratch, a);
    sim_noise_plane(random, s.width, s.height, 3, 3, scratch, b);
    for (size_t i = 0; i < workspace->n_pixels; i++) {
        if (depth_mm[i] > 0.0f) {
            depth_mm[i] = measured(model, view, i, (double)depth_mm[i], noise_scale * (double)a[i],
                                   (double)b[i]);
        }
    }
}
