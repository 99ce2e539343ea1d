#include "core/surface/fill.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/base/wipe.h"

enum { LEVELS_MAX = 11, RELAXATIONS = 40, KERNEL_MAX = 120, SIDE_MAX = 1024 };

/* One level of the pyramid: each cell has the average of the known pixels under it. Its planes have
 * even numbers of rows and columns; a row or a column that is only there for this has no weight. */
struct level {
    int width, height, stride;
    float *value;
    float *weight; /* how many known pixels; 0: none */
};

/* A pixel that is filled in. */
struct hole {
    int32_t at;       /* in iso_fill.plane */
    float neighbours; /* how many of its four neighbours belong to the domain */
};

struct iso_fill {
    int width, height;
    uint8_t *domain; /* [height * width] */
    int n_levels;
    struct level level[LEVELS_MAX]; /* level 0 has the plane's size */
    struct hole *hole;              /* [height * width] */

    /* the Gaussian, and what it makes of a plane of ones in the domain */
    int reach; /* pixels to each side; 0: no smoothing */
    float kernel[KERNEL_MAX + 1];
    float *weight; /* [height * width] */

    /* Planes with a border of zeros of `border` pixels on each side, and of at least ISO_LANES more
     * on the right. */
    int border, stride;
    float *plane, *between;
    float *smoothed; /* [height * width + ISO_LANES] */
};

/* The first pixel of a row of a plane with a border. */
static float *row_of(const struct iso_fill *f, float *plane, int row)
{
    return &plane[(size_t)(row + f->border) * (size_t)f->stride + (size_t)f->border];
}

static size_t bordered_size(const struct iso_fill *f)
{
    return (size_t)(f->height + 2 * f->border) * (size_t)f->stride;
}

static int even(int n)
{
    return n + n % 2;
}

static int new_levels(struct iso_fill *f)
{
    for (int w = f->width, h = f->height;; w = (w + 1) / 2, h = (h + 1) / 2) {
        struct level *level = &f->level[f->n_levels++];
        const size_t n = (size_t)even(w) * (size_t)even(h);
        *level = (struct level){w, h, even(w), calloc(n, sizeof(float)), calloc(n, sizeof(float))};
        if (!level->value || !level->weight) {
            return -ENOMEM;
        }
        if (w == 1 && h == 1) {
            return 0;
        }
    }
}

static int new_planes(struct iso_fill *f)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    f->domain = calloc(n, sizeof *f->domain);
    f->hole = calloc(n, sizeof *f->hole);
    f->weight = calloc(n, sizeof *f->weight);
    f->plane = calloc(bordered_size(f), sizeof *f->plane);
    f->between = calloc(bordered_size(f), sizeof *f->between);
    f->smoothed = calloc(n + ISO_LANES, sizeof *f->smoothed);
    return f->domain && f->hole && f->weight && f->plane && f->between && f->smoothed ? 0 : -ENOMEM;
}

/* Copies values of the domain into the plane, and 0 outside. */
static void copy_in(struct iso_fill *f, const float *value)
{
    for (int row = 0; row < f->height; row++) {
        float *to = row_of(f, f->plane, row);
        const float *from = &value[row * f->width];
        const uint8_t *inside = &f->domain[row * f->width];
        for (int i = 0; i < f->width; i++) {
            to[i] = inside[i] ? from[i] : 0.0f;
        }
    }
}

/* Sums a line of pixels, `step` floats apart, by the weights of the kernel, for ISO_LANES lines
 * side by side. */
static void smooth_lanes(const struct iso_fill *f, const float *in, int step, float *out)
{
    iso_lanes sum = {0};
    for (int k = -f->reach; k <= f->reach; k++) {
        sum += f->kernel[k < 0 ? -k : k] * ISO_LANES_LOAD(&in[k * step]);
    }
    ISO_LANES_STORE(out, sum);
}

/* Smooths the plane: f->smoothed becomes its sums by the weights of the kernel, first along the
 * rows and then along the columns. Rows are written in order, so that what the last lanes of a row
 * write beyond it is overwritten. */
static void smooth_plane(struct iso_fill *f)
{
    for (int row = 0; row < f->height; row++) {
        for (int i = 0; i < f->width; i += ISO_LANES) {
            smooth_lanes(f, row_of(f, f->plane, row) + i, 1, row_of(f, f->between, row) + i);
        }
    }
    for (int row = 0; row < f->height; row++) {
        for (int i = 0; i < f->width; i += ISO_LANES) {
            smooth_lanes(f, row_of(f, f->between, row) + i, f->stride,
                         &f->smoothed[row * f->width + i]);
        }
    }
}

static void prepare_smoothing(struct iso_fill *f, double sigma_px)
{
    const size_t n = (size_t)f->width * (size_t)f->height;
    for (int k = 0; k <= f->reach; k++) {
        f->kernel[k] = f->reach > 0 ? (float)exp(-0.5 * k * k / (sigma_px * sigma_px)) : 1.0f;
    }
    for (size_t i = 0; i < n; i++) {
        f->weight[i] = 1.0f;
    }
    copy_in(f, f->weight);
    smooth_plane(f);
    memcpy(f->weight, f->smoothed, n * sizeof *f->weight);
}

int iso_fill_new(int width, int height, const uint8_t *domain, double sigma_px,
                 struct iso_fill **out)
{
    if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX || !(sigma_px >= 0.0)) {
        return -EINVAL;
    }
    struct iso_fill *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    f->width = width;
    f->height = height;
    f->reach = (int)fmin(ceil(3.0 * sigma_px), KERNEL_MAX);
    f->border = f->reach > 1 ? f->reach : 1;
    f->stride = width + 2 * f->border + ISO_LANES;
    int error = new_levels(f);
    if (!error) {
        error = new_planes(f);
    }
    if (error) {
        iso_fill_free(f);
        return error;
    }
    memcpy(f->domain, domain, (size_t)width * (size_t)height);
    prepare_smoothing(f, sigma_px);
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
        free(fill->domain);
        iso_wipe_free(fill->hole); /* where the last face was not measured */
        free(fill->weight);
        iso_wipe_free(fill->plane);
        iso_wipe_free(fill->between);
        iso_wipe_free(fill->smoothed);
        free(fill);
    }
}

