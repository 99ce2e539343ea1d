/* A simulated depth camera. A directory, the bench, decides what it sees:
 *
 *   camera.ini   the properties of the camera: a recording.ini (drivers/recording/recording.h) of a
 *                pinhole camera without distortion, unit_mm 1 or 0.1
 *   slot         the scene: a recording of the same size, or a symbolic link to one, which is
 *                repeated; without it the frames have no depths
 *   unplugged    while this file exists, the camera's cable is unplugged
 *   noise        while this file exists, every measured depth is wrong by -1, 0 or 1 mm, anew in
 *                each frame, as with a real sensor: a repeated recording then does not look like a
 *                stuck camera
 *   shutter      optional FIFO: the camera makes a frame only for a byte read from it, 'f' makes
 *                one and 's' makes one that is lost on its way; without the FIFO it makes 30 frames
 *                a second
 *
 * The camera is stricter than hardware where that finds faults: its image is mirrored at first, and
 * the numbers of its frames continue after a restart. */
#ifndef SIM_OPENNI2_VIRTUAL_CAMERA_H
#define SIM_OPENNI2_VIRTUAL_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/recording/recording.h"
#include "isotherm/frame.h"

enum { SIM_VIRTUAL_CAMERA_HZ = 30 };

/* The events of the camera. Its thread calls them; `plugged` is also called by
 * sim_virtual_camera_run(). */
struct sim_virtual_camera_events {
    void (*plugged)(void *context, bool in);
    /* The frame is valid during the call. It has the camera's size and an intensity, which is
     * zero if no recording gives one. `index` counts from 1; t_us is the time of the camera's
     * clock. */
    void (*frame)(void *context, const struct iso_frame *frame, int index, uint64_t t_us);
    void (*fault)(void *context, const char *text); /* one line */
    void *context;
};

struct sim_virtual_camera;

/* Makes the camera, plugged in or not, without its thread. -EINVAL if camera.ini describes a camera
 * that cannot be simulated, -ENOMEM, or the errors of reading camera.ini and of opening the
 * shutter. */
int sim_virtual_camera_new(const char *bench, const struct sim_virtual_camera_events *events,
                           struct sim_virtual_camera **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Calls `plugged` if the cable is plugged in, then starts the thread. -EAGAIN, -ENOMEM. */
int sim_virtual_camera_run(struct sim_virtual_camera *camera) __attribute__((warn_unused_result));

/* Ends the thread and frees the camera. NULL is accepted. */
void sim_virtual_camera_free(struct sim_virtual_camera *camera);

/* Returns the properties of the camera. They are valid until the camera is freed. */
const struct iso_recording_meta *sim_virtual_camera_meta(const struct sim_virtual_camera *camera);

/* Starts or stops the frames. At a start the recording in the slot begins anew. Any thread may call
 * this, including the thread of the events. */
void sim_virtual_camera_stream(struct sim_virtual_camera *camera, bool on);

#endif
