#include "drivers/stereo/coarse.h"

#include <math.h>
#include <stddef.h>

enum { RADIUS = 2, SIDE = 2 * RADIUS + 1, VALUES_MIN = 8 };

static const float same_surface_px = 2.0f;

struct neighbours {
    int n;
    float value[SIDE * SIDE];
    float x[SIDE * SIDE], y[SIDE * SIDE]; /* relative to the middle, in half-size pixels */
};

struct plane {
    float at, along_x, along_y; /* value in the middle, and slopes per half-size pixel */
};

static void gather(const float *half, int width, int height, int column, int row,
                   struct neighbours *out)
{
    out->n = 0;
    for (int dy = -RADIUS; dy <= RADIUS; dy++) {
        for (int dx = -RADIUS; dx <= RADIUS; dx++) {
            int x = column + dx, y = row + dy;
            if (x < 0 || y < 0 || x >= width || y >= height) {
                continue;
            }
            const float value = half[(size_t)y * (size_t)width + (size_t)x];
            if (value > 0.0f) {
                out->value[out->n] = value;
                out->x[out->n] = (float)dx;
                out->y[out->n] = (float)dy;
                out->n++;
            }
        }
    }
}

static float median_of(const struct neighbours *around)
{
    float sorted[SIDE * SIDE];
    for (int i = 0; i < around->n; i++) {
        int k = i;
        for (; k > 0 && sorted[k - 1] > around->value[i]; k--) {
            sorted[k] = sorted[k - 1];
        }
        sorted[k] = around->value[i];
    }
    return sorted[around->n / 2];
}

/* Fits a plane by least squares to the values near `middle`. Its slopes are 0 if the places of the
 * values lie on a line. Returns 0 if there are too few values. */
static int fit(const struct neighbours *around, float middle, struct plane *out)
{
    double n = 0, x = 0, y = 0, d = 0, xx = 0, xy = 0, yy = 0, xd = 0, yd = 0;
    for (int i = 0; i < around->n; i++) {
        double u = (double)around->x[i], v = (double)around->y[i];
        const double value = (double)(around->value[i] - middle);
        if (fabs(value) <= (double)same_surface_px) {
            n += 1, x += u, y += v, d += value;
            xx += u * u, xy += u * v, yy += v * v, xd += u * value, yd += v * value;
        }
    }
    if (n < VALUES_MIN) {
        return 0;
    }
    xx -= x * x / n, xy -= x * y / n, yy -= y * y / n, xd -= x * d / n, yd -= y * d / n;
    double determinant = xx * yy - xy * xy, a = 0.0, b = 0.0;
    if (determinant > 1.0) {
        a = (xd * yy - yd * xy) / determinant;
        b = (yd * xx - xd * xy) / determinant;
    }
    *out = (struct plane){middle + (float)((d - a * x - b * y) / n), (float)a, (float)b};
    return 1;
}

void iso_coarse_spread(const float *half_px, int width_px, int height_px, float *whole_px)
{
    int width = width_px / 2, height = height_px / 2;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            struct neighbours around;
            struct plane plane = {0.0f, 0.0f, 0.0f};
            gather(half_px, width, height, column, row, &around);
            if (around.n >= VALUES_MIN) {
                (void)fit(&around, median_of(&around), &plane);
            }
            /* The four pixels of the whole image are offset by a quarter of a half-size pixel. */
            for (int k = 0; k < 4; k++) {
                float dx = k % 2 ? 0.25f : -0.25f, dy = k / 2 ? 0.25f : -0.25f;
                const size_t at = (size_t)(2 * row + k / 2) * (size_t)width_px +
                                  (size_t)(2 * column) + (size_t)(k % 2);
                whole_px[at] = plane.at > 0.0f ? plane.at + dx * plane.along_x + dy * plane.along_y
                                               : 0.0f;
            }
        }
    }
}
