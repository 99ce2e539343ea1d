/* For every processor of the architecture: SSE2 on x86-64, NEON on aarch64. */
#define OPS      iso__panel_ops_baseline
#define OPS_NAME "baseline"
#include "core/heat/panel.inc"

const struct iso_panel_ops *iso_panel_ops(void)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return &iso__panel_ops_fma;
    }
#endif
    return &iso__panel_ops_baseline;
}