/* Averages each 2 x 2 cells of a finer level. */
static void pull_level(const struct level *fine, struct level *coarse)
{
    for (int row = 0; row < coarse->height; row++) {
        const float *v = &fine->value[2 * row * fine->stride], *below_v = v + fine->stride;
        const float *w = &fine->weight[2 * row * fine->stride], *below_w = w + fine->stride;
        float *value = &coarse->value[row * coarse->stride];
        float *weight = &coarse->weight[row * coarse->stride];
        for (int i = 0; i < coarse->width; i++) {
            int left = 2 * i, right = left + 1;
            const float sum = w[left] * v[left] + w[right] * v[right] +
                              below_w[left] * below_v[left] + below_w[right] * below_v[right];
            weight[i] = w[left] + w[right] + below_w[left] + below_w[right];
            value[i] = weight[i] > 0.0f ? sum / weight[i] : 0.0f;
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
    return level->value[v * level->stride + u];
}

/* The bilinear value of a coarser level at a cell of the next finer one. */
static float value_between(const struct level *coarse, int column, int row)
{
    /* A fine cell's centre lies a quarter cell off its coarse cell's centre. */
    int u = column / 2, v = row / 2;
    int du = column % 2 ? 1 : -1, dv = row % 2 ? 1 : -1;
    return 0.5625f * value_near(coarse, u, v) + 0.1875f * value_near(coarse, u + du, v) +
           0.1875f * value_near(coarse, u, v + dv) + 0.0625f * value_near(coarse, u + du, v + dv);
}

/* Gives the empty cells of a finer level the values of the coarser one. */
static void push_level(const struct level *coarse, struct level *fine)
{
    for (int row = 0; row < fine->height; row++) {
        for (int column = 0; column < fine->width; column++) {
            const int i = row * fine->stride + column;
            if (!(fine->weight[i] > 0.0f)) {
                fine->value[i] = value_between(coarse, column, row);
            }
        }
    }
}

static float neighbours_of(const struct iso_fill *f, int column, int row)
{
    const uint8_t *inside = &f->domain[row * f->width + column];
    return (float)((column > 0 && inside[-1]) + (column < f->width - 1 && inside[1]) +
                   (row > 0 && inside[-f->width]) + (row < f->height - 1 && inside[f->width]));
}

/* Makes level 0 of the pyramid, and lists the pixels to fill in. Returns their number. */
static int list_holes(struct iso_fill *f, const uint8_t *known, const float *value)
{
    struct level *base = &f->level[0];
    int n = 0;
    for (int row = 0; row < f->height; row++) {
        for (int column = 0; column < f->width; column++) {
            const int from = row * f->width + column, to = row * base->stride + column;
            base->value[to] = value[from];
            base->weight[to] = f->domain[from] && known[from] ? 1.0f : 0.0f;
            if (f->domain[from] && !known[from]) {
                f->hole[n++] = (struct hole){from, neighbours_of(f, column, row)};
            }
        }
    }
    return n;
}

/* Gives each hole the value of the pyramid. Its place becomes that in the plane with the border. */
static void push_to_holes(struct iso_fill *f, int n_holes)
{
    for (int i = 0; i < n_holes; i++) {
        int row = f->hole[i].at / f->width, column = f->hole[i].at % f->width;
        float *to = row_of(f, f->plane, row) + column;
        *to = f->n_levels > 1 ? value_between(&f->level[1], column, row) : 0.0f;
        f->hole[i].at = (int32_t)(to - f->plane);
    }
}

/* Gauss-Seidel sweeps of Laplace's equation over the holes. Neighbours outside the domain are 0. */
static void relax_holes(struct iso_fill *f, int n_holes)
{
    float *plane = f->plane;
    for (int sweep = 0; sweep < RELAXATIONS; sweep++) {
        for (int i = 0; i < n_holes; i++) {
            float *value = &plane[f->hole[i].at];
            const float sum = value[-1] + value[1] + value[-f->stride] + value[f->stride];
            *value = f->hole[i].neighbours > 0.0f ? sum / f->hole[i].neighbours : *value;
        }
    }
}

void iso_fill_holes(struct iso_fill *fill, const uint8_t *known, float *value)
{
    const int n_holes = list_holes(fill, known, value);
    copy_in(fill, value);
    if (n_holes > 0) {
        for (int i = 1; i < fill->n_levels; i++) {
            pull_level(&fill->level[i - 1], &fill->level[i]);
        }
        for (int i = fill->n_levels - 1; i > 1; i--) {
            push_level(&fill->level[i], &fill->level[i - 1]);
        }
        push_to_holes(fill, n_holes);
        relax_holes(fill, n_holes);
    }
    for (int row = 0; row < fill->height; row++) {
        memcpy(&value[row * fill->width], row_of(fill, fill->plane, row),
               (size_t)fill->width * sizeof *value);
    }
}

void iso_fill_smooth(struct iso_fill *fill, float *value)
{
    if (fill->reach == 0) {
        return;
    }
    copy_in(fill, value);
    smooth_plane(fill);
    const int n = fill->width * fill->height;
    for (int i = 0; i < n; i++) {
        value[i] = fill->domain[i] ? fill->smoothed[i] / fill->weight[i] : 0.0f;
    }
}
