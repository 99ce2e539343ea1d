/* A stream of pictures of one camera, or of pairs of two cameras, and a wait with a deadline: for
 * the back ends v4l2, v4l2-stereo and libcamera-stereo. */
#ifndef ISO_DRIVERS_SENSOR_PICTURE_PICTURE_STREAM_H
#define ISO_DRIVERS_SENSOR_PICTURE_PICTURE_STREAM_H

#include "core/base/clock.h"
#include "drivers/sensor/picture/picture_source.h"

enum { ISO_PICTURE_CAMERAS_MAX = 2 };

struct iso_picture_stream_options {
    const char *owner;             /* of the faults: "sensor v4l2"; outlives the stream */
    const struct iso_clock *clock; /* injected; the struct is copied */
    /* The clock of the pictures' stamps. */
    int64_t (*monotonic_ns)(void *context);
    void *context;
    struct iso_picture_source sources[ISO_PICTURE_CAMERAS_MAX];
    int n_cameras, width_px, height_px;
    int64_t tolerance_ns; /* the largest difference in time of two pictures of a pair */
};

/* One picture of each camera. */
struct iso_picture_set {
    struct iso_picture pictures[ISO_PICTURE_CAMERAS_MAX]; /* copies, until the next wait or stop */
    int64_t t_ns;      /* of the first picture, on the injected clock; strictly rising */
    uint64_t sequence; /* of the first camera; continues after a stop; a gap means lost sets */
};

struct iso_picture_stream;

/* Makes a stream, which does not stream yet. The sources' objects must outlive it. -EIO, -ENOMEM,
 * with a fault.
 */
int iso_picture_stream_open(const struct iso_picture_stream_options *options,
                            struct iso_picture_stream **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Closes it and frees it. NULL is accepted. */
void iso_picture_stream_close(struct iso_picture_stream *stream);

/* Starts and stops the cameras. The errors of a source's start and stop. */
int iso_picture_stream_start(struct iso_picture_stream *stream, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_picture_stream_stop(struct iso_picture_stream *stream);

/* From now on takes at most one set in interval_ns; 0: every set, as after each start. The others
 * are passed over and leave no gap in the sequence. Nor do pictures that the camera dropped because
 * the caller came later than half the interval after the call before. */
void iso_picture_stream_set_interval(struct iso_picture_stream *stream, int64_t interval_ns);

/* Takes the next set, oldest first; polls until deadline_ns of the injected clock at the latest.
 * -ETIMEDOUT, and the errors of a source's take except -EAGAIN; -EBADMSG also for a picture that
 * comes after one that was taken later: it is dropped, and the stream continues. */
int iso_picture_stream_wait(struct iso_picture_stream *stream, int64_t deadline_ns,
                            struct iso_picture_set *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Polls readable when the kernel has a picture of one of the cameras. The next wait takes it and
 * may still return -ETIMEDOUT. */
int iso_picture_stream_fd(const struct iso_picture_stream *stream);

/* The number of pictures that came without a partner, or too late, since the opening. */
uint64_t iso_picture_stream_dropped(const struct iso_picture_stream *stream);

#endif
