/* For every processor of the architecture (SSE2 on x86-64, NEON on aarch64), and the choice. */
#define WIDE          4
#define SHRINK_BLOCKS iso__shrink_blocks_baseline
#include "core/frame/depth_lanes.h"
#define MIN ISO_DEPTHS_MIN
#define MAX ISO_DEPTHS_MAX
#include "core/frame/shrink_blocks.inc"

int iso_shrink_blocks(const float *at, int width_px, int n_blocks, float *out)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        const int n = iso__shrink_blocks_avx2(at, width_px, n_blocks, out);
        return n + iso__shrink_blocks_baseline(&at[n * USUAL], width_px, n_blocks - n, &out[n]);
    }
#endif
    return iso__shrink_blocks_baseline(at, width_px, n_blocks, out);
}
