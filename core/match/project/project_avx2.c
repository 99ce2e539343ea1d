/* For x86-64 processors with AVX2 (2013 on); empty on other architectures. Without FMA, so that the
 * results are those of the baseline. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX2. */
#include <stddef.h>

#include "core/match/metric_vector.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
enum { WIDE = 8 };
#define PROJECT iso__project_avx2
#include "core/match/project/project.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
