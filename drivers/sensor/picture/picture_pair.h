/* Decides which pictures of two cameras belong together, by their time stamps alone. The cameras
 * may share a trigger or run freely. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_PAIR_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_PAIR_H

#include <stddef.h>
#include <stdint.h>

enum iso_pair_verdict {
    ISO_PAIR_WAIT,        /* wait for another picture */
    ISO_PAIR_TAKE,        /* the oldest pictures of both cameras belong together */
    ISO_PAIR_DROP_FIRST,  /* the oldest picture of the first camera has no partner */
    ISO_PAIR_DROP_SECOND, /* the oldest picture of the second camera has no partner */
};

/* Judges by the stamps of the waiting pictures, oldest first and rising. Two belong together if
 * they are at most tolerance_ns apart and the older one has no follower that is nearer to the other
 * one. Since each camera's pictures come in order, the older of two that are too far apart will
 * never find a partner. */
enum iso_pair_verdict iso_pair_judge(const int64_t *first_ns, size_t n_first,
                                     const int64_t *second_ns, size_t n_second,
                                     int64_t tolerance_ns);

#endif
