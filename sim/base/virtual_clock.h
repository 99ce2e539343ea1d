/* A clock that stands still until it is moved on. Hours of an appliance pass in seconds, and two
 * equal runs give equal results to the bit. */
#ifndef SIM_BASE_VIRTUAL_CLOCK_H
#define SIM_BASE_VIRTUAL_CLOCK_H

#include <stdint.h>

#include "drivers/base/times.h"

struct sim_virtual_clock {
    int64_t now_ns;         /* monotonic, from 0 */
    int64_t wall_origin_ns; /* the date at 0, since 1970 UTC */
};

/* The start is 2026-01-01 00:00 UTC. */
struct sim_virtual_clock sim_virtual_clock_start(void);

/* Both times by this clock, which must outlive them. */
struct iso_times sim_virtual_clock_times(struct sim_virtual_clock *clock);

/* Moves on to t_ns; never back. */
void sim_virtual_clock_advance(struct sim_virtual_clock *clock, int64_t t_ns);

#endif
