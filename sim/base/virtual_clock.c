#include "sim/base/virtual_clock.h"

struct sim_virtual_clock sim_virtual_clock_start(void)
{
    return (struct sim_virtual_clock){.wall_origin_ns = INT64_C(1767225600) * ISO_NS_PER_S};
}

static int64_t monotonic_ns(void *context)
{
    const struct sim_virtual_clock *clock = context;
    return clock->now_ns;
}

static int64_t wall_ns(void *context)
{
    const struct sim_virtual_clock *clock = context;
    return clock->wall_origin_ns + clock->now_ns;
}

struct iso_times sim_virtual_clock_times(struct sim_virtual_clock *clock)
{
    return (struct iso_times){
        .monotonic = {.now_ns = monotonic_ns, .context = clock},
        .wall_ns = wall_ns,
        .wall_context = clock,
    };
}

void sim_virtual_clock_advance(struct sim_virtual_clock *clock, int64_t t_ns)
{
    clock->now_ns = t_ns > clock->now_ns ? t_ns : clock->now_ns;
}
