/* Which pictures of two cameras belong together: pure bookkeeping on their time stamps, for cameras
 * that share a trigger and for those that run free. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_PAIR_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_PAIR_H

#include <stddef.h>
#include <stdint.h>

enum iso_pair_verdict {
    ISO_PAIR_WAIT,        /* nothing to do before another picture comes */
    ISO_PAIR_TAKE,        /* the oldest of both belong together */
    ISO_PAIR_DROP_FIRST,  /* the oldest of the first camera has no partner */
    ISO_PAIR_DROP_SECOND, /* the oldest of the second camera has none */
};

/* Looks at the stamps of the pictures that wait, oldest first and rising. Two belong together if
 * they are at most tolerance_ns apart and the one that came earlier has no follower that is nearer
 * to the other. Since each camera's pictures come in order, the older of two that are too far apart
 * will never find a partner. */
enum iso_pair_verdict iso_pair_judge(const int64_t *first_ns, size_t n_first,
                                     const int64_t *second_ns, size_t n_second,
                                     int64_t tolerance_ns);

#endif
