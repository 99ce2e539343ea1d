/* Pictures of one camera, or of two that belong together, with a wait that ends: what the back ends
 * v4l2 and v4l2-stereo share. */
#ifndef ISO_DRIVERS_SENSOR_SENSOR_V4L2_STREAM_H
#define ISO_DRIVERS_SENSOR_SENSOR_V4L2_STREAM_H

#include "core/clock.h"
#include "drivers/sensor/sensor_v4l2_node.h"

enum { ISO_V4L2_CAMERAS_MAX = 2 };

struct iso_v4l2_stream_options {
    const struct iso_v4l2_system *system;
    const struct iso_clock *clock; /* the struct is copied */
    struct iso_v4l2_wish wishes[ISO_V4L2_CAMERAS_MAX];
    int n_cameras;
    int64_t tolerance_ns; /* how far apart two pictures may be that belong together */
};

/* What came in one go. */
struct iso_v4l2_set {
    struct iso_v4l2_picture
        pictures[ISO_V4L2_CAMERAS_MAX]; /* copies, until the next wait or stop */
    int64_t t_ns;      /* of the first picture, on the injected clock; strictly rising */
    uint64_t sequence; /* of the first camera, counted on over stops; a gap is a lost set */
};

struct iso_v4l2_stream;

/* Errors of iso_v4l2_node_open. */
int iso_v4l2_stream_open(const struct iso_v4l2_stream_options *options,
                         struct iso_v4l2_stream **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_v4l2_stream_close(struct iso_v4l2_stream *stream);

int iso_v4l2_stream_start(struct iso_v4l2_stream *stream, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_v4l2_stream_stop(struct iso_v4l2_stream *stream);

/* The next set, oldest first; polls until deadline_ns of the injected clock at the latest.
 * -ETIMEDOUT, and those of iso_v4l2_node_take but -EAGAIN. */
int iso_v4l2_stream_wait(struct iso_v4l2_stream *stream, int64_t deadline_ns,
                         struct iso_v4l2_set *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Polls readable when a picture waits in the kernel; with two cameras, of either: a wait that
 * follows takes it over and may still end in -ETIMEDOUT. */
int iso_v4l2_stream_fd(const struct iso_v4l2_stream *stream);

/* Pictures that came without a partner in time. */
uint64_t iso_v4l2_stream_dropped(const struct iso_v4l2_stream *stream);

/* Of the first camera; owned by the stream. */
const char *iso_v4l2_stream_card(const struct iso_v4l2_stream *stream);
const char *iso_v4l2_stream_bus(const struct iso_v4l2_stream *stream);

#endif
