#include "sim/world/sensor/noise_plane.h"

#include <math.h>
#include <stddef.h>

/* Sums over windows of 2 radius + 1 along one line of n values, `stride` apart, wrapped around. */
static void line_sums(const float *in, size_t n, size_t stride, size_t radius, float scale,
                      float *out)
{
    double sum = 0.0;
    for (size_t i = 0; i <= 2 * radius; i++) {
        sum += in[(i + n - radius) % n * stride];
    }
    for (size_t i = 0; i < n; i++) {
        out[i * stride] = scale * (float)sum;
        sum += in[(i + radius + 1) % n * stride] - in[(i + n - radius) % n * stride];
    }
}

void sim_noise_plane(struct sim_random *random, int width, int height, int radius_u, int radius_v,
                     float *scratch, float *out)
{
    const size_t w = (size_t)width, h = (size_t)height;
    for (size_t i = 0; i < w * h; i++) {
        out[i] = (float)sim_random_normal(random);
    }
    const float scale_u = 1.0f / sqrtf(2.0f * (float)radius_u + 1.0f);
    const float scale_v = 1.0f / sqrtf(2.0f * (float)radius_v + 1.0f);
    for (size_t row = 0; row < h; row++) {
        line_sums(out + row * w, w, 1, (size_t)radius_u, scale_u, scratch + row * w);
    }
    for (size_t column = 0; column < w; column++) {
        line_sums(scratch + column, h, w, (size_t)radius_v, scale_v, out + column);
    }
}
