/* The sensor class: everything that delivers depth frames.
 *
 * The states of a sensor and the calls that are legal in them; any other call returns -EBADFD:
 *
 *   (none)  --open-->  OPEN  --start-->  STARTED  --stop-->  OPEN  --close-->  (none)
 *   STARTED: wait, next_due_ns, set_interval.  Every state: describe, poll_fd, health, name, close.
 *   A call that returns -ENODEV (the device is gone) leads to LOST. There start, stop, wait and
 *   next_due_ns return -ENODEV; the sensor has to be closed.
 *
 * One sensor is used by one thread at a time. Time is read from the injected clock only. Frames are
 * checked (iso_frame_check, sequence and time rising) before the caller gets them. On a failure
 * *fault (which may be NULL) holds one line. */
#ifndef ISO_DRIVERS_SENSOR_CONTRACT_SENSOR_H
#define ISO_DRIVERS_SENSOR_CONTRACT_SENSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/base/option.h"
#include "isotherm/frame.h"

/* The properties and capabilities of the device of a sensor. */
struct iso_sensor_description {
    char model[32];          /* the kind of sensor, as in a recording's `sensor` and in templates */
    char serial[64];         /* "" if it has none */
    int width_px, height_px; /* of the depth plane */
    bool intensity;          /* frames carry one */
    double unit_mm;          /* depths are whole multiples of this; 0 if they are not */
    double rate_hz;          /* the regular frames a second; 0 if the rate is not fixed */
    char calibration[96];    /* the calibration, in words; "" if the device has its own */
    /* Why the calibration is not reliable; ISO_FAULT_NONE: it is reliable. */
    enum iso_fault_code calibration_code;
    bool repeats; /* it is a replay whose option lets stored frames count more than once */
};

/* A device that a back end could open. */
struct iso_sensor_device {
    char id[256];             /* what the back end's options call it */
    char label[128];          /* maker and model, or why it cannot be opened, for people */
    bool depth;               /* it delivers depth by itself, by the pixel formats that it offers */
    enum iso_fault_code code; /* ISO_FAULT_NONE, or why it cannot be opened */
};

/* Called for one device, which is valid during the call. */
typedef void iso_sensor_visitor(const struct iso_sensor_device *device, void *context);

/* What a device reports about itself while it streams. */
struct iso_sensor_device_health {
    uint64_t dropped; /* frames that arrived and were dropped: they were not fetched in time, or a
                         part of them was missing. They are also gaps in the sequence */
    char state[64];   /* the fault, in words; "": there is none */
    enum iso_fault_code code; /* the code of that fault */
};

/* What an operation of a back end may and must do. `self` is the back end's own object. */
struct iso_sensor_ops {
    const char *name; /* as in the configuration */

    /* OPTIONAL. The table of the options that [sensor] may have with this back end (option.h),
     * ended by an entry without a name; NULL: there are none. `check` and `open` are called with
     * options that agree with the table: known, given once, within their ranges, none missing. */
    const struct iso_option_spec *options;

    /* OPTIONAL. Calls the visitor for every device that exists, and opens none. May be called with
     * or without open sensors. May block for a second. 0 also if there is no device; -EIO the bus
     * or the driver does not answer. */
    int (*probe)(iso_sensor_visitor *visit, void *context, struct iso_fault *fault);

    /* Whether probe returns so fast that the door may wait for it. */
    bool probes_at_once;

    /* OPTIONAL. Loads the modules (drivers/base/module.h) that open or probe would load otherwise:
     * for a process that gives up rights before it opens a sensor. -ENOENT a module is missing,
     * -EBADMSG it cannot be used. */
    int (*load)(struct iso_fault *fault);

    /* OPTIONAL. Checks what the table cannot express: options that exclude each other, and the
     * contents of the files that they name. Touches no device. -EINVAL an option is bad or a file
     * is damaged, -ENOENT a named file does not exist, -ENOMEM. */
    int (*check)(const struct iso_option *options, size_t n_options, struct iso_fault *fault);

    /* REQUIRED. Finds and claims the device without streaming. May block for a few seconds. Called
     * after check has accepted the options. Options and clock are read or copied during the call.
     * The errors of check; -EINVAL the device does not support an option, -ENODEV there is no such
     * device, -EBUSY another process has it, -EACCES no permission, -ENOMEM, -EIO. On failure
     * nothing is held. */
    int (*open)(const struct iso_option *options, size_t n_options, const struct iso_clock *clock,
                void **self, struct iso_fault *fault);

    /* REQUIRED. Starts streaming. May block for a second. -ENODEV, -EIO, -ENOMEM. */
    int (*start)(void *self, struct iso_fault *fault);

    /* REQUIRED. Gives the next frame, oldest first. Blocks until deadline_ns of the injected clock
     * at most; with a deadline in the past it does not block. A back end that could block only by
     * sleeping does not block: it returns -ETIMEDOUT at once and has next_due_ns. *frame belongs to
     * the back end and stays unchanged until the next call on the sensor. After the first frames
     * nothing is allocated. Errors: -ETIMEDOUT there is no frame yet, or no more to come, -EBADMSG
     * one frame is lost or damaged and the next may be good, -EIO the stream broke (stop and start
     * may help), -ENODEV the device is gone. */
    int (*wait)(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                struct iso_fault *fault);

    /* OPTIONAL, for back ends whose wait does not block: when to call wait next. Does not block or
     * fail. */
    int (*next_due_ns)(void *self, int64_t *due_ns);

    /* OPTIONAL. A descriptor that polls readable when wait would not block; owned by the back end,
     * the same from start to stop. Negative errno if there is none now. */
    int (*poll_fd)(void *self);

