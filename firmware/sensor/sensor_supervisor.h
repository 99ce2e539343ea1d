/* Keeps a sensor running: opens it, starts it, and opens it again when it is lost.
 *
 *   AWAY     it is time to try, and opening works             -> RUNNING
 *            opening fails                                    -> AWAY, the next wait twice as long
 *   RUNNING  it fails (-EIO, -ENODEV), or is silent too long  -> AWAY
 *
 * A lost or damaged frame is reported and changes nothing. Silence is counted only for a back end
 * without next_due_ns. A back end with next_due_ns says itself when there is something to see, and
 * may be idle for ever.
 *
 * A camera that pauses is not opened again at once, but nobody can be seen meanwhile: `sees` says
 * that sooner. It becomes false when the sensor is lost, and pause_ns after the exposure of the
 * last frame that was whole and not late. It becomes true with the next such frame, or when a back
 * end with next_due_ns has nothing to show; and not when the sensor is opened, because it has still
 * to show that it works.
 *
 * At rest few frames are wanted (iso_sensor_supervisor_set_interval). Frames that come before the
 * next wanted one wake nobody: they wait in the device or are dropped there.
 *
 * Both times count only what the sensor is responsible for. While the caller itself is held up,
 * for example by a slow disk, nobody reads the sensor; the caller reports that by
 * iso_sensor_supervisor_excuse, and that time does not count. A late frame is of no use all the
 * same, whatever made it late. */
#ifndef ISO_FIRMWARE_SENSOR_SENSOR_SUPERVISOR_H
#define ISO_FIRMWARE_SENSOR_SENSOR_SUPERVISOR_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/sensor/contract/sensor.h"

/* Opens the sensor, for the first time or again. The errors are those of iso_sensor_open. */
struct iso_sensor_source {
    int (*open)(void *context, struct iso_sensor **out, struct iso_fault *fault);
    void *context;
};

struct iso_sensor_supervisor_options {
    int64_t silence_ns, retry_ns, retry_max_ns;
    int64_t pause_ns; /* how old the last usable frame may be until `sees` becomes false */
    int64_t stale_ns; /* a frame that arrives this long after its exposure, or later, is not used */
};

struct iso_sensor_supervisor {
    struct iso_sensor_supervisor_options options;
    struct iso_sensor_source source;
    struct iso_sensor *sensor; /* RUNNING; NULL: AWAY */
    int64_t try_ns;            /* AWAY: the next attempt to open it */
    int64_t wait_ns;           /* the delay after the next failure */
    int64_t heard_ns;          /* RUNNING: the last sign of life */
    int64_t seen_ns;           /* RUNNING: time of the last observation of the scene */
    bool sees;                 /* the present scene is known */
    int64_t taken_ns;          /* RUNNING: when the last frame was taken */
    int64_t interval_ns;       /* RUNNING: one frame in this time is wanted; 0: every frame */
    bool found;                /* RUNNING: the last look found a frame */
    uint64_t progress;         /* counts signs of life, for the watchdog */
    uint64_t frames;
    char model[32];                       /* model of the sensor; "" while unknown */
    char calibration[96];                 /* its calibration; "" while unknown */
    enum iso_fault_code calibration_code; /* iso_sensor_description.calibration_code */
    bool repeats;                         /* iso_sensor_description.repeats */
    int error;              /* the last error, a negative errno; 0 if there was none */
    struct iso_fault fault; /* the fault of that error */
};

enum iso_sensor_news {
    ISO_SENSOR_QUIET, /* there is no news */
    ISO_SENSOR_FRAME, /* *frame is there */
    ISO_SENSOR_FLAW,  /* a frame was lost or damaged, or the sensor could not be opened again; see
                         ->fault */
    ISO_SENSOR_BACK,  /* it runs, for the first time or again */
    ISO_SENSOR_GONE,  /* it no longer runs; see ->fault */
};

/* Begins in AWAY; the sensor is opened with the first look. `sees` is true at first. */
void iso_sensor_supervisor_init(struct iso_sensor_supervisor *supervisor,
                                const struct iso_sensor_supervisor_options *options,
                                const struct iso_sensor_source *source, int64_t now_ns);

/* Reads the news of the sensor without waiting. *frame belongs to the sensor and is valid until the
 * next call. */
enum iso_sensor_news iso_sensor_supervisor_look(struct iso_sensor_supervisor *supervisor,
                                                int64_t now_ns, const struct iso_frame **frame);

/* Call this before the next look if the caller was held up for the last held_up_ns and could not
 * look. This time does not count as silence, so a dead sensor is noticed so much later. */
void iso_sensor_supervisor_excuse(struct iso_sensor_supervisor *supervisor, int64_t held_up_ns,
                                  int64_t now_ns);

/* Sets the interval of the sensor (iso_sensor_set_interval). After a frame was taken, the caller
 * need not look before interval_ns has passed; then it watches the sensor's descriptor again. An
 * interval must be shorter than silence_ns and pause_ns. Does nothing in AWAY; an opened sensor
 * gives every frame. */
void iso_sensor_supervisor_set_interval(struct iso_sensor_supervisor *supervisor,
                                        int64_t interval_ns);

/* The descriptor to be watched at now_ns: as iso_sensor_poll_fd. -EAGAIN: the sensor has one, which
 * is not to be watched until iso_sensor_supervisor_due_ns; -ENODEV in AWAY. */
int iso_sensor_supervisor_fd(const struct iso_sensor_supervisor *supervisor, int64_t now_ns)
    __attribute__((warn_unused_result));

/* The latest time of the next look if nothing is to be missed. Look earlier if the sensor's
 * descriptor is readable. */
int64_t iso_sensor_supervisor_due_ns(const struct iso_sensor_supervisor *supervisor,
                                     int64_t now_ns);

/* Closes the sensor. */
void iso_sensor_supervisor_done(struct iso_sensor_supervisor *supervisor);

#endif
