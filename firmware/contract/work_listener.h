/* Who wants to know how far a long piece of work is: an export, an import, a rotation of keys, a
 * look at the whole log. The work calls `step` after each record or person, thousands of times a
 * second; whoever listens decides what to do with so many calls. NULL, or a listener that is all
 * zero: nobody wants to know.
 *
 * `done` does not fall during one piece of work and is never above `total`; `total` is above 0. It
 * may fall when the work finds that there is less to do than it could be. The unit is the work's
 * own. */
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
