/* For every processor of the architecture: SSE2 on x86-64, NEON on aarch64. */
#define OPS      iso__block_ops_baseline
#define OPS_NAME "baseline"
#include "core/heat/block.inc"

const struct iso_block_ops *iso_block_ops(void)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        return &iso__block_ops_avx2;
    }
#endif
    return &iso__block_ops_baseline;
}
