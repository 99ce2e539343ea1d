#include "sim/lab/match/latency.h"

#include <stdlib.h>
#include <time.h>

#include "sim/base/spread.h"

static int64_t read_clock(clockid_t id)
{
    struct timespec now = {0, 0};
    (void)clock_gettime(id, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

int64_t sim_wall_ns(void *context)
{
    (void)context;
    return read_clock(CLOCK_MONOTONIC);
}

int64_t sim_thread_cpu_ns(void *context)
{
    (void)context;
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

static int by_time(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

struct sim_latency sim_latency_of(int64_t *times_ns, size_t n)
{
    if (n == 0) {
        return (struct sim_latency){0, 0.0, 0.0};
    }
    qsort(times_ns, n, sizeof *times_ns, by_time);
    return (struct sim_latency){
        .n = n,
        .median_ms = (double)times_ns[sim_quantile_index(n, 50)] * 1e-6,
        .p95_ms = (double)times_ns[sim_quantile_index(n, 95)] * 1e-6,
    };
}
