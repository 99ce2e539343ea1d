/* Numbers below the normal range of float count as 0 while the heat of a grid is computed.
 *
 * Each step of the recurrence carries heat one pixel further, and the heat of each further pixel is
 * smaller by some factor. The outer pixels of a wide window therefore have numbers below 1.2e-38.
 * Processors by Intel take more than a hundred cycles for an operation with such a number. With
 * 35,000 vertices this was more than half of the time. The heat at an isotherm is more than 1e-9 of
 * the heat released, so that these numbers do not matter.
 *
 * On x86-64 a bit of the thread's control register does this. Elsewhere nothing is done: processors
 * for arm64 take hardly longer for such numbers. Internal to core/heat. */
#ifndef ISO_CORE_HEAT_GRID_FLUSH_TO_ZERO_H
#define ISO_CORE_HEAT_GRID_FLUSH_TO_ZERO_H

#ifdef __SSE2__
#include <xmmintrin.h>

enum { ISO_FLUSH_RESULTS = 0x8000, ISO_FLUSH_OPERANDS = 0x0040 };

/* Begins it in this thread. Returns what iso_flush_to_zero_end takes. */
static inline unsigned iso_flush_to_zero_begin(void)
{
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | ISO_FLUSH_RESULTS | ISO_FLUSH_OPERANDS);
    return before;
}

/* Ends it: the thread computes as before. */
static inline void iso_flush_to_zero_end(unsigned before)
{
    _mm_setcsr(before);
}
#else
static inline unsigned iso_flush_to_zero_begin(void)
{
    return 0;
}

static inline void iso_flush_to_zero_end(unsigned before)
{
    (void)before;
}
#endif

#endif
