/* A listener is informed of the progress of long work: an export, an import, a rotation of keys, a
 * check of the whole log. The work calls `step` after each record or person, thousands of times a
 * second; the listener decides which of these calls it uses. NULL, or a listener that is all zero,
 * receives nothing.
 *
 * `done` never decreases during one piece of work and is never above `total`. `total` is above 0;
 * it may decrease when the work turns out to be less than expected. Each work has its own unit. */
#ifndef ISO_FIRMWARE_CONTRACT_WORK_LISTENER_H
#define ISO_FIRMWARE_CONTRACT_WORK_LISTENER_H

#include <stdint.h>

struct iso_work_listener {
    void (*step)(void *context, uint64_t done, uint64_t total);
    void *context;
};

static inline void iso_work_step(const struct iso_work_listener *listener, uint64_t done,
                                 uint64_t total)
{
    if (listener && listener->step) {
        listener->step(listener->context, done, total);
    }
}

#endif
