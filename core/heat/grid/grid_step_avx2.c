/* For x86-64 processors with AVX2 (2013 on); empty on other architectures. Without FMA, so that the
 * results are those of the baseline. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX2. */
#include "core/heat/grid/grid_step.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define SWEEP iso__grid_sweep_avx2
#include "core/heat/grid/grid_step.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
