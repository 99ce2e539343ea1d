/* The pattern of the skin in an infrared image: the light that a place scatters back, compared
 * with the skin around it.
 *
 * An image depends mostly on the lamp and the shape. Without both, the pattern of brows, lips, lids
 * and nostrils is left. The steps are:
 *
 *  1. Take the mean of the image over each pixel of the face's grid where the depth belongs to the
 *     face.
 *  2. Divide by the cosine between the surface's normal and the line of sight (Lambert; a lamp
 *     beside the lens). For a pinhole camera also multiply by the square of the range.
 *  3. Smooth over 2.5 mm (projector dots, sensor noise), then divide by the local mean, a Gaussian
 *     of 15 mm. This removes slow changes of the light, with or without the lamp's fall-off, and
 *     the tone of the skin.
 *  4. Clip to 0.25..4; set 1 where it is not known. */
#ifndef SIM_LAB_METHODS_REFLECTANCE_H
#define SIM_LAB_METHODS_REFLECTANCE_H

#include "sim/lab/methods/scan.h"

/* Allocates and fills face->reflectance from the frame in which the face was measured. It stays
 * NULL for a frame without an image. -ENOMEM. */
int sim_reflectance_measure(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                            struct sim_scan *face) __attribute__((warn_unused_result));

#endif
