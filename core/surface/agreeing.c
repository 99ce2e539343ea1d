/* For every processor of the architecture (SSE2 on x86-64, NEON on aarch64), and the choice. */
enum { WIDE = 4 };
#define KEEP_AGREEING iso__keep_agreeing_baseline
#include "core/surface/agreeing.inc"

void iso_keep_agreeing(const float *depth_mm, int width_px, int height_px,
                       struct iso_agreeing_bounds bounds, float *kept)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        iso__keep_agreeing_avx2(depth_mm, width_px, height_px, bounds, kept);
        return;
    }
#endif
    iso__keep_agreeing_baseline(depth_mm, width_px, height_px, bounds, kept);
}
