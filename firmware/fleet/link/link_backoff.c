#include "firmware/fleet/link/link_backoff.h"

enum { DOUBLINGS_MAX = 20 };

uint64_t link_backoff_limit_ms(const struct link_backoff *backoff)
{
    const uint32_t doublings = backoff->failures < DOUBLINGS_MAX ? backoff->failures
                                                                 : DOUBLINGS_MAX;
    const uint64_t limit = (uint64_t)backoff->base_ms << doublings;

    return limit < backoff->cap_ms ? limit : backoff->cap_ms;
}

uint64_t link_backoff_next_us(struct link_backoff *backoff, uint64_t random)
{
    const uint64_t limit_us = link_backoff_limit_ms(backoff) * 1000;

    if (backoff->failures < UINT32_MAX) {
        backoff->failures++;
    }
    return random % (limit_us + 1);
}

void link_backoff_reset(struct link_backoff *backoff)
{
    backoff->failures = 0;
}
