#include "drivers/stereo/refine.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Disparities that differ by less than this belong to one surface. */
static const float same_surface_px = 1.0f;

enum { FINE = 4 }; /* samples per pixel of a row of the right image; interpolated once */

/* The sums over a window, or over a column of it. */
struct sums {
    double n, l, w, g, ll, lw, lg, ww, wg, gg;
};

enum { SUMS = sizeof(struct sums) / sizeof(double) };

struct iso_refine {
    int width, height;
    struct iso_refine_options options;
    float *fine;           /* [height][FINE * width]: the right image, also between its columns */
    float *warped, *slope; /* [height][width]: W and W'; slope is NAN where W is not known */
    struct sums *columns;  /* [width]: sums over the rows that the window covers now */
};

int iso_refine_new(int width_px, int height_px, const struct iso_refine_options *options,
                   struct iso_refine **out)
{
    if (width_px < 8 || height_px < 8 || options->window_px < 3 || options->window_px > 31 ||
        options->window_px % 2 == 0 || options->smooth_px < 1 || options->smooth_px % 2 == 0 ||
        options->smooth_px > options->window_px || options->iterations < 1 ||
        options->iterations > 8) {
        return -EINVAL;
    }
    struct iso_refine *refine = calloc(1, sizeof *refine);
    if (!refine) {
        return -ENOMEM;
    }
    const size_t n = (size_t)width_px * (size_t)height_px;
    refine->width = width_px;
    refine->height = height_px;
    refine->options = *options;
    refine->fine = malloc(n * FINE * sizeof(float));
    refine->warped = malloc(n * sizeof(float));
    refine->slope = malloc(n * sizeof(float));
    refine->columns = malloc((size_t)width_px * sizeof(struct sums));
    if (!refine->fine || !refine->warped || !refine->slope || !refine->columns) {
        iso_refine_free(refine);
        return -ENOMEM;
    }
    *out = refine;
    return 0;
}

void iso_refine_free(struct iso_refine *refine)
{
    if (refine) {
        free(refine->fine);
        free(refine->warped);
        free(refine->slope);
        free(refine->columns);
        free(refine);
    }
}

/* ---- warping ---------------------------------------------------------------- */

static int clamp_index(int i, int last)
{
    if (i < 0) {
        return 0;
    }
    return i > last ? last : i;
}

/* Cubic interpolation between columns (Catmull and Rom 1974). */
static void interpolate_rows(struct iso_refine *r, const uint8_t *right)
{
    static const float taps[FINE][4] = {
        {0.0f, 1.0f, 0.0f, 0.0f},
        {-0.0703125f, 0.8671875f, 0.2265625f, -0.0234375f},
        {-0.0625f, 0.5625f, 0.5625f, -0.0625f},
        {-0.0234375f, 0.2265625f, 0.8671875f, -0.0703125f},
    };
    for (int row = 0; row < r->height; row++) {
        const uint8_t *in = right + (size_t)row * (size_t)r->width;
        float *out = r->fine + (size_t)row * (size_t)r->width * FINE;
        for (int i = 0; i < r->width; i++) {
            float around[4];
            for (int k = 0; k < 4; k++) {
                around[k] = (float)in[clamp_index(i + k - 1, r->width - 1)] - 128.0f;
            }
            for (int f = 0; f < FINE; f++) {
                out[i * FINE + f] = taps[f][0] * around[0] + taps[f][1] * around[1] +
                                    taps[f][2] * around[2] + taps[f][3] * around[3];
            }
        }
    }
}

/* Warps the right image and its derivative to the view of the left camera. */
static void warp_right(struct iso_refine *r, const float *disparity_px)
{
    const float last = (float)(r->width - 1) - 1.0f / FINE;
    size_t i = 0;
    for (int row = 0; row < r->height; row++) {
        const float *fine = r->fine + (size_t)row * (size_t)r->width * FINE;
        for (int column = 0; column < r->width; column++, i++) {
            const float x = (float)column - disparity_px[i];
            if (!(disparity_px[i] > 0.0f && x >= 1.0f && x < last)) {
                r->slope[i] = NAN;
                continue;
            }
            const int at = (int)(x * FINE);
            float rest = x * FINE - (float)at, step = fine[at + 1] - fine[at];
            r->warped[i] = fine[at] + rest * step;
            /* The slope is taken over half a pixel to either side, because differences of single
             * samples would be noise. */
            r->slope[i] = (1.0f - rest) * (fine[at + 2] - fine[at - 2]) +
                          rest * (fine[at + 3] - fine[at - 1]);
        }
    }
}

/* ---- windows ---------------------------------------------------------------- */

static void add_sums(struct sums *to, double sign, const struct sums *what)
{
    double *a = (double *)to;
    const double *b = (const double *)what;
    for (int i = 0; i < SUMS; i++) {
        a[i] += sign * b[i];
    }
}

/* Adds a row of pixels to the sums of the columns, or subtracts it. */
static void add_row(struct iso_refine *r, const uint8_t *left, int row, double sign)
{
    const size_t first = (size_t)row * (size_t)r->width;
    for (int column = 0; column < r->width; column++) {
        const size_t i = first + (size_t)column;
        if (isnan(r->slope[i])) {
            continue;
        }
        double l = (double)left[i] - 128.0, w = (double)r->warped[i], g = (double)r->slope[i];
        struct sums pixel = {1.0, l, w, g, l * l, l * w, l * g, w * w, w * g, g * g};
        add_sums(&r->columns[column], sign, &pixel);
    }
}

