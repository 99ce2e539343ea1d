/* For every processor of the architecture: SSE2 on x86-64, NEON on aarch64. */
#define SWEEP iso__grid_sweep_baseline
#include "core/heat/grid/grid_step.inc"

struct iso_grid_stepper iso_grid_stepper(void)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        return (struct iso_grid_stepper){iso__grid_sweep_avx2, "AVX2"};
    }
    return (struct iso_grid_stepper){iso__grid_sweep_baseline, "SSE2"};
#elif defined __aarch64__
    return (struct iso_grid_stepper){iso__grid_sweep_baseline, "NEON"};
#else
    return (struct iso_grid_stepper){iso__grid_sweep_baseline, "baseline"};
#endif
}
