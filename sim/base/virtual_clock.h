/* A clock that only sim_virtual_clock_advance moves. Hours of an appliance are simulated in
 * seconds, and two equal runs give identical results. */
#ifndef SIM_BASE_VIRTUAL_CLOCK_H
#define SIM_BASE_VIRTUAL_CLOCK_H

#include <stdint.h>

#include "drivers/base/times.h"

struct sim_virtual_clock {
    int64_t now_ns;         /* monotonic, from 0 */
    int64_t wall_origin_ns; /* wall time when now_ns is 0, since 1970 UTC */
};

/* Starts at 2026-01-01 00:00 UTC. */
struct sim_virtual_clock sim_virtual_clock_start(void);

/* A clock interface that reads both times from this clock, which must outlive it. */
struct iso_times sim_virtual_clock_times(struct sim_virtual_clock *clock);

/* Advances to t_ns; never goes back. */
void sim_virtual_clock_advance(struct sim_virtual_clock *clock, int64_t t_ns);

#endif
