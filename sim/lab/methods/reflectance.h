/* What an infrared image says of the skin: how much light a place scatters back, compared with the
 * skin around it.
 *
 * An image depends mostly on the lamp and the shape. Once both are taken out, the pattern of brows,
 * lips, lids and nostrils is left:
 *
 *  1. The mean of the image over a pixel of the face's grid, where the depth there is the face's.
 *  2. Over the cosine between the surface and the line of sight (Lambert; a lamp beside the lens),
 *     times the square of the range of a pinhole camera.
 *  3. Smoothed over 2.5 mm (dots of a projector, noise of the sensor), then over its own mean about
 *     the place, a Gaussian of 15 mm: slow changes of the light, with or without the lamp's
 *     fall-off, disappear, and so does the tone of the skin.
 *  4. Within 0.25..4; 1 where it is not known. */
#ifndef SIM_LAB_METHODS_REFLECTANCE_H
#define SIM_LAB_METHODS_REFLECTANCE_H

#include "sim/lab/methods/scan.h"

/* Fills face->reflectance, which is made, from the frame that the face was measured in. A frame
 * without an image leaves it NULL. -ENOMEM. */
int sim_reflectance_measure(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                            struct sim_scan *face) __attribute__((warn_unused_result));

#endif
