/* Times that many frames took. */
#ifndef SIM_LAB_MATCH_LATENCY_H
#define SIM_LAB_MATCH_LATENCY_H

#include <stddef.h>
#include <stdint.h>

/* Clocks as functions; the context is not used. Wall time (CLOCK_MONOTONIC) is what a person at the
 * door waits; the thread's processor time does not count what else the machine was doing. */
int64_t sim_wall_ns(void *context);
int64_t sim_thread_cpu_ns(void *context);

struct sim_latency {
    size_t n;
    double median_ms, p95_ms; /* 0 for n = 0 */
};

/* Sorts the times in place. Quantiles are those of sim_quantile_index. */
struct sim_latency sim_latency_of(int64_t *times_ns, size_t n);

#endif
