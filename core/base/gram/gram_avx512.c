/* For x86-64 processors with AVX-512 (gram.h says which of them use it); empty on other
 * architectures. No product and sum are joined into one instruction, so that the results are those
 * of the baseline. */
#if defined __x86_64__
/* Headers come first: nothing of theirs may be compiled for AVX-512. */
#include <stddef.h>

#include "core/base/gram.h"
#if defined __clang__
#pragma clang fp contract(off)
#pragma clang attribute push(__attribute__((target("avx512f"))), apply_to = function)
#else
#pragma GCC optimize("fp-contract=off")
#pragma GCC target("avx512f")
#endif
enum { WIDE = 16 };
#define GRAM iso__gram_avx512
#include "core/base/gram/gram.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
