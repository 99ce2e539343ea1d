#include "drivers/base/times.h"

#include <stddef.h>
#include <time.h>

static int64_t read_clock(clockid_t id)
{
    struct timespec now;
    (void)clock_gettime(id, &now);
    return now.tv_sec * ISO_NS_PER_S + now.tv_nsec;
}

int64_t iso_monotonic_ns(void)
{
    return read_clock(CLOCK_MONOTONIC);
}

static int64_t monotonic_ns(void *context)
{
    (void)context;
    return iso_monotonic_ns();
}

static int64_t boottime_ns(void *context)
{
    (void)context;
    return read_clock(CLOCK_BOOTTIME);
}

static int64_t wall_ns(void *context)
{
    (void)context;
    return read_clock(CLOCK_REALTIME);
}

struct iso_times iso_times_system(void)
{
    return (struct iso_times){
        .monotonic = {monotonic_ns, NULL},
        .wall_ns = wall_ns,
        .boottime = {boottime_ns, NULL},
    };
}
