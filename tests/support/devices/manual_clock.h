/* A clock that advances only when a test moves it. */
#ifndef TESTS_SUPPORT_DEVICES_MANUAL_CLOCK_H
#define TESTS_SUPPORT_DEVICES_MANUAL_CLOCK_H

#include <stdint.h>

#include "core/base/clock.h"

static inline int64_t manual_clock_now_ns(void *context)
{
    return *(const int64_t *)context;
}

static inline struct iso_clock manual_clock(int64_t *now_ns)
{
    return (struct iso_clock){manual_clock_now_ns, now_ns};
}

#endif
