/* For x86-64 processors with AVX2 (2013 on); empty on other architectures. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX2. */
#include <stddef.h>
#include <string.h>

#include "core/surface/agreeing.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
enum { WIDE = 8 };
#define KEEP_AGREEING iso__keep_agreeing_avx2
#include "core/surface/agreeing.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
