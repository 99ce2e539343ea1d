/* For every processor of the architecture (SSE2 on x86-64, NEON on aarch64), and the choice. */
#define WIDE          4
#define SHRINK_BLOCKS iso__shrink_blocks_baseline
/* Compilers do not make the one instruction of the processor from a comparison and a choice. */
#if defined __SSE__
#include <xmmintrin.h>
#define MIN(a, b) ((wide)_mm_min_ps(a, b))
#define MAX(a, b) ((wide)_mm_max_ps(a, b))
#else
#define MIN(a, b) CHOOSE((a) < (b), a, b)
#define MAX(a, b) CHOOSE((a) > (b), a, b)
#endif
#include "core/frame/shrink_blocks.inc"

int iso_shrink_blocks(const float *at, int width_px, int n_blocks, float *out)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        return iso__shrink_blocks_avx2(at, width_px, n_blocks, out);
    }
#endif
    return iso__shrink_blocks_baseline(at, width_px, n_blocks, out);
}
