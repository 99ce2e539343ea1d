/* Converts a device's own count and clock to the sequence and time of the sensor class.
 *
 * Device time plus an offset is clock time. The offset is the least delay seen between exposure and
 * arrival (the bound of Cristian 1989): late arrivals do not change it, and no frame lies in the
 * future. Because the two clocks drift, the offset may rise by DRIFT_PPM of the time that passes.
 * If a count or a time goes back, the device has begun anew; the sequence then continues without a
 * gap. */
#ifndef ISO_DRIVERS_SENSOR_CONTRACT_TIMELINE_H
#define ISO_DRIVERS_SENSOR_CONTRACT_TIMELINE_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_TIMELINE_DRIFT_PPM = 200 };

/* All zero before the first frame; afterwards it describes the last one. */
struct iso_timeline {
    bool begun, anew;
    bool gapless; /* set by the caller: frames that are missing are no gaps */
    int64_t index, device_ns, offset_ns;
    uint64_t sequence; /* rises from frame to frame, by more than 1 over a gap */
    int64_t t_ns;      /* rises from frame to frame */
};

/* Takes the next frame: number `index` and time device_ns by the device, seen at now_ns. */
void iso_timeline_advance(struct iso_timeline *timeline, int64_t index, int64_t device_ns,
                          int64_t now_ns);

/* Treats the next frame as one of a device that has begun anew, whatever its number and time. */
void iso_timeline_restart(struct iso_timeline *timeline);

#endif
