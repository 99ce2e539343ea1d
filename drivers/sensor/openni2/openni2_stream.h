/* The streams of an opened device: which of its video modes are used, and which camera measures the
 * depths. For openni2_session.c. All functions fail with -EINVAL (the device cannot do it), -ENODEV
 * or -EIO, and a fault. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_STREAM_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_STREAM_H

#include "drivers/sensor/openni2/openni2_session.h"

/* Claims the depth stream in a mode of the wanted size, rate and unit; in the finer unit if no unit
 * is wanted and both exist. */
int iso__openni2_claim_depth(struct iso__openni2_session *session,
                             const struct iso__openni2_wish *wish, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Claims the stream of the image that comes with the depths, in their size. Call it after
 * iso__openni2_claim_depth. */
int iso__openni2_claim_grey(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Fills in session->camera: the depth camera, or the colour camera if the depths are registered to
 * its image. Call it after the streams are claimed. */
int iso__openni2_find_camera(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
