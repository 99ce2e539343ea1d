/* Writes the frames of a sensor to a recording (drivers/recording/recording.h). */
#ifndef SIM_CORPUS_RECORD_H
#define SIM_CORPUS_RECORD_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/sensor/contract/sensor.h"

enum { SIM_RECORD_DEFAULT_UNIT_UM = 100 };

struct sim_record_options {
    const char *directory; /* NULL: frames are fetched, but not written */
    size_t frames;
    int64_t patience_ns; /* the longest wait for a frame */
};

/* What sim_record counted. */
struct sim_record_result {
    size_t frames;  /* recorded */
    size_t damaged; /* reported as -EBADMSG */
    struct iso_sensor_health health;
    int64_t span_ns; /* from the first frame to the last, by their time stamps */
};

/* Fetches frames from a started sensor and sleeps by `clock`, which must be the sensor's own
 * clock and CLOCK_MONOTONIC. Time stamps begin at 0. Depths are counted in the sensor's unit, or
 * in 0.1 mm if it has none. *result is filled in on failure too; the frames written so far are then
 * a valid recording. -ETIMEDOUT: no frame came for `patience_ns`. Otherwise the errors of
 * iso_sensor_wait except -EBADMSG, and of sim_recording_writer_create and _append. */
int sim_record(struct iso_sensor *sensor, const struct iso_clock *clock,
               const struct sim_record_options *options, struct sim_record_result *result,
               struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
