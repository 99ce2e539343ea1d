/* A monotonic clock that is handed in, so that time can be real, replayed or stepped by a test. */
#ifndef ISO_CORE_BASE_CLOCK_H
#define ISO_CORE_BASE_CLOCK_H

#include <stdint.h>

struct iso_clock {
    int64_t (*now_ns)(void *context); /* never goes back; the epoch is the clock's own */
    void *context;
};

static inline int64_t iso_clock_now_ns(const struct iso_clock *clock)
{
    return clock->now_ns(clock->context);
}

#endif