/* Solves the regression for the step and the correlation of L and W. Returns false if the window
 * has too few pixels or too little contrast. */
static bool solve_window(const struct iso_refine *r, const struct sums *s, double *step_px,
                         double *correlation)
{
    double area = r->options.window_px * r->options.window_px, n = s->n;
    const double least = r->options.contrast_min * r->options.contrast_min;
    if (n < 0.3 * area) {
        return false;
    }
    double ll = s->ll - s->l * s->l / n, ww = s->ww - s->w * s->w / n;
    double gg = s->gg - s->g * s->g / n, lw = s->lw - s->l * s->w / n;
    double lg = s->lg - s->l * s->g / n, wg = s->wg - s->w * s->g / n;
    const double determinant = ww * gg - wg * wg;
    if (ll < least * n || ww < 0.25 * least * n || !(determinant > 1e-3 * ww * gg)) {
        return false;
    }
    double beta = (lw * gg - lg * wg) / determinant, gamma = (lg * ww - lw * wg) / determinant;
    *correlation = lw / sqrt(ll * ww);
    /* W is sampled at column - disparity, so changing the disparity by s changes W by -s W'. */
    *step_px = beta > 0.1 ? -gamma / beta : INFINITY;
    return true;
}

static void step_row(struct iso_refine *r, int row, float *disparity_px, float *confidence)
{
    const int radius = r->options.window_px / 2;
    struct sums window = {0};
    for (int k = 0; k < radius && k < r->width; k++) {
        add_sums(&window, 1.0, &r->columns[k]);
    }
    for (int column = 0; column < r->width; column++) {
        const size_t i = (size_t)row * (size_t)r->width + (size_t)column;
        double step_px, correlation;
        if (column + radius < r->width) {
            add_sums(&window, 1.0, &r->columns[column + radius]);
        }
        if (column > radius) {
            add_sums(&window, -1.0, &r->columns[column - radius - 1]);
        }
        confidence[i] = 0.0f;
        if (!isnan(r->slope[i]) && solve_window(r, &window, &step_px, &correlation) &&
            fabs(step_px) <= r->options.step_max_px) {
            disparity_px[i] += (float)step_px;
            confidence[i] = (float)correlation;
        }
    }
}

static void step_disparity(struct iso_refine *r, const uint8_t *left, float *disparity_px,
                           float *confidence)
{
    const int radius = r->options.window_px / 2;
    warp_right(r, disparity_px);
    memset(r->columns, 0, (size_t)r->width * sizeof *r->columns);
    for (int row = 0; row < radius && row < r->height; row++) {
        add_row(r, left, row, 1.0);
    }
    for (int row = 0; row < r->height; row++) {
        if (row + radius < r->height) {
            add_row(r, left, row + radius, 1.0);
        }
        if (row > radius) {
            add_row(r, left, row - radius - 1, -1.0);
        }
        step_row(r, row, disparity_px, confidence);
    }
}

/* ---- smoothing -------------------------------------------------------------- */

/* Smooths one line of n values, `stride` apart. Each value becomes the mean, weighted by
 * confidence, of the known neighbours on the same surface. Pixels without a value stay without
 * one. */
static void smooth_line(const float *in, const float *confidence, int n, size_t stride, int radius,
                        float *out)
{
    for (int i = 0; i < n; i++) {
        const size_t at = (size_t)i * stride;
        float middle = in[at], sum = 0.0f, weight = 0.0f;
        int from = i < radius ? 0 : i - radius, to = i + radius < n ? i + radius : n - 1;
        for (int k = from; middle > 0.0f && k <= to; k++) {
            const size_t other = (size_t)k * stride;
            const bool alike = in[other] > 0.0f && fabsf(in[other] - middle) < same_surface_px;
            const float w = alike ? fmaxf(confidence[other], 0.0f) : 0.0f;
            sum += w * in[other];
            weight += w;
        }
        out[at] = weight > 0.0f ? sum / weight : middle;
    }
}

static void smooth_disparity(struct iso_refine *r, const float *confidence, float *disparity_px)
{
    const size_t width = (size_t)r->width;
    float *scratch = r->warped; /* used as scratch until the next step */
    const int radius = r->options.smooth_px / 2;
    for (size_t row = 0; row < (size_t)r->height; row++) {
        smooth_line(disparity_px + row * width, confidence + row * width, r->width, 1, radius,
                    scratch + row * width);
    }
    for (size_t column = 0; column < width; column++) {
        smooth_line(scratch + column, confidence + column, r->height, width, radius,
                    disparity_px + column);
    }
}

void iso_refine_run(struct iso_refine *refine, const uint8_t *left, const uint8_t *right,
                    float *disparity_px, float *confidence)
{
    interpolate_rows(refine, right);
    for (int i = 0; i < refine->options.iterations; i++) {
        step_disparity(refine, left, disparity_px, confidence);
        smooth_disparity(refine, confidence, disparity_px);
    }
}
