/* For x86-64 processors with AVX2 (2013 on); empty on other architectures. Without FMA, so that the
 * results are those of the baseline. */
#if defined __x86_64__
/* Headers of the system come first: nothing of theirs may be compiled for AVX2. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/lanes.h"
#include "core/frame/depth_lanes.h"
#include "core/landmark/meet_many.h"
#include "core/landmark/meeting.h"
#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
enum { WIDE = 4 };
#define MEET_MANY iso__meet_many_avx2
#include "core/landmark/meet_many.inc"
#if defined __clang__
#pragma clang attribute pop
#endif
#endif
