/* An opened OpenNI2 device: the runtime, the device, its streams, and whether it is still
 * connected. For sensor_openni2.c. The runtime counts its users, so several sessions may be open in
 * a process.
 */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_SESSION_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_SESSION_H

#include <stdatomic.h>
#include <stdbool.h>

#include "core/base/fault.h"
#include "drivers/sensor/openni2/openni2_api.h"
#include "drivers/sensor/openni2/openni2_player.h"
#include "drivers/sensor/openni2/openni2_wish.h"
#include "isotherm/camera.h"

struct iso__openni2_stream {
    OniStreamHandle handle; /* NULL: there is none */
    OniVideoMode mode;
    bool mirrored;     /* the frames are mirrored, because this could not be turned off */
    double full_scale; /* grey only */
    int n_frames;      /* of a file: number of frames in the stream */
    int taken;         /* of a file: number of frames taken so far */
};

struct iso__openni2_session {
    bool running; /* the runtime was started */
    bool opened;  /* iso__openni2_session_open succeeded */
    bool file, loop;
    OniCallbackHandle watch;
    OniDeviceHandle device;
    struct iso__openni2_threads player; /* the threads that came when the device was opened */
    OniDeviceInfo info;
    char serial[64];
    struct iso__openni2_stream depth, grey;
    struct iso_camera camera;
    OniRecorderHandle recorder;

    /* Set by the runtime's threads. */
    atomic_bool gone;
    atomic_int state; /* OniDeviceState */
};

/* Opens the device of the wish; *session must not move until it is closed. -EINVAL the device does
 * not support the wish, -ENODEV there is no such device, -EIO, and the errors of
 * iso__openni2_find_file. On failure the session is closed. After -ENODEV the runtime stays loaded
 * until a session has been opened and closed (iso__openni2_stay). */
int iso__openni2_session_open(struct iso__openni2_session *session,
                              const struct iso__openni2_wish *wish, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Closes everything and sets the session to all zero. An all-zero session is fine. */
void iso__openni2_session_close(struct iso__openni2_session *session);

/* Starts the streams, and records them into the .oni file `record`, which is written anew, unless
 * it is NULL. -ENODEV, -EIO. */
int iso__openni2_session_start(struct iso__openni2_session *session, const char *record,
                               struct iso_fault *fault) __attribute__((warn_unused_result));
/* Stops the streams and ends the recording. */
void iso__openni2_session_stop(struct iso__openni2_session *session);

/* Waits for a frame of either stream; the caller releases it (oniFrameRelease). With a file the
 * timeout is ignored: the call takes as long as reading the frame. -ETIMEDOUT also at the end of a
 * file, -ENODEV the device is gone, -EIO. */
int iso__openni2_session_take(struct iso__openni2_session *session, int timeout_ms,
                              OniFrame **frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a file that is not looped has no more frames. */
bool iso__openni2_session_ended(const struct iso__openni2_session *session);

#endif