    /* OPTIONAL. From now on at most one frame in interval_ns is wanted, by the times of the frames;
     * 0: every frame, as after each start. The back end passes over the others before it converts
     * or matches them. They are no gaps in the sequence. The caller may call wait so seldom
     * meanwhile that the device drops frames; those are no gaps either, and do not count as
     * dropped. The last frame stays as it is. The call does not
     * block and cannot fail. */
    void (*set_interval)(void *self, int64_t interval_ns);

    /* OPTIONAL. Fills in the description: model and capabilities. -ENODATA while it is not known.
     * Does not block. */
    int (*describe)(void *self, struct iso_sensor_description *out);

    /* OPTIONAL. Fills in what the device reports about itself; the wrapper counts everything else.
     * Does not block or fail. */
    void (*health)(void *self, struct iso_sensor_device_health *out);

    /* REQUIRED. Stops streaming; frames not yet fetched are dropped. May block for a second. Leaves
     * the sensor stopped even if it reports -EIO or -ENODEV. */
    int (*stop)(void *self);

    /* REQUIRED. Releases everything; called on a stopped sensor, or on a lost one. Cannot fail. */
    void (*close)(void *self);
};

struct iso_sensor;

/* Loads the modules of a back end; most have none. -ENOENT the name is unknown (the fault lists the
 * known ones), else the errors of ops->load. */
int iso_sensor_load(const char *name, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Checks whether a sensor of this back end could be opened with these options if its device exists,
 * as iso_sensor_open does first: by the table of options and by ops->check. -ENOENT the name is
 * unknown (the fault lists the known ones), -EINVAL an option is unknown, repeated, bad or missing,
 * else the errors of ops->check. */
int iso_sensor_check(const char *name, const struct iso_option *options, size_t n_options,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens a sensor by the name of its back end (back_ends.def lists them). The errors of
 * iso_sensor_check and of ops->open. Options and clock need not outlive the call; what the clock's
 * context points to must outlive the sensor. */
int iso_sensor_open(const char *name, const struct iso_option *options, size_t n_options,
                    const struct iso_clock *clock, struct iso_sensor **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same with a back end that is not in the registry. -EINVAL if a REQUIRED operation is
 * missing. */
int iso_sensor_open_ops(const struct iso_sensor_ops *ops, const struct iso_option *options,
                        size_t n_options, const struct iso_clock *clock, struct iso_sensor **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* As iso_sensor_check, with a back end that is not in the registry. */
int iso_sensor_check_ops(const struct iso_sensor_ops *ops, const struct iso_option *options,
                         size_t n_options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stops the sensor if it streams, and releases it. NULL is fine. */
void iso_sensor_close(struct iso_sensor *sensor);

/* As the operations. Also -EBADFD in another state, -ENODEV in LOST. */
int iso_sensor_start(struct iso_sensor *sensor, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_sensor_stop(struct iso_sensor *sensor, struct iso_fault *fault);

/* As ops->wait; -ETIMEDOUT leaves *fault unchanged. Also -EBADMSG for a frame that fails its check
 * and is dropped, -EBADFD the sensor is not started, -ENODEV it is lost. */
int iso_sensor_wait(struct iso_sensor *sensor, int64_t deadline_ns, const struct iso_frame **frame,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* As ops->set_interval; without this operation every frame comes. interval_ns is not negative. */
void iso_sensor_set_interval(struct iso_sensor *sensor, int64_t interval_ns);

/* As the operations; -ENOSYS if the back end has no such operation. Without next_due_ns the caller
 * lets wait block, or polls poll_fd. */
int iso_sensor_next_due_ns(struct iso_sensor *sensor, int64_t *due_ns)
    __attribute__((warn_unused_result));
int iso_sensor_poll_fd(struct iso_sensor *sensor) __attribute__((warn_unused_result));
int iso_sensor_describe(struct iso_sensor *sensor, struct iso_sensor_description *out)
    __attribute__((warn_unused_result));

enum iso_sensor_state {
    ISO_SENSOR_OPEN,
    ISO_SENSOR_STARTED,
    ISO_SENSOR_LOST, /* the device is gone: close */
};

/* "open", "started", "lost"; NULL outside the range. */
const char *iso_sensor_state_name(enum iso_sensor_state state);

/* Counts since the opening. */
struct iso_sensor_health {
    enum iso_sensor_state state;
    uint64_t frames;                        /* frames that the caller received */
    uint64_t lost;                          /* frames that are missing in the sequence */
    uint64_t refused;                       /* frames that failed the check */
    uint64_t faults;                        /* other failures of wait, except time-outs */
    int64_t last_frame_ns;                  /* clock time of the last frame; 0 before the first */
    char last_fault[256];                   /* "" if there was none */
    struct iso_sensor_device_health device; /* zero if the back end reports none */
};

/* The counts and the state so far, and what the device reports now. Does not block. */
struct iso_sensor_health iso_sensor_health(const struct iso_sensor *sensor);

/* The back end's name. */
const char *iso_sensor_name(const struct iso_sensor *sensor);

/* The registered back ends: name number i, or NULL from the end on. */
const char *iso_sensor_registered(size_t i);

/* The table of the options of a registered back end, ended by an entry without a name; NULL: no
 * such back end, or it has no options. */
const struct iso_option_spec *iso_sensor_options(const char *name);

/* Whether the probe of a registered back end returns so fast that the door may wait for it. */
bool iso_sensor_probes_at_once(const char *name);

/* Calls the visitor for every device that a registered back end could open. -ENOENT the name is
 * unknown, -ENOSYS the back end cannot list devices, else the errors of ops->probe. */
int iso_sensor_probe(const char *name, iso_sensor_visitor *visit, void *context,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
