/* Statistics of frame times. */
#ifndef SIM_LAB_MATCH_LATENCY_H
#define SIM_LAB_MATCH_LATENCY_H

#include <stddef.h>
#include <stdint.h>

/* Clocks as functions; the context is unused. Wall time (CLOCK_MONOTONIC) is the waiting time of
 * a person at the door. The thread's processor time excludes other work on the machine. */
int64_t sim_wall_ns(void *context);
int64_t sim_thread_cpu_ns(void *context);

struct sim_latency {
    size_t n;
    double median_ms, p95_ms; /* 0 for n = 0 */
};

/* Sorts the times in place. Quantiles are those of sim_quantile_index. */
struct sim_latency sim_latency_of(int64_t *times_ns, size_t n);

#endif
