/* The clocks of an appliance, all injected: the clock for measurements, by which the frames of the
 * sensors are stamped, too; a clock that also runs while the machine is suspended; and the date. */
#ifndef ISO_DRIVERS_BASE_TIMES_H
#define ISO_DRIVERS_BASE_TIMES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/clock.h"

#define ISO_NS_PER_S  INT64_C(1000000000)
#define ISO_NS_PER_MS INT64_C(1000000)

/* Angles in configuration and on the bus are degrees, inside radians. */
#define ISO_RAD_PER_DEG 0.017453292519943295

/* "Never", for times at which something is due. */
#define ISO_NEVER_NS INT64_MAX

struct iso_times {
    struct iso_clock monotonic;
    int64_t (*wall_ns)(void *context); /* since 1970 UTC; may jump when the clock is set */
    void *wall_context;
    /* Also runs while the machine is suspended, unlike `monotonic`. All zero: the machine is never
     * suspended, and `monotonic` is used instead. */
    struct iso_clock boottime;
};

/* The system's CLOCK_MONOTONIC, for code whose clock is not injected: threads that drive lines. */
int64_t iso_monotonic_ns(void);

static inline int64_t iso_times_now_ns(const struct iso_times *times)
{
    return iso_clock_now_ns(&times->monotonic);
}

static inline int64_t iso_times_wall_ns(const struct iso_times *times)
{
    return times->wall_ns(times->wall_context);
}

static inline int64_t iso_times_boot_ns(const struct iso_times *times)
{
    return iso_clock_now_ns(times->boottime.now_ns ? &times->boottime : &times->monotonic);
}

/* Whether a date comes from a clock that was set. A board without a battery starts in 1970, and an
 * expired limit would then seem to be valid. */
static inline bool iso_wall_is_set(int64_t wall_s)
{
    return wall_s >= INT64_C(1704067200); /* 2024-01-01 */
}

/* The clocks of this machine. */
struct iso_times iso_times_system(void);

#endif
