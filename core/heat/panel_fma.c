/* For x86-64 processors with AVX2 and FMA (2013 on); empty on other architectures. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX2. */
#include "core/heat/panel.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC target("avx2,fma")
#endif
#define OPS      iso__panel_ops_fma
#define OPS_NAME "AVX2 and FMA"
#include "core/heat/panel.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
