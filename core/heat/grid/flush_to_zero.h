/* Numbers below the normal range of float count as 0 while the heat of a grid is computed.
 *
 * The steps of the recurrence carry heat one pixel further each, where it gets smaller by a factor
 * each time, so that a wide window has a rim of numbers below 1.2e-38. Processors by Intel take
 * more than a hundred cycles for an operation with one of them, which made up more than half of the
 * time of 35,000 vertices. Heat at an isotherm is larger by almost thirty orders of magnitude.
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
