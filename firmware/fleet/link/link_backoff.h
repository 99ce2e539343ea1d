/* How long a door waits before it tries again. Many doors lose the same broker at the same moment;
 * if they all came back at the same moment, they would overload it again. So each waits for a
 * random time between zero and a limit ("full jitter"), and the limit doubles with each failure.
 * Pure. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_BACKOFF_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_BACKOFF_H

#include <stdint.h>

struct link_backoff {
    uint32_t base_ms, cap_ms; /* the limit after the first failure, and the largest limit */
    uint32_t failures;        /* since the last success */
};

/* The limit of the next wait in milliseconds. */
uint64_t link_backoff_limit_ms(const struct link_backoff *backoff);

/* Counts a failure, and returns the time to wait in microseconds: a number between 0 and the limit,
 * which `random`, a uniform random number, chooses. */
uint64_t link_backoff_next_us(struct link_backoff *backoff, uint64_t random);

/* After a success. */
void link_backoff_reset(struct link_backoff *backoff);

#endif
