/* A monotonic clock that is handed in, so that time can be real, replayed or stepped by a test. */
#ifndef ISO_CORE_BASE_CLOCK_H
#define ISO_CORE_BASE_CLOCK_H

#include <stdint.h>

struct iso_clock {
    int64_t (*now_ns)(void *context); /* never goes back; each clock has its own zero */
    void *context;                    /* passed to now_ns */
};

/* The time of a clock, nanoseconds. */
static inline int64_t iso_clock_now_ns(const struct iso_clock *clock)
{
    return clock->now_ns(clock->context);
}

#endif
