/* Depth and intensity of one exposure: two frames of the runtime that belong together. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_PAIRING_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_PAIRING_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/sensor/openni2/openni2_api.h"

/* All-zero is empty. */
struct iso__openni2_pairing {
    OniFrame *depth, *grey; /* NULL: none */
    uint64_t dropped;       /* depth frames that a later one replaced or that found no partner */
};

/* A frame's time by the clock of the device or the file. */
int64_t iso__openni2_frame_ns(const OniFrame *frame);

/* Takes a frame over, which replaces the last one of its kind. The runtime gives older frames
 * first. */
void iso__openni2_pairing_add(struct iso__openni2_pairing *pairing, OniFrame *frame);

/* Whether there is a depth frame and, `with_grey`, an intensity frame at most half a period of
 * `fps` away from it. If two are further apart, the older one is released, because its partner
 * cannot come any more. */
bool iso__openni2_pairing_complete(struct iso__openni2_pairing *pairing, bool with_grey, int fps);

/* Releases the frames; they do not count as dropped. */
void iso__openni2_pairing_clear(struct iso__openni2_pairing *pairing);

#endif
