/* A counter in hardware: a number that can only rise, even if an attacker has the disk. By it the
 * daemon recognises a state directory of an earlier time, such as a restored copy
 * (firmware/keys/state_counter.h). */
#ifndef ISO_DRIVERS_COUNTER_COUNTER_H
#define ISO_DRIVERS_COUNTER_COUNTER_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* The operations of a back end. One thread at a time calls them. Each may take as long as the
 * device needs, which is some 100 ms for a TPM. They return 0, or a negative errno with one line in
 * *fault and with *value unchanged:
 *   -ENOENT the device answers, and does not have the counter (read, increment)
 *   -EBADMSG the device has something else in its place
 *   -EAGAIN the device asks to try again later
 *   -EACCES the device refuses the operation
 *   -EIO    the device is missing or gives a wrong answer */
struct iso_counter_ops {
    const char *name; /* "tpm2" */
    int (*read)(void *self, uint64_t *value, struct iso_fault *fault);
    /* Makes the counter unless the device already has it, and counts once, so that it can be read.
     * The first value of a new counter is above that of every counter that the device had
     * before. */
    int (*define)(void *self, uint64_t *value, struct iso_fault *fault);
    /* Counts once; *value is the new number. */
    int (*increment)(void *self, uint64_t *value, struct iso_fault *fault);
    void (*close)(void *self);
};

/* ops NULL: there is no counter. */
struct iso_counter {
    const struct iso_counter_ops *ops;
    void *self;
};

/* Closes the device; the counter in it remains. A counter without ops is fine. */
static inline void iso_counter_close(struct iso_counter *counter)
{
    if (counter->ops) {
        counter->ops->close(counter->self);
        counter->ops = NULL;
    }
}

#endif
