/* For x86-64 processors with AVX2 (2013 on); empty on other architectures. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX2. */
#include <immintrin.h>
#include <math.h>

#include "core/frame/shrink_blocks.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define WIDE          8
#define SHRINK_BLOCKS iso__shrink_blocks_avx2
#define MIN(a, b)     ((wide)_mm256_min_ps(a, b))
#define MAX(a, b)     ((wide)_mm256_max_ps(a, b))
#include "core/frame/shrink_blocks.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
