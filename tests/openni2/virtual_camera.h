/* A depth camera that does not exist. It stands on a bench, which is a directory, and sees what
 * lies there:
 *
 *   camera.ini   what camera it is: a recording.ini (drivers/recording/recording.h) of a pinhole
 *                camera without distortion, unit_mm 1 or 0.1
 *   slot         who stands before it: a recording of the same size, or a symbolic link to one,
 *                played again and again; where nothing is, nobody stands: frames without a depth
 *   unplugged    while this file exists, the camera's cable is out
 *   noise        while this file exists, every measured depth is wrong by -1, 0 or 1 mm, anew in
 *                each frame, as a sensor's are: a recording that is played again and again is then
 *                not a stuck camera
 *   shutter      optional FIFO: the camera makes a frame only for a byte read from it, 'f' makes
 *                one and 's' makes one that is lost on its way; without it, 30 a second
 *
 * Stricter than hardware where that finds faults: it starts out mirrored, and numbers go on from
 * start to start. It has a thread of its own, which alone calls the events. */
#ifndef SIM_OPENNI2_VIRTUAL_CAMERA_H
#define SIM_OPENNI2_VIRTUAL_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/recording/recording.h"
#include "isotherm/frame.h"

enum { SIM_VIRTUAL_CAMERA_HZ = 30 };

/* What happens to the camera, told from its thread. */
struct sim_virtual_camera_events {
    void (*plugged)(void *context, bool in);
    /* The frame is valid during the call; of the camera's size, with intensity (zero in the dark).
     * `index` counts from 1; t_us is the camera's own clock. */
    void (*frame)(void *context, const struct iso_frame *frame, int index, uint64_t t_us);
    void (*fault)(void *context, const char *text); /* one line */
    void *context;
};

struct sim_virtual_camera;

/* Sets the camera up, plugged in or not; no thread yet. -EINVAL a camera that it cannot be,
 * -ENOMEM, or the errors of reading camera.ini. */
int sim_virtual_camera_new(const char *bench, const struct sim_virtual_camera_events *events,
                           struct sim_virtual_camera **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Starts the thread; `plugged` is told at once if the cable is in. -EAGAIN, -ENOMEM. */
int sim_virtual_camera_run(struct sim_virtual_camera *camera) __attribute__((warn_unused_result));

/* Ends the thread and frees. NULL is fine. */
void sim_virtual_camera_free(struct sim_virtual_camera *camera);

const struct iso_recording_meta *sim_virtual_camera_meta(const struct sim_virtual_camera *camera);

/* Whether somebody wants frames. From false to true the recording in the slot begins anew. May be
 * called by any thread, the events' among them. */
void sim_virtual_camera_stream(struct sim_virtual_camera *camera, bool on);

#endif
