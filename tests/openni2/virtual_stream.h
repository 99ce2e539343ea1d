/* One stream of the virtual camera, as an OpenNI2 driver presents it: depth, or the infrared image
 * of the same sensor. */
#ifndef SIM_OPENNI2_VIRTUAL_STREAM_H
#define SIM_OPENNI2_VIRTUAL_STREAM_H

#include <pthread.h>
#include <stdbool.h>

#include "tests/openni2/driver_abi.h"
#include "tests/openni2/virtual_camera.h"

enum { SIM_VIRTUAL_STREAM_MODES = 2 };

struct sim_virtual_stream {
    OniSensorType type;
    const struct iso_recording_meta *meta;
    OniVideoMode modes[SIM_VIRTUAL_STREAM_MODES];
    int n_modes;

    pthread_mutex_t *lock; /* of the following; never held while the runtime is called */
    bool created, started;
    OniVideoMode mode;
    OniBool mirroring;
    OniCropping cropping;
    struct OniStreamServices *services;
    sim_oni_new_frame *new_frame;
    void *new_frame_cookie;
};

/* Makes a stream of the camera in its initial state: whole image, mirrored, 1 mm a count. `lock`
 * must exist longer than the stream. */
void sim_virtual_stream_init(struct sim_virtual_stream *stream, OniSensorType type,
                             const struct iso_recording_meta *meta, pthread_mutex_t *lock);

/* The properties of OniCProperties.h that a stream has. ONI_STATUS_BAD_PARAMETER for a wrong size
 * or value, ONI_STATUS_NOT_SUPPORTED for another property. */
OniBool sim_virtual_stream_has(int property);
OniStatus sim_virtual_stream_get(struct sim_virtual_stream *stream, int property, void *data,
                                 int *size);
OniStatus sim_virtual_stream_set(struct sim_virtual_stream *stream, int property, const void *data,
                                 int size);

/* Passes a frame of the camera to the runtime if the stream is started. Only the camera's thread
 * may call this. */
void sim_virtual_stream_deliver(struct sim_virtual_stream *stream, const struct iso_frame *frame,
                                int index, uint64_t t_us);

#endif
