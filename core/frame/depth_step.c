#include "core/frame/depth_step.h"

#include <math.h>

/* Larger differences are edges. */
static const float edge_mm = 20.0f;
static const float bins_per_mm = 4.0f;

enum { BINS = 80 + 1, DIFFERENCES_MIN = 100, SHARE = 10 /* one of so many */ };

double iso_depth_step(const struct iso_frame *frame)
{
    int count[BINS] = {0}, n = 0;
    for (int row = 0; row < frame->height_px; row++) {
        const float *z = &frame->depth_mm[(size_t)row * (size_t)frame->width_px];
        for (int column = 1; column < frame->width_px; column++) {
            const float apart = fabsf(z[column] - z[column - 1]);
            if (z[column] > 0.0f && z[column - 1] > 0.0f && apart > 0.0f && apart < edge_mm) {
                count[(int)(apart * bins_per_mm + 0.5f)]++;
                n++;
            }
        }
    }
    if (n < DIFFERENCES_MIN) {
        return 0.0;
    }
    int bin = 0;
    for (int below = count[0]; below * SHARE < n; below += count[bin]) {
        bin++;
    }
    return bin / (double)bins_per_mm;
}
