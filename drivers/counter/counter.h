/* A counter in hardware: a number that can only rise, even if an attacker has the disk. It shows
 * that a state directory is of an earlier time (firmware/keys/state_counter.h). */
#ifndef ISO_DRIVERS_COUNTER_COUNTER_H
#define ISO_DRIVERS_COUNTER_COUNTER_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* What a back end does. One thread at a time calls these; each may take as long as the device does,
 * which is some 100 ms for a TPM. All return 0 or a negative errno with one line in *fault, and
 * leave *value untouched then:
 *   -ENOENT the device answers, and does not have the counter (read, increment)
 *   -EBADMSG the device has something else in its place
 *   -EAGAIN the device asks to try again later
 *   -EACCES the device refuses the operation
 *   -EIO    the device is missing or gives a wrong answer */
struct iso_counter_ops {
    const char *name; /* "tpm2" */
    int (*read)(void *self, uint64_t *value, struct iso_fault *fault);
    /* Makes the counter, and counts once, so that it can be read. A counter that was made but never
     * counted is used. Its first value is above that of every counter that the device had
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
