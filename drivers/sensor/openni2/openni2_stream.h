/* The streams of an opened device: which of its video modes is used, and by which camera the depths
 * are measured. For openni2_session.c. All fail with -EINVAL (the device cannot do it), -ENODEV or
 * -EIO, and a fault. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_STREAM_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_STREAM_H

#include "drivers/sensor/openni2/openni2_session.h"

/* Claims the depths: in a mode of the wanted size and rate, in the finer unit if both are there. */
int iso__openni2_claim_depth(struct iso__openni2_session *session,
                             const struct iso__openni2_wish *wish, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Claims the image that comes with the depths, in their size; after the depths. */
int iso__openni2_claim_grey(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Fills in session->camera: the depth camera, or the colour camera if the depths are registered to
 * its image. After the streams are claimed. */
int iso__openni2_find_camera(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
