#include "core/surface/fill.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/wipe.h"

enum { LEVELS_MAX = 11, RELAXATIONS = 40, KERNEL_MAX = 120, SIDE_MAX = 1024 };

/* One level of the pyramid: each cell has the average of the known pixels under it. */
struct level {
    int width, height;
    float *value;
    float *weight; /* how many known pixels; 0: none */
};

struct iso_fill {
    int n_levels;
    struct level level[LEVELS_MAX]; /* level 0 has the plane's size */
    float *scratch;                 /* [2][height * width] */
};

int iso_fill_new(int width, int height, struct iso_fill **out)
{
    if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX) {
        return -EINVAL;
    }
    struct iso_fill *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    int error = 0;
    for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
        struct level *level = &f->level[f->n_levels++];
        const size_t n = (size_t)w * (size_t)h;
        *level = (struct level){w, h, calloc(n, sizeof(float)), calloc(n, sizeof(float))};
        error |= !level->value || !level->weight;
        if (w == 1 && h == 1) {
            break;
        }
    }
    f->scratch = calloc(2 * (size_t)width * (size_t)height, sizeof *f->scratch);
    if (error || !f->scratch) {
        iso_fill_free(f);
        return -ENOMEM;
    }
    *out = f;
    return 0;
}

void iso_fill_free(struct iso_fill *fill)
{
    if (fill) {
        for (int i = 0; i < fill->n_levels; i++) {
            iso_wipe_free(fill->level[i].value);
            iso_wipe_free(fill->level[i].weight);
        }
        iso_wipe_free(fill->scratch);
        free(fill);
    }
}

/* Averages each 2 x 2 cells of a finer level. */
static void pull_level(const struct level *fine, struct level *coarse)
{
    for (int row = 0; row < coarse->height; row++) {
        for (int column = 0; column < coarse->width; column++) {
            float sum = 0.0f, weight = 0.0f;
            for (int k = 0; k < 4; k++) {
                int u = 2 * column + (k & 1), v = 2 * row + (k >> 1);
                if (u < fine->width && v < fine->height) {
                    const int i = v * fine->width + u;
                    sum += fine->weight[i] * fine->value[i];
                    weight += fine->weight[i];
                }
            }
            const int to = row * coarse->width + column;
            coarse->weight[to] = weight;
            coarse->value[to] = weight > 0.0f ? sum / weight : 0.0f;
        }
    }
}

static int clamp_index(int index, int n)
{
    if (index < 0) {
        return 0;
    }
    return index < n ? index : n - 1;
}

/* The value of the nearest cell that exists. */
static float value_near(const struct level *level, int column, int row)
{
    const int u = clamp_index(column, level->width), v = clamp_index(row, level->height);
    return level->value[v * level->width + u];
}

/* Gives the empty cells of a finer level the bilinear value of the coarser one. */
static void push_level(const struct level *coarse, struct level *fine)
{
    for (int row = 0; row < fine->height; row++) {
        for (int column = 0; column < fine->width; column++) {
            const int i = row * fine->width + column;
            if (fine->weight[i] > 0.0f) {
                continue;
            }
            /* A fine cell's centre lies a quarter cell off its coarse cell's centre. */
            int u = column / 2, v = row / 2;
            int du = column % 2 ? 1 : -1, dv = row % 2 ? 1 : -1;
            fine->value[i] = 0.5625f * value_near(coarse, u, v) +
                             0.1875f * value_near(coarse, u + du, v) +
                             0.1875f * value_near(coarse, u, v + dv) +
                             0.0625f * value_near(coarse, u + du, v + dv);
        }
    }
}

/* Gauss-Seidel sweeps of Laplace's equation over the filled-in pixels. */
static void relax_plane(const struct level *plane, const uint8_t *domain, const uint8_t *known,
                        float *value)
{
    int w = plane->width, h = plane->height;
    for (int sweep = 0; sweep < RELAXATIONS; sweep++) {
        for (int i = 0; i < w * h; i++) {
            if (!domain[i] || known[i]) {
                continue;
            }
            int column = i % w, row = i / w, n = 0;
            float sum = 0.0f;
            const int next[4] = {column > 0 ? i - 1 : -1, column < w - 1 ? i + 1 : -1,
                                 row > 0 ? i - w : -1, row < h - 1 ? i + w : -1};
            for (int k = 0; k < 4; k++) {
                if (next[k] >= 0 && domain[next[k]]) {
                    sum += value[next[k]];
                    n++;
                }
            }
            value[i] = n > 0 ? sum / (float)n : value[i];
        }
    }
}

void iso_fill_holes(struct iso_fill *fill, const uint8_t *domain, const uint8_t *known,
                    float *value)
{
    struct level *base = &fill->level[0];
    const int n = base->width * base->height;
    for (int i = 0; i < n; i++) {
        base->weight[i] = domain[i] && known[i] ? 1.0f : 0.0f;
        base->value[i] = value[i];
    }
    for (int i = 1; i < fill->n_levels; i++) {
        pull_level(&fill->level[i - 1], &fill->level[i]);
    }
    for (int i = fill->n_levels - 1; i > 0; i--) {
        push_level(&fill->level[i], &fill->level[i - 1]);
    }
    for (int i = 0; i < n; i++) {
        value[i] = domain[i] ? base->value[i] : 0.0f;
    }
    relax_plane(base, domain, known, value);
}

/* One direction of the Gaussian: `step` is 1 along rows, or the width along columns. Value and
 * weight are smoothed in the same way; they are divided at the end. */
static void smooth_line(const float *in, float *out, int n, int step, const float *kernel,
                        int reach)
{
    for (int i = 0; i < n; i++) {
        float sum = 0.0f;
        for (int k = -reach; k <= reach; k++) {
            if (i + k >= 0 && i + k < n) {
                sum += kernel[k < 0 ? -k : k] * in[(i + k) * step];
            }
        }
        out[i * step] = sum;
    }
}

static void smooth_plane(struct iso_fill *fill, float *plane, const float *kernel, int reach)
{
    int w = fill->level[0].width, h = fill->level[0].height;
    float *between = fill->scratch;
    for (int row = 0; row < h; row++) {
        smooth_line(&plane[row * w], &between[row * w], w, 1, kernel, reach);
    }
    for (int column = 0; column < w; column++) {
        smooth_line(&between[column], &plane[column], h, w, kernel, reach);
    }
}

void iso_fill_smooth(struct iso_fill *fill, const uint8_t *domain, double sigma_px, float *value)
{
    if (!(sigma_px > 0.0)) {
        return;
    }
    float kernel[KERNEL_MAX + 1];
    const int reach = (int)fmin(ceil(3.0 * sigma_px), KERNEL_MAX);
    for (int k = 0; k <= reach; k++) {
        kernel[k] = (float)exp(-0.5 * k * k / (sigma_px * sigma_px));
    }
    const int n = fill->level[0].width * fill->level[0].height;
    float *weight = &fill->scratch[n];
    for (int i = 0; i < n; i++) {
        weight[i] = domain[i] ? 1.0f : 0.0f;
        value[i] = domain[i] ? value[i] : 0.0f;
    }
    smooth_plane(fill, value, kernel, reach);
    smooth_plane(fill, weight, kernel, reach);
    for (int i = 0; i < n; i++) {
        value[i] = domain[i] ? value[i] / weight[i] : 0.0f;
    }
}
